// The terms of the atoms near a brick at its planes of nodes, which a warp makes in shared memory.
#pragma once

#include "cuda/extract/extract_stages.cuh"
#include "cuda/extract/ordered_gather.cuh"
#include "extract/blended/local_atom.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kAtomChunk = 16;  // in shared memory at a time

struct AtomStage {
  std::uint32_t waiting[kAtomChunk + kWarp];  // places of atoms near the brick
  Sphere spheres[kAtomChunk];
  float scale[kAtomChunk];
};

template <int kNodes>
struct alignas(16) NodeAtom {
  AxisTerm term[3][kNodes];
};

// Makes the terms of the first `count` waiting atoms, all lanes at work; leaves the warp
// synchronised.
template <BlendedKind Kind, int kNodes>
__device__ void share_terms(const FieldContext& f, const NodeShape& nodes, std::uint32_t count,
                            const BrickIndex& brick, const double (&coordinate)[3][kNodes],
                            AtomStage& stage, NodeAtom<kNodes>* atoms) {
  const unsigned lane = threadIdx.x % kWarp;
  if (lane < count) {
    const Sphere atom = f.list.spheres[stage.waiting[lane]];
    stage.spheres[lane] = atom;
    stage.scale[lane] = static_cast<float>(inverse_square_scale(f.model, atom.radius));
  }
  __syncwarp();
  constexpr unsigned terms = 3 * kNodes;
  for (unsigned i = lane; i < count * terms; i += kWarp) {
    const unsigned k = i / terms;
    const auto axis = static_cast<int>(i % terms) / kNodes;
    const auto node = static_cast<int>(i % terms) % kNodes;
    const std::int32_t index = axis == 0 ? brick.x : (axis == 1 ? brick.y : brick.z);
    atoms[k].term[axis][node] =
        lattice_term<Kind>(f.model, nodes, stage.spheres[k], stage.scale[k], axis,
                           lattice_index(index, node), coordinate[axis][node]);
  }
  __syncwarp();
}

}  // namespace vdwmesh
