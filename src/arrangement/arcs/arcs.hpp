// The measures of a union of balls without a triangulation. Each sphere is looked at by itself,
// with its neighbours. Circular arcs bound the exposed part of a sphere, and the Gauss–Bonnet
// theorem gives the area inside them (Connolly 1983, "Analytical molecular surface calculation";
// Richmond 1984, "Solvent accessible surface area and excluded volume in proteins").
//
// These computations have nothing but the input in common with the triangulation and its formulas,
// so each is a check of the other.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "arrangement/exact_union.hpp"
#include "arrangement/measured_spheres.hpp"
#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct ArcMeasures {
  // One entry per sphere, in the order of the SphereSet: exposed area, and volume of ball ∩ power
  // cell. Both depend on the sphere and its neighbours alone, not on the origin of coordinates.
  // Both are NaN for a sphere that was not to be measured.
  std::vector<SphereMeasures> per_sphere;
  // Spheres whose numbers are not to be trusted, ascending. Either a check failed (closedness of
  // the surface of ball ∩ power cell, Euler's formula), or the sphere is nearly degenerate: circles
  // nearly tangent or equal, more than two circles through one point of the sphere, an arc or a
  // cell of nearly no size (arcs/doubts.hpp).
  std::vector<SphereId> suspect;
  // If counts were wanted: the spheres for which rounding might decide about the topology, and the
  // counts, if there are none of these.
  std::uint64_t doubtful = 0;
  std::optional<UnionCounts> counts;
};

// The result is the same, bit for bit, for any number of threads. Of equal balls the lowest index
// owns area and volume. A sphere that another ball covers wholly has area and volume 0.
// Memory beside the result: a cell list, and a workspace for each thread, which grows with the
// largest number of neighbours of one sphere. Time: n log n for a sphere of n neighbours, and n m
// with the m vertices of its power cell.
// Throws InvalidInput for an empty set, and Cancelled.
ArcMeasures arc_measures(const SphereSet& spheres, Monitor* monitor = nullptr);

// The same for the spheres in `measured` alone, which all others cover, written into an existing
// result. Reuses the memory of its arrays and of the workspace. `topology` is none or counts;
// precondition: counts are wanted of all spheres only.
void arc_measures(ArcMeasures& result, const SphereSet& spheres, const MeasuredSpheres& measured,
                  TopologyRequest topology, Monitor* monitor, Workspace& workspace);

}  // namespace vdwmesh
