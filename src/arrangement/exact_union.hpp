// The union of closed balls: area, volume and topology without a mesh.
//
// Tangency: balls are closed, so two balls that touch in one point are one component; area and
// volume do not depend on it. Exact duplicates: the lowest index owns the area.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/monitor.hpp"
#include "extract/sphere_set.hpp"

namespace vdwmesh {

// cgal: regular triangulation and dual complex, exact predicates, measures in double.
// arcs: exposed arcs per sphere from a cell list; area and volume only.
// both: cgal, with arcs beside it as a check.
enum class UnionMethod { cgal, arcs, both };

struct UnionOptions {
  UnionMethod method = UnionMethod::cgal;
  Monitor* monitor = nullptr;
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
  std::int64_t euler_characteristic;         // of the boundary: 2 (components - tunnels + voids)
  std::uint64_t point_contacts;  // pairs of balls that touch in one point outside all others
  std::uint64_t hidden_spheres;  // without exposed area
  std::vector<Shell> shells;     // outer surfaces first, by falling |volume|
  double outer_area, void_area;  // Å²
  double void_volume;            // Å³ enclosed by the voids, >= 0
};

struct ExactUnion {
  UnionMethod method;
  double area, volume;  // Å², Å³
  // In the order of the SphereSet; the sums are area and volume.
  std::vector<SphereMeasures> per_sphere;
  std::optional<UnionTopology> topology;  // cgal and both
  // cgal: the same by the second formula set (Gauss-Bonnet and pyramids); both: by arcs.
  std::optional<double> check_area, check_volume;
  std::uint64_t fallback_spheres = 0;  // arcs, both: spheres whose arcs the reference replaced
};

// Throws InvalidInput for an empty set, Cancelled.
ExactUnion exact_union(const SphereSet& spheres, const UnionOptions& options = {});

}  // namespace vdwmesh
