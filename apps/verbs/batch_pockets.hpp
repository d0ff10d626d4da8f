// Rows of `vdwmesh batch --verb pockets`.
#pragma once

#include <optional>

#include "batch/batch.hpp"
#include "command_line/command_line.hpp"
#include "report/pockets/pocket_report.hpp"

namespace vdwmesh::apps {

// The pockets of a structure. Of the figures of the union, a row has the number of voids.
struct PocketsRow : BatchRow {
  PocketMeasures measures = PocketMeasures::exact;
  std::optional<PocketReport> pockets;
};

// Reads the structure and finds its pockets, on one thread. The figures are those of `vdwmesh
// pockets`. A structure that is refused has no figures but an error.
PocketsRow make_pockets_row(const NamedStructure& structure, const Options& options,
                            const BatchOptions& one);

}  // namespace vdwmesh::apps
