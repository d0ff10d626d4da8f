// The children of a level: their corners and half-edges, and the test of their orientation. A
// parent triangle with its three midpoints and four children is a patch.
//
// make_children writes the children. It also lists the patches whose orientation the marks of the
// level do not prove (PatchMarks in refine_levels.cuh); judge_children tests only these. The
// numbers go through shared memory, so that a warp stores whole consecutive 16-byte words.
#include "cuda/memory/warp.cuh"
#include "cuda/refine/bad_moves.cuh"
#include "cuda/refine/patch_facing.cuh"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;
constexpr unsigned kJudgeThreads = 128;
constexpr unsigned kPerParent = 12;  // 3 corners for each of 4 children; and as many half-edges

// Copies the numbers that a warp has staged in shared memory, kPerParent for each of `parents`
// parents, to `to` in device memory. The lanes write consecutive 16-byte words, with a hint that
// they will not be read soon (__stcs). All lanes must call it.
__device__ void write_staged(const std::uint32_t* staged, std::uint32_t* to, unsigned parents) {
  __syncwarp();
  const unsigned lane = threadIdx.x % kWarp, quads = parents * kPerParent / 4;
  for (unsigned q = lane; q < quads; q += kWarp) {
    __stcs(reinterpret_cast<uint4*>(to) + q, reinterpret_cast<const uint4*>(staged)[q]);
  }
  __syncwarp();
}

// Whether the marks prove that all children of parent triangle t face outward: the parent is safe
// and its three midpoints are regular. No position is read. `vertex` has the patch's six vertices;
// the midpoints are the last three.
__device__ bool is_plain(const MidpointLevel& level, std::uint64_t t, const std::uint32_t* vertex) {
  const PatchMarks& marks = level.marks;
  if (marks.regular == nullptr || !marks.is_safe(t)) return false;
  bool plain = true;
  for (int i = 3; i < 6; ++i) plain &= marks.regular[vertex[i] - level.parent.vertices] != 0;
  return plain;
}

constexpr unsigned kTurns = 4;  // a block takes kThreads parents in each of its turns

// The patches of one block that must be tested, in shared memory: 4 KiB.
struct BlockList {
  std::uint32_t patch[kTurns * kThreads];  // parent triangles
  unsigned count;                          // entries in use
  unsigned long long first;                // index in PatchMarks::list at which they go
};

// Adds patch t to the block's list if `asks`, that is, if it must be tested. All lanes of a warp
// must call it together. They vote, and one lane reserves the entries of all with a single atomic
// addition.
__device__ void note(BlockList& list, std::uint64_t t, bool asks) {
  const unsigned votes = __ballot_sync(kAllLanes, asks), lane = threadIdx.x % kWarp;
  unsigned first = 0;
  if (lane == 0 && votes != 0) first = atomicAdd(&list.count, static_cast<unsigned>(__popc(votes)));
  first = __shfl_sync(kAllLanes, first, 0);
  if (!asks) return;
  list.patch[first + bits_below(votes, lane)] = static_cast<std::uint32_t>(t);
}

// Appends the block's list to the list of the level. All threads of the block must call it. One of
// them adds to the level's count, so that this address sees one atomic operation per block.
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

// Writes the children of the 32 parents from `first` on, one parent per lane; fewer at the end of
// the mesh. `staged` is the warp's shared memory. Returns whether the patch of the lane's parent
// exists and must be tested.
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
    // All four children are safe: bits 0 to 3. The children of the other patches get their marks in
    // judge_children.
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

// One thread per parent and turn; a block takes kTurns * kThreads = 1024 parents, in turns of 256.
// Shared memory: 12 KiB of staged numbers and the list of 4 KiB. If no marks are kept, nothing is
// listed, and judge_children tests all patches.
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

// Tests the children of `count` patches: of the listed ones, or of all patches if no marks are
// kept. One thread per patch. Counts the turned children (which do not face outward), writes safe
// marks, and marks the bad moves: the moved vertices of children that their moves turned.
__global__ void __launch_bounds__(kJudgeThreads)
    judge_children(SurfaceView surface, MidpointLevel level, MoveStatesView move_states,
                   std::uint64_t count, DeviceStats* stats) {
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
    if (facing.against_one_atom != 0 && move_states.move_states != nullptr) {
      mark_turned_children(surface, level, t, patch, facing.against_one_atom, move_states);
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
  launch("make_children", make_children, over(level.patches(), kTurns * kThreads, kThreads), stream,
         level);
  const std::uint64_t count =
      level.marks.regular != nullptr ? fetch(level.marks.listed, stream) : level.patches();
  launch("judge_children", judge_children, over(count, kJudgeThreads), stream, passes.surface,
         level, passes.move_states, count, passes.stats);
}

}  // namespace vdwmesh
