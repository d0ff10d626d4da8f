// The union of balls without a triangulation: each sphere by itself, from its neighbours. Its
// exposed part is bounded by circular arcs, and the Gauss–Bonnet theorem gives its area from them
// (Connolly 1983, "Analytical molecular surface calculation"; Richmond 1984, "Solvent accessible
// surface area and excluded volume in proteins").
//
// Shares nothing with the triangulation and its formulas but the input, so it is their check.
#pragma once

#include <cstdint>
#include <vector>

#include "arrangement/exact_union.hpp"
#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct ArcMeasures {
  double area, volume;  // Å², Å³; sums of per_sphere, carried in a wide accumulator
  // In the order of the SphereSet: exposed area, and volume of ball ∩ power cell. Both depend on
  // the sphere and its neighbours alone, not on the origin.
  std::vector<SphereMeasures> per_sphere;
  // Spheres whose numbers are not to be trusted, ascending: they failed a check (Gauss-Bonnet on
  // the exposed patch; closedness of ball ∩ power cell) or are near-degenerate (circles all but
  // tangent or equal, more than two circles through one point of the sphere, planes along an edge,
  // all but vanishing arcs or cells).
  // per_sphere holds what was found with planes nudged apart by parts in 10^11 of the radius, which
  // is right to 1e-9 as a rule, not by guarantee; the sums count it.
  std::vector<SphereId> suspect;
};

// The same result, bit for bit, for any number of threads. Of exact duplicates the lowest index
// owns area and volume; buried spheres have area 0. Memory beside the result: a cell list, and for
// each thread a workspace that grows with the largest number of neighbours of one sphere. The time
// is n log n for a sphere of n neighbours, unless most of these overlap one another and the sphere
// is exposed between hundreds of them all the same.
// Throws InvalidInput for an empty set, Cancelled.
ArcMeasures arc_measures(const SphereSet& spheres, Monitor* monitor = nullptr);

// The same into a result that is there, in the memory of its arrays and of the workspace.
void arc_measures(ArcMeasures& result, const SphereSet& spheres, Monitor* monitor,
                  Workspace& workspace);

// Sums of area and volume over the spheres, in order, in a wide accumulator: for a caller who
// replaces measures of suspect spheres.
SphereMeasures total_measures(const std::vector<SphereMeasures>& per_sphere);

}  // namespace vdwmesh
