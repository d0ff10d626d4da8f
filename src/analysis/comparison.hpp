// A mesh beside the exact union of the balls.
#pragma once

#include <cstdint>
#include <optional>

#include "analysis/distances.hpp"
#include "analysis/mesh_measures.hpp"
#include "arrangement/exact_union.hpp"

namespace vdwmesh {

struct Comparison {
  double area_relative_error = 0;  // (mesh - exact) / exact
  std::optional<double> volume_relative_error;
  // From the χ a 2-manifold can have: the exact one + 2 point contacts. Of closed manifolds only.
  std::optional<std::int64_t> euler_characteristic_difference;
  std::optional<MeshDistances> distances;
};

// Everything but the distances, which distances() takes.
Comparison compare(const MeshTopology& topology, const MeshMeasures& measures,
                   const ExactUnion& exact);

// Connected pieces of the union of the closed balls: those of the graph in which two balls are
// neighbours where they overlap or touch. Much cheaper than the exact union; where balls touch to
// the last digit it goes by their rounded distance.
std::uint64_t count_components(const SphereSet& spheres);

}  // namespace vdwmesh
