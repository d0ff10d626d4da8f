// The axis terms of a chunk of atoms, made by a warp in shared memory. An axis term is what an atom
// and a plane of nodes across one axis contribute to the value at a node. Each node of the brick
// then combines only three terms per atom. The kernels that sum blended fields at nodes
// (count_bricks.cu, sample_field.cu) use them.
#pragma once

#include "cuda/extract/extract_stages.cuh"
#include "cuda/extract/ordered_gather.cuh"
#include "extract/blended/local_atom.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kAtomChunk = 16;  // atoms in shared memory at a time

// The atoms of a warp between gathering and their terms, in shared memory.
struct AtomStage {
  std::uint32_t waiting[kAtomChunk + kWarp];  // list places, as gather_by_warp() fills them
  Sphere spheres[kAtomChunk];                 // the atoms of the chunk
  float scale[kAtomChunk];                    // their scales: q = d^2 * scale
};

// The terms of one atom at kNodes planes of nodes across each axis.
template <int kNodes>
struct alignas(16) NodeAtom {
  AxisTerm term[3][kNodes];
};

// Makes the terms of the first `count` <= kAtomChunk waiting atoms and writes them to `atoms`: by
// one warp, whose lanes share the count * 3 * kNodes terms. `coordinate` has the positions of the
// planes of nodes along each axis, Å. All lanes call it. Ends with __syncwarp().
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
