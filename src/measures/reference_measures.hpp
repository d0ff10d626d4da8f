// Measures of balls by a regular triangulation and inclusion-exclusion, for balls that the arcs
// cannot measure. For the library's own use.
#pragma once

#include <span>
#include <vector>

#include "complex/power_triangulation.hpp"
#include "measures/exact_union.hpp"
#include "spheres/cell_list.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Exposed area and ball ∩ power cell of each ball, in the order of the set. They are right for a
// ball if the set has all balls that overlap it.
std::vector<SphereMeasures> reference_measures(const SphereSet& spheres);

// A ball and its id in the set that it is taken from.
struct NumberedBall {
  SphereId id;
  Sphere ball;
};

// The wanted balls and all that overlap or touch one of them, each once. `list` is a cell list of
// the set, in which the reach of a ball is its radius.
std::vector<NumberedBall> balls_near(const CellListView& list, const SphereSet& spheres,
                                     std::span<const SphereId> wanted);

// The measures of the wanted balls, in their order, by one triangulation of the balls in `near`:
// the wanted ones and all that overlap one of them, in any order; a ball may come repeatedly. That
// is enough, because the exposed area of a sphere and its ball ∩ power cell depend only on the
// balls that meet its ball. The measures of the other balls in `near` would be wrong, as these may
// lack neighbours of their own.
std::vector<SphereMeasures> reference_measures(std::span<const SphereId> wanted,
                                               std::vector<NumberedBall> near);
// The same, stored as per_sphere[id].
void set_reference_measures(std::span<const SphereId> wanted, std::vector<NumberedBall> near,
                            std::span<SphereMeasures> per_sphere);

// Measures of the triangulation's balls in the order and the units of the SphereSet. Spheres that
// the triangulation leaves out, because a concentric one covers them, get 0.
std::vector<SphereMeasures> in_order_of(const SphereSet& spheres, const PowerTriangulation& t,
                                        const std::vector<SphereMeasures>& measures);

}  // namespace vdwmesh
