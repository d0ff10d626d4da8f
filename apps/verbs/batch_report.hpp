// Rows of `vdwmesh batch` for the verbs report and interface, and of excluded surfaces.
#pragma once

#include <optional>

#include "batch/batch.hpp"
#include "command_line/command_line.hpp"
#include "report/report.hpp"

namespace vdwmesh::apps {

// The figures of a report that rows have beside those of the exact union.
struct ReportRow : BatchRow {
  std::optional<MeshReport> mesh;
  std::optional<ComparisonReport> comparison;
};

// The interfaces between the chains of a structure that touch.
struct InterfaceRow : BatchRow {
  std::optional<std::vector<InterfaceReport>> interfaces;
  Switch fit = Switch::off;  // whether shape complementarity was asked for
};

// The excluded surface of a structure. Area and volume of the row are those of the complete one,
// and so are the counts of its topology; there is no method.
struct ExcludedRow : BatchRow {
  std::optional<ExcludedMeasures> excluded;
};

// Reads the structure, and makes and compares its mesh, on the CPU. Of `one`, the options of
// reading and the check are used. The figures are those of `vdwmesh report`, but for the time that
// the crease-exact mesher took: rows do not depend on the machine. A structure that is refused has
// no figures but an error.
ReportRow make_report_row(const NamedStructure& structure, const Options& options,
                          const BatchOptions& one);

// Reads the structure and measures the interfaces of its chains. One of a single chain is refused.
InterfaceRow make_interface_row(const NamedStructure& structure, const Options& options,
                                const BatchOptions& one);

// Reads the structure and measures its excluded surface: the figures of `vdwmesh exact --surface
// ses`.
ExcludedRow make_excluded_row(const NamedStructure& structure, const Options& options,
                              const BatchOptions& one);

}  // namespace vdwmesh::apps
