// The four children of each parent triangle: written, then judged.
#include "cuda/refine/bad_moves.cuh"
#include "cuda/refine/patch_facing.cuh"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;
constexpr unsigned kJudgeThreads = 128;
constexpr unsigned kWarp = 32;
constexpr unsigned kAllLanes = 0xffffffffu;
constexpr unsigned kPerParent = 12;  // corners, and half-edges, of four children

// Lanes hold kPerParent numbers each, in their place of `staged`: written to memory in order.
__device__ void write_staged(const std::uint32_t* staged, std::uint32_t* to, unsigned parents) {
  __syncwarp();
  const unsigned lane = threadIdx.x % kWarp, quads = parents * kPerParent / 4;
  for (unsigned q = lane; q < quads; q += kWarp) {
    __stcs(reinterpret_cast<uint4*>(to) + q, reinterpret_cast<const uint4*>(staged)[q]);
  }
  __syncwarp();
}

// Whether nothing needs to be known of the patch's places.
__device__ bool is_plain(const MidpointLevel& level, std::uint64_t t, const std::uint32_t* vertex) {
  const PatchMarks& marks = level.marks;
  if (marks.regular == nullptr || !marks.is_safe(t)) return false;
  bool plain = true;
  for (int i = 3; i < 6; ++i) plain &= marks.regular[vertex[i] - level.parent.vertices] != 0;
  return plain;
}

constexpr unsigned kTurns = 4;  // of kThreads parents, which a block takes

// A block's part of the list of patches to be looked at.
struct BlockList {
  std::uint32_t patch[kTurns * kThreads];
  unsigned count;
  unsigned long long first;  // in the list of all
};

__device__ void note(BlockList& list, std::uint64_t t, bool asks) {
  const unsigned votes = __ballot_sync(kAllLanes, asks), lane = threadIdx.x % kWarp;
  unsigned first = 0;
  if (lane == 0 && votes != 0) first = atomicAdd(&list.count, static_cast<unsigned>(__popc(votes)));
  first = __shfl_sync(kAllLanes, first, 0);
  if (!asks) return;
  list.patch[first + static_cast<unsigned>(__popc(votes & ((1u << lane) - 1)))] =
      static_cast<std::uint32_t>(t);
}

// By all threads of the block: one of them adds to the count of all, which is one address.
__device__ void append(BlockList& list, const PatchMarks& marks) {
  __syncthreads();
  if (threadIdx.x == 0 && list.count > 0) {
    list.first = atomicAdd(marks.listed, static_cast<unsigned long long>(list.count));
  }
  __syncthreads();
  for (unsigned i = threadIdx.x; i < list.count; i += kThreads) {
    marks.list[list.first + i] = list.patch[i];
  }
}

// The children of 32 parents from `first` on, through `staged`; says whether the lane's parent must
// be looked at.
__device__ bool make_children_of_warp(const MidpointLevel& level, std::uint64_t first,
                                      std::uint32_t* staged) {
  const std::uint64_t parents = level.parent.triangles, t = first + threadIdx.x % kWarp;
  const unsigned here = static_cast<unsigned>(parents - first < kWarp ? parents - first : kWarp);
  std::uint32_t* const own = staged + threadIdx.x % kWarp * kPerParent;
  const bool has = t < parents;
  bool plain = true;
  if (has) {
    std::uint32_t vertex[6];
    for (int i = 0; i < 6; ++i) vertex[i] = level.vertex(t, i);
    for (int child = 0; child < 4; ++child) {
      for (int k = 0; k < 3; ++k) own[3 * child + k] = vertex[child_corner(child, k)];
    }
    plain = is_plain(level, t, vertex);
    if (plain && level.marks.child_safe != nullptr) level.marks.child_safe[t] = 0xf;
  }
  write_staged(staged, level.mesh.corners + kPerParent * first, here);
  if (level.mesh.opposite != nullptr) {
    if (has) {
      for (std::uint64_t h = 3 * t; h < 3 * t + 3; ++h) {
        write_child_opposites(static_cast<std::uint32_t>(h), level.parent.opposite[h], own);
      }
    }
    write_staged(staged, level.mesh.opposite + kPerParent * first, here);
  }
  if (has && level.mesh.triangle_spheres != nullptr) {
    for (int child = 0; child < 4; ++child) {
      level.mesh.triangle_spheres[4 * t + child] = level.parent.triangle_spheres[t];
    }
  }
  return !plain;
}

__global__ void __launch_bounds__(kThreads) make_children(MidpointLevel level) {
  __shared__ __align__(16) std::uint32_t staged[kThreads * kPerParent];
  __shared__ BlockList list;
  if (threadIdx.x == 0) list.count = 0;
  __syncthreads();
  std::uint32_t* const own_staged = staged + threadIdx.x / kWarp * kWarp * kPerParent;
  for (unsigned turn = 0; turn < kTurns; ++turn) {
    const std::uint64_t t =
        (static_cast<std::uint64_t>(blockIdx.x) * kTurns + turn) * kThreads + threadIdx.x;
    const std::uint64_t first = t - threadIdx.x % kWarp;
    if (first >= level.parent.triangles) break;
    const bool asks = make_children_of_warp(level, first, own_staged);
    if (level.marks.regular != nullptr) note(list, t, asks);
  }
  if (level.marks.regular != nullptr) append(list, level.marks);
}

// Looks at `count` patches: those of the list, or all where nothing is known of any.
__global__ void __launch_bounds__(kJudgeThreads)
    judge_children(SurfaceView surface, MidpointLevel level, FatesView fates, std::uint64_t count,
                   DeviceStats* stats) {
  const std::uint64_t i = thread_index();
  unsigned turned = 0;
  if (i < count) {
    const std::uint64_t t = level.marks.regular != nullptr ? level.marks.list[i] : i;
    ParentPatch patch;
    load_vertices(level, t, patch);
    load_places(level, t, patch);
    const ChildrenFacing facing = facing_of_children(surface.spheres, patch);
    turned = static_cast<unsigned>(__popc(facing.turned));
    if (level.marks.child_safe != nullptr) {
      level.marks.child_safe[t] = static_cast<std::uint8_t>(facing.safe);
    }
    if (facing.against_one_atom != 0 && fates.fates != nullptr) {
      mark_turned_children(surface, level, t, patch, facing.against_one_atom, fates);
    }
  }
  turned = __reduce_add_sync(kAllLanes, turned);
  if (turned > 0 && threadIdx.x % kWarp == 0) {
    atomicAdd(&stats->turned, static_cast<unsigned long long>(turned));
  }
}

}  // namespace

void make_children_on_device(const MidpointLevel& level, const LevelPasses& passes,
                             const Stream& stream) {
  if (level.patches() == 0) return;
  make_children<<<blocks_for(level.patches(), kTurns * kThreads), kThreads, 0, stream.get()>>>(
      level);
  check_launch("make_children");
  const std::uint64_t count =
      level.marks.regular != nullptr ? fetch(level.marks.listed, stream) : level.patches();
  if (count == 0) return;
  judge_children<<<blocks_for(count, kJudgeThreads), kJudgeThreads, 0, stream.get()>>>(
      passes.surface, level, passes.fates, count, passes.stats);
  check_launch("judge_children");
}

}  // namespace vdwmesh
