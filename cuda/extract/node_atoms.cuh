// The axis terms of a chunk of atoms, made by a warp in shared memory. An axis term is what an atom
// and a plane of nodes across one axis contribute to the value at a node. Each node of the brick
// then combines only three terms per atom, when count_bricks.cu sums a blended field.
#pragma once

#include "cuda/extract/bricks/extract_stages.cuh"
#include "cuda/extract/bricks/ordered_gather.cuh"
#include "extract/blended/local_atom.hpp"

namespace vdwmesh {

inline constexpr std::uint32_t kAtomChunk = 16;  // atoms in shared memory at a time

// The atoms of a warp between gathering and their terms, in shared memory.
struct AtomStage {
  ListPlace waiting[kAtomChunk + kWarp];  // as gather_by_warp() fills them
  Sphere spheres[kAtomChunk];             // the atoms of the chunk
  float scale[kAtomChunk];                // their scales: q = d^2 * scale
};

// The terms of one atom at the planes of nodes across each axis.
struct alignas(16) NodeAtom {
  AxisTerm term[3][kBrickReach];
};

// A plane of nodes across an axis, as a lane makes the terms of atoms at it.
struct NodePlane {
  int axis, node;
  std::int64_t lattice;  // its lattice index
  double coordinate;     // its position, Å
};

// The plane of a lane: lane kBrickReach * axis + node has plane `node` across the axis. The lanes
// from 3 * kBrickReach on have none, and their `axis` is 3. `coordinate` has the positions of the
// planes along each axis, Å.
__device__ inline NodePlane plane_of_lane(const BrickIndex& brick,
                                          const double (&coordinate)[3][kBrickReach]) {
  const auto lane = static_cast<int>(threadIdx.x % kWarp);
  const int axis = lane / kBrickReach, node = lane % kBrickReach;
  if (axis >= 3) return {3, 0, 0, 0};
  const std::int32_t index = axis == 0 ? brick.x : (axis == 1 ? brick.y : brick.z);
  return {axis, node, lattice_index(index, node), coordinate[axis][node]};
}

// Makes the terms of the first `count` <= kAtomChunk waiting atoms and writes them to `atoms`: by
// one warp, each lane those at its plane. All lanes call it. Ends with __syncwarp().
template <BlendedKind Kind>
__device__ void share_terms(const FieldContext& f, const NodeShape& nodes, std::uint32_t count,
                            const NodePlane& plane, AtomStage& stage, NodeAtom* atoms) {
  const unsigned lane = threadIdx.x % kWarp;
  if (lane < count) {
    const Sphere atom = f.list.spheres[stage.waiting[lane]];
    stage.spheres[lane] = atom;
    stage.scale[lane] = static_cast<float>(inverse_square_scale(f.model, atom.radius));
  }
  __syncwarp();
  // Two loops, so that the common one does not ask about sub-grids at every atom: without them,
  // lattice_term() is axis_term().
  if (plane.axis < 3 && f.model.truncation != Truncation::subgrid) {
#pragma unroll 2
    for (std::uint32_t k = 0; k < count; ++k) {
      const double away = plane.coordinate - stage.spheres[k].center[plane.axis];
      atoms[k].term[plane.axis][plane.node] =
          Kind::axis_term(nodes, stage.scale[k], plane.axis, static_cast<float>(away));
    }
  } else if (plane.axis < 3) {
#pragma unroll 1
    for (std::uint32_t k = 0; k < count; ++k) {
      atoms[k].term[plane.axis][plane.node] =
          lattice_term<Kind>(f.model, nodes, stage.spheres[k], stage.scale[k], plane.axis,
                             plane.lattice, plane.coordinate);
    }
  }
  __syncwarp();
}

}  // namespace vdwmesh
