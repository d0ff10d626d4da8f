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

#include "core/disjoint_sets.hpp"
#include "measures/arcs/shared_face.hpp"
#include "measures/exact_union.hpp"
#include "measures/measured_spheres.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;
class Workspace;

// What spheres contribute to the counts of their union. These are sums of integers, so they do not
// depend on the order of the spheres, nor on how a union is divided among several calls.
struct CountSums {
  std::int64_t euler_characteristic = 0;  // of the exposed patches
  std::uint64_t corners = 0;              // of the exposed patches
  std::uint64_t hidden = 0;               // spheres without exposed area
  std::uint64_t doubtful = 0;             // spheres for which rounding might decide about these

  void add(const CountSums& other) {
    euler_characteristic += other.euler_characteristic;
    corners += other.corners;
    hidden += other.hidden;
    doubtful += other.doubtful;
  }
};

// The counts of a union, given the sums over all of its spheres and the number of its components.
// There are none if rounding might decide about a sphere.
std::optional<UnionCounts> counts_of(const CountSums& sums, std::uint64_t components);

struct ArcMeasures {
  // One entry per sphere, in the order of the SphereSet: exposed area, and volume of ball ∩ power
  // cell. Both depend on the sphere and its neighbours alone, not on the origin of coordinates:
  // they have the same bits in every set in which these spheres are, in the same order. Both are
  // NaN for a sphere that was not to be measured.
  std::vector<SphereMeasures> per_sphere;
  // Spheres whose numbers are not to be trusted, ascending. Either a check failed (closedness of
  // the surface of ball ∩ power cell, Euler's formula), or the sphere is nearly degenerate: circles
  // nearly tangent or equal, more than two circles through one point of the sphere, an arc or a
  // cell of nearly no size (arcs/doubts.hpp).
  std::vector<SphereId> suspect;
  // If counts were wanted: sums over the measured spheres, and the sets of spheres of the SphereSet
  // that hang together by overlaps of which at least one ball is measured.
  CountSums sums;
  std::optional<DisjointSets> connected;
};

struct ArcRequest {
  const MeasuredSpheres& measured;                   // all others cover these
  TopologyRequest topology = TopologyRequest::none;  // or counts
  Monitor* monitor = nullptr;
  FaceVisitor* faces = nullptr;  // visits the measured balls that are not suspect
};

// The result is the same, bit for bit, for any number of threads. Of equal balls the lowest index
// owns area and volume. A sphere that another ball covers wholly has area and volume 0.
// Memory beside the result: a cell list, and a workspace for each thread, which grows with the
// largest number of neighbours of one sphere. Time: n log n for a sphere of n neighbours, and n m
// with the m vertices of its power cell.
// Throws InvalidInput for an empty set, and Cancelled.
ArcMeasures arc_measures(const SphereSet& spheres, Monitor* monitor = nullptr);

// The same for the spheres of the request, written into an existing result. Reuses the memory of
// its arrays and of the workspace, which keeps the list of the balls (ball_list()).
void arc_measures(ArcMeasures& result, const SphereSet& spheres, const ArcRequest& request,
                  Workspace& workspace);

}  // namespace vdwmesh
