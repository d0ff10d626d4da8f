// What the texts of a report are made of.
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

#include "printable.hpp"
#include "report.hpp"

namespace vdwmesh::apps {

using Text = std::back_insert_iterator<std::string>;

// One line, with a label that may be empty.
inline void line(Text out, std::string_view label, std::string text) {
  fmt::format_to(out, "{:<12} {}\n", label, printable(std::move(text)));
}

// An area, a volume or a count in the report's table.
inline std::string figure_text(double value) { return fmt::format("{:.3f}", value); }

// What a mesh is, how it was made, and how good its triangles are.
void mesh_text(Text out, const MeshReport& mesh);
// What speaks for a mesh along the curves of the surface, or against it. The comparison has a
// proof.
void proof_text(Text out, const ComparisonReport& comparison, const MeshReport& mesh);
// Both directions: a mesh may lie close to the surface and still lack a part of it.
void distances_text(Text out, const ComparisonReport& comparison);

}  // namespace vdwmesh::apps
