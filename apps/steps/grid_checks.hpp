// Whether a grid is fine enough for the balls: of a grid that is not, a mesh would be empty or no
// surface at all. Both checks throw InvalidInput, which names an option that would work.
#pragma once

#include <cstdint>
#include <optional>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::apps {

// Before the mesh is made: the spacing (Å) is no longer than the molecule.
void require_sensible_spacing(const SphereSet& spheres, double spacing);

// When its size is known: the mesh has triangles. `isovalue` is that of a blended field.
void require_triangles(std::uint64_t triangles, const SphereSet& spheres, double spacing,
                       const std::optional<double>& isovalue);

}  // namespace vdwmesh::apps
