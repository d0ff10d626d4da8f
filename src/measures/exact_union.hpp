// The union of closed balls: its area, volume and topology, without a mesh.
//
// The topology comes from the dual complex, a subcomplex of the balls' regular triangulation
// (Edelsbrunner 1995, "The union of balls and its dual shape"). The union is homotopy equivalent to
// it: each ball ∩ power cell is convex, and so is every intersection of several of them, so the
// nerve theorem applies. The predicates are exact, so the topology is exact for the doubles given.
//
// Areas and volumes are sums over the complex in double precision. Their rounding error is some
// 1e-13 of the total, without a proven bound. AlphaMol measures molecules in this way (Liang et al.
// 1998). A certificate proves how many digits are right: the same sums in intervals, as in Cazals,
// Kanhere and Loriot 2011, "Computing the volume of a union of balls: a certified algorithm".
//
// Degenerate input. Balls are closed, so two balls that touch in one point are one component; area
// and volume do not change at such a tangency. Of equal balls the lowest index owns the area.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/errors.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Monitor;
class Workspace;

// automatic: cgal if the full topology is wanted, else arcs, which are faster.
// cgal: the regular triangulation and the dual complex; all of ExactUnion.
// arcs: each sphere by itself, from the arcs on it; area and volume, and counts if they are wanted.
// both: cgal, with the arcs as an independent check of area and volume.
enum class UnionMethod { automatic, cgal, arcs, both };

// What is wanted of the topology. Methods cgal and both compute all of it in any case.
// counts: UnionCounts, which the arcs give almost for nothing.
enum class TopologyRequest { none, counts, full };

// The method that is used for `method` and this request: never automatic.
constexpr UnionMethod method_for(UnionMethod method, TopologyRequest topology) {
  if (method != UnionMethod::automatic) return method;
  return topology == TopologyRequest::full ? UnionMethod::cgal : UnionMethod::arcs;
}

struct UnionOptions {
  UnionMethod method = UnionMethod::automatic;
  Monitor* monitor = nullptr;
  Workspace* workspace = nullptr;  // if not null, keeps memory and cell list for later calls
  TopologyRequest topology = TopologyRequest::full;  // looked at by method automatic
  // If given, only these spheres are measured, while all others still cover them: the measures of
  // the others are NaN, and area, volume and check are sums over these spheres. With arcs the time
  // follows their number. The topology is always that of the whole union. The ids must exist;
  // their order does not matter, and a repeated id counts once.
  std::optional<std::span<const SphereId>> measured = std::nullopt;
  bool certify = false;  // ExactUnion::certificate is wanted; every method can have it
  // Bytes, of the triangulation of all balls, if there is one: its cells may be as many as there
  // are pairs of balls.
  std::uint64_t memory_limit = kNoMemoryLimit;
};

// Both are NaN for a sphere that was not to be measured.
struct SphereMeasures {
  double area;    // Å²: the part of the sphere that lies on the boundary of the union
  double volume;  // Å³: ball ∩ power cell
};

// A connected piece of the boundary: the outer surface of a component, or the surface of a void.
// `volume` is the volume inside the piece, with voids and other components in it. It is negative
// for the surface of a void.
struct Shell {
  double area, volume;  // Å², Å³
};

// A void: a bounded component of the complement of the union.
struct Void {
  double area;    // Å²: of its whole boundary, with that of components that lie in it
  double volume;  // Å³: of the void itself, without what lies in it
  // The point of the void at which the least power to a ball, squared distance less squared radius,
  // is largest: for balls of one radius the centre of the largest ball that fits in.
  Vec3d center;
  double clearance;              // Å: from there to the nearest sphere
  std::vector<SphereId> lining;  // spheres with exposed area in the void, ascending
};

// What can be said of the topology without a triangulation. The spheres that are not measured count
// too.
struct UnionCounts {
  std::uint64_t components;  // of the union of closed balls
  // As in UnionTopology: 2 (components - tunnels + voids). Each exposed patch has an Euler
  // characteristic, which Gauss–Bonnet ties to its area; together they make that of the boundary.
  std::int64_t euler_characteristic;
  std::uint64_t hidden_spheres;  // spheres without exposed area
};

struct UnionTopology {
  std::uint64_t components, tunnels, voids;  // Betti numbers of the union of closed balls
  // 2 (components - tunnels + voids). This is the Euler characteristic of the boundary after all
  // balls grew by a little, which makes the boundary a surface. The boundary itself has one more
  // for every point of contact: two spheres that touch have 3, the grown balls have 2.
  std::int64_t euler_characteristic;
  std::uint64_t point_contacts;  // pairs of balls that touch in one point outside all others
  std::uint64_t hidden_spheres;  // spheres without exposed area
  std::vector<Shell> shells;     // outer surfaces, then voids, each by falling |volume|
  double outer_area, void_area;  // Å²
  double void_volume;            // Å³ enclosed by the voids, >= 0
  std::vector<Void> void_table;  // one entry for each void, by falling volume
};

// lower <= true value <= upper.
struct Enclosure {
  double lower, upper;
};

// Intervals that are proven to contain area and volume of the union of the balls given, taken as
// real numbers. docs/certificates.md has the theorem and its assumptions. The intervals depend on
// the set of spheres alone: neither on their order nor on the number of threads.
struct UnionCertificate {
  Enclosure area, volume;      // Å², Å³; of the measured spheres
  std::uint64_t wide_spheres;  // spheres for which intervals of doubles were too wide
  int bits;                    // of the ends of the longest intervals: 53 if doubles did for all
};

struct ExactUnion {
  UnionMethod method;   // never automatic: the method that was used
  double area, volume;  // Å², Å³; of the measured spheres
  // One entry per sphere, in the order of the SphereSet. The sums are `area` and `volume`.
  std::vector<SphereMeasures> per_sphere;
  std::optional<UnionTopology> topology;  // methods cgal and both
  // If counts or the full topology are wanted. The arcs do not guess: if rounding might decide
  // about a sphere (doubtful_spheres), there are none.
  std::optional<UnionCounts> counts;
  // Method both: a second computation of area and volume by the arcs, which share no code with the
  // complex.
  std::optional<double> check_area, check_volume;
  // Methods arcs and both: spheres whose result from the arcs failed a check, so that the
  // result from a triangulation stands in for it.
  std::uint64_t fallback_spheres = 0;
  // Method arcs, if counts are wanted: spheres for which rounding might decide about the topology.
  // They include fallback_spheres.
  std::optional<std::uint64_t> doubtful_spheres;
  std::optional<UnionCertificate> certificate;  // if asked for
};

// Throws InvalidInput for an empty set, an id in `measured` that is no sphere, or if a measure is
// not finite in double; LimitExceeded, and Cancelled.
ExactUnion exact_union(const SphereSet& spheres, const UnionOptions& options = {});

// The same, written into an existing result, whose arrays are reused. If this throws, the contents
// of the result mean nothing.
void exact_union_into(ExactUnion& result, const SphereSet& spheres, const UnionOptions& options);

}  // namespace vdwmesh
