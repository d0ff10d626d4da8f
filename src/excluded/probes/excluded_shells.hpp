// The connected pieces of the excluded surface: area, volume and topology of each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "excluded/patches/patch_records.hpp"
#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

struct ShellTable {
  std::vector<ExcludedShell> shells;  // scaled; outer surfaces first, each by falling |volume|
  double residual;                    // ExcludedTopology::gauss_bonnet_residual
  std::uint64_t unmatched_patches;    // patches with a crease that the other probe does not have
  std::uint64_t cusps;                // ends of spindle saddles, each point once
};

// `included` says which components of the accessible surface count, `radius` the scaled radius of
// each ball of the triangulation without the probe.
ShellTable excluded_shells(const AccessibleSurface& surface, const PatchRecords& records,
                           std::span<const std::uint8_t> included, std::span<const double> radius);

}  // namespace vdwmesh::excluded
