// The union of closed balls: area, volume and topology without a mesh.
//
// The regular triangulation of the balls has a subcomplex, the dual complex, to which the union is
// homotopic: every intersection of balls with a power cell is convex, so the nerve theorem applies
// (Edelsbrunner 1995, "The union of balls and its dual shape"). Its predicates are exact, so the
// topology is exact for the doubles given. The measures are sums over the complex in double
// precision: right to rounding, some 1e-13 of the total, without a proven bound. AlphaMol (Liang et
// al. 1998) measures molecules so; Cazals, Kanhere and Loriot 2011, "Computing the volume of a
// union of balls: a certified algorithm", do it in intervals that prove how many digits are right.
//
// Tangency: balls are closed, so two balls that touch in one point are one component; area and
// volume do not depend on it. Exact duplicates: the lowest index owns the area.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// cgal: regular triangulation and dual complex, exact predicates, measures in double.
// arcs: exposed arcs per sphere from a cell list; area and volume only.
// both: cgal, with arcs beside it as a check.
enum class UnionMethod { cgal, arcs, both };

struct UnionOptions {
  UnionMethod method = UnionMethod::cgal;
  Monitor* monitor = nullptr;
  Workspace* workspace = nullptr;  // may be null; else keeps memory and cell list for later calls
};

struct SphereMeasures {
  double area;    // Å² exposed on the boundary of the union
  double volume;  // Å³ of ball ∩ power cell
};

// A connected piece of the boundary; volume is signed, negative for a void.
struct Shell {
  double area, volume;  // Å², Å³
};

struct UnionTopology {
  std::uint64_t components, tunnels, voids;  // Betti numbers of the union
  // 2 (components - tunnels + voids): of the boundary of balls a little larger, which is a surface.
  // The boundary itself has one more for every point contact: two spheres that touch have 3, those
  // of the larger balls 2.
  std::int64_t euler_characteristic;
  std::uint64_t point_contacts;  // pairs of balls that touch in one point outside all others
  std::uint64_t hidden_spheres;  // without exposed area
  std::vector<Shell> shells;     // outer surfaces, then voids, each by falling |volume|
  double outer_area, void_area;  // Å²
  double void_volume;            // Å³ enclosed by the voids, >= 0
};

struct ExactUnion {
  UnionMethod method;
  double area, volume;  // Å², Å³
  // In the order of the SphereSet; the sums are area and volume.
  std::vector<SphereMeasures> per_sphere;
  std::optional<UnionTopology> topology;  // cgal and both
  // cgal: from the same complex by other formulas (Gauss–Bonnet and pyramids), which checks the
  // sums but not the complex; both: by arcs, which share nothing with either.
  std::optional<double> check_area, check_volume;
  std::uint64_t fallback_spheres = 0;  // arcs, both: spheres whose arcs the reference replaced
};

// Throws InvalidInput for an empty set and where a measure is not finite in double, Cancelled.
ExactUnion exact_union(const SphereSet& spheres, const UnionOptions& options = {});

// The same into a result that is there, in the memory of its arrays. It means nothing if this
// throws.
void exact_union_into(ExactUnion& result, const SphereSet& spheres, const UnionOptions& options);

}  // namespace vdwmesh
