// Atoms of a blended field in shared memory, as the brick of a block of threads sees them.
#pragma once

#include "cuda/extract_stages.cuh"
#include "extract/local_atom.hpp"

namespace vdwmesh {

// Fills atoms[0 .. count): by all threads of the block, which it leaves synchronised.
template <FieldKind kind>
__device__ void share_atoms(const FieldContext& f, const NodeShape& nodes, const BrickGeometry& g,
                            const std::uint32_t* places, std::uint32_t count, LocalAtom* atoms) {
  for (std::uint32_t k = threadIdx.x; k < count; k += blockDim.x) {
    const Sphere& atom = f.list.spheres[places[k]];
    atoms[k].scale = static_cast<float>(inverse_square_scale(f.model, atom.radius));
    for (int axis = 0; axis < 3; ++axis) {
      atoms[k].center[axis] = static_cast<float>(atom.center[axis] - g.coordinate[axis][0]);
    }
  }
  __syncthreads();
  // A thread keeps to one plane of nodes, atom after atom.
  constexpr unsigned terms = 3 * kBrickReach;
  const unsigned at_once = blockDim.x / terms, plane = threadIdx.x % terms;
  const auto axis = static_cast<int>(plane) / kBrickReach;
  const auto node = static_cast<int>(plane) % kBrickReach;
  for (std::uint32_t k = threadIdx.x / terms; k < count && threadIdx.x < at_once * terms;
       k += at_once) {
    atoms[k].term[axis][node] =
        brick_term<kind>(f.model, nodes, g, f.list.spheres[places[k]], atoms[k].scale, axis, node);
  }
  __syncthreads();
}

}  // namespace vdwmesh
