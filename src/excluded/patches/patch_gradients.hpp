// Derivatives of area and volume from the patches of the excluded surface. For the library's own
// use.
#pragma once

#include <cstdint>
#include <span>

#include "excluded/excluded_gradients.hpp"
#include "excluded/patches/patch_records.hpp"

namespace vdwmesh::excluded {

// The gradients of the surface over the components that are included. Of lengths divided by
// 2^exponent, as the surface has them, the results are those of lengths in Å. `radius` has the
// radii of the triangulation's balls without the probe. `atoms` is the set; those that are no balls
// of the triangulation have derivatives of 0.
// Throws InvalidInput if a derivative is not finite in double, and Cancelled.
ExcludedGradients patch_gradients(const AccessibleSurface& surface, const PatchRecords& records,
                                  std::span<const std::uint8_t> included,
                                  std::span<const double> radius, const SphereSet& atoms,
                                  Monitor* monitor);

}  // namespace vdwmesh::excluded
