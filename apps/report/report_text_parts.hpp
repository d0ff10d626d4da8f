// What the texts of a report are made of.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "report/printable.hpp"
#include "report/report.hpp"

namespace vdwmesh::apps {

using Text = std::back_insert_iterator<std::string>;

// One line, with a label that may be empty.
inline void line(Text out, std::string_view label, std::string text) {
  fmt::format_to(out, "{:<12} {}\n", label, printable(std::move(text)));
}

// An area, a volume or a count in the report's table.
inline std::string figure_text(double value) { return fmt::format("{:.3f}", value); }

// How far a figure of the mesh is from the exact one; nothing if that is not known.
inline std::string percent(std::optional<double> relative_error) {
  return relative_error && std::isfinite(*relative_error)
             ? fmt::format("{:+.3f} %", 100 * *relative_error)
             : "";
}
inline std::string equal_or(std::optional<std::int64_t> difference) {
  if (!difference) return "";
  return *difference == 0 ? "equal" : fmt::format("{:+}", *difference);
}

// "1 subdivision", "2 subdivisions".
std::string counted(std::uint64_t count, std::string_view noun);

// The answer: of what, by which radii, and then area, volume and topology, exactly and of the mesh.
void answer_text(Text out, const Report& report);
// Its size and soundness, and the file it was read from or written to.
std::string mesh_line(const MeshReport& mesh);
// What a mesh is, how it was made, and how good its triangles are.
void mesh_text(Text out, const MeshReport& mesh);
// What speaks for a mesh along the curves of the surface, or against it. The comparison has a
// proof.
void proof_text(Text out, const ComparisonReport& comparison, const MeshReport& mesh);
// Both directions: a mesh may lie close to the surface and still lack a part of it.
void distances_text(Text out, const ComparisonReport& comparison);
// The same of the exterior excluded surface, with the errors of area, volume and topology.
void exterior_text(Text out, const Comparison& comparison);

}  // namespace vdwmesh::apps
