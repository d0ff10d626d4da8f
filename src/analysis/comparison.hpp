// Comparison of a mesh with the exact union of the balls that it approximates: errors of area,
// volume and topology. The distances between the two surfaces are in distances.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "core/buffer.hpp"
#include "measures/exact_union.hpp"

namespace vdwmesh {

struct Comparison {
  // Both errors are signed: (mesh - exact) / exact. If the exact union measured only some of the
  // spheres, there is nothing to compare the mesh of all with: NaN and empty.
  double area_relative_error = 0;
  std::optional<double> volume_relative_error;  // empty if the mesh has no volume
  // χ of the mesh minus (exact χ + 2 × point contacts). At a point contact of two balls a
  // 2-manifold cannot follow the boundary of the union: it needs two points there, and its χ is
  // larger by 2. The value is empty for meshes that are not closed manifolds, and if the topology
  // of the union was not computed.
  std::optional<std::int64_t> euler_characteristic_difference;
  std::optional<MeshDistances> distances;
};

// Fills all members of a Comparison but `distances`, which the caller obtains from distances().
Comparison compare(const MeshTopology& topology, const MeshMeasures& measures,
                   const ExactUnion& exact);

// How far the areas of the spheres' parts of a mesh are from the exact areas of their patches.
struct AreaErrors {
  double max = 0, rms = 0;     // of |mesh - exact| / exact
  std::uint64_t spheres = 0;   // how many count
  SphereId worst = kNoSphere;  // the sphere of the largest error; of equal ones the first
};

// Compares the areas of a mesh by sphere (mesh_area_by_sphere()) with the exact ones. Spheres count
// that were measured and have at least `least` (Å²) exposed, because smaller patches may be one
// triangle. Empty if none does, and if the mesh has no areas by sphere.
std::optional<AreaErrors> area_errors(std::span<const double> mesh_areas,
                                      std::span<const SphereMeasures> exact, double least = 1);

// Counts the connected components of the union of the closed balls. Two balls are connected if the
// distance of their centres is at most the sum of their radii. Both are rounded to double, so for
// balls that nearly touch the answer may differ from the exact one. The cost is far below the cost
// of the exact union.
std::uint64_t count_components(const SphereSet& spheres);

// The components themselves: [i] is the same number for all spheres of the component of sphere i,
// and for no others. The numbers are below the number of spheres.
Buffer<std::uint32_t> connected_balls(const SphereSet& spheres);

}  // namespace vdwmesh
