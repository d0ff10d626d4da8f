// Takes bad moves back in passes. A pass first tests triangles and marks the vertices whose moves
// are bad, then puts all marked vertices back at once, so the order of the triangles does not
// matter. refine/crossings/bad_moves.hpp says which moves are bad and why the passes end.
//
// Level 0 has the smallest mesh, so each of its passes simply launches a thread per triangle. On
// later levels most midpoints move, and one or two in a hundred go back. There the marked midpoints
// are kept in a list, and a pass visits only the patches on both sides of the listed midpoints'
// edges. Crossing triangles are found by CrossingFinder in both cases.
#include <thrust/iterator/counting_iterator.h>

#include <cub/device/device_select.cuh>
#include <optional>
#include <utility>

#include "core/monitor.hpp"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/refine/bad_moves.cuh"
#include "cuda/refine/device_crossings.cuh"
#include "cuda/refine/patch_facing.cuh"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;

// The finder of crossing triangles of a level. It is empty if crossings are allowed, or if no
// vertex has moved: no projection has made a step then.
template <class Patches>
std::optional<CrossingFinder<Patches>> finder_for(const Patches& level, const LevelPasses& passes,
                                                  const Stream& stream) {
  if (passes.crossings == Crossings::allow) return std::nullopt;
  if (fetch(passes.stats, stream).iterations_max == 0) return std::nullopt;
  return std::optional<CrossingFinder<Patches>>(std::in_place, level, passes.move_states,
                                                passes.pairs_at_once, stream);
}

void clear_marks(const MoveStatesView& move_states, const Stream& stream) {
  check_cuda(cudaMemsetAsync(move_states.marked, 0, sizeof(*move_states.marked), stream.get()),
             "marks");
}

// ---- level 0 ----

// Marks the moved vertices of bad triangles: those that face against their one atom and faced
// outward before the moves. One thread per triangle. Pass 0 tests all triangles. Later passes test
// only triangles with a vertex that the pass before has put back; the others have not changed.
__global__ void mark_turned(SurfaceView surface, GivenLevel level, MoveStatesView move_states,
                            int pass) {
  const std::uint64_t t = thread_index();
  if (t >= level.patches()) return;
  std::uint32_t vertex[3];
  bool moved = false, just_undone = false;
  for (int i = 0; i < 3; ++i) {
    vertex[i] = level.vertex(t, i);
    const MoveState state = move_states.of(vertex[i]);
    moved |= state == MoveState::moved || state == MoveState::to_undo;
    just_undone |= state == MoveState::just_undone;
  }
  // A triangle whose vertices are all in place cannot have been turned by a move.
  if (!moved || (pass > 0 && !just_undone)) return;
  Vec3d now[3], before[3];
  SphereId atom[3];
  for (int k = 0; k < 3; ++k) {
    now[k] = level.mesh.positions[vertex[k]];
    before[k] = level.before(t, k);
    atom[k] = level.mesh.vertex_spheres.atoms[vertex[k]];
  }
  if (facing(surface.spheres, now, atom) != Facing::against_one_atom) return;
  if (facing(surface.spheres, before, atom) != Facing::outward) return;
  for (int k = 0; k < 3; ++k) move_states.mark(vertex[k]);
}

// Puts the marked vertices back and adds their number to `count`. Vertices that the pass before has
// put back are done: every triangle around them has been tested again. One thread per vertex.
__global__ void restore_marked(SurfaceView surface, GivenLevel level, MoveState* move_states,
                               unsigned long long* count) {
  const std::uint64_t v = thread_index();
  if (v >= level.given.vertices) return;
  MoveState& state = move_states[v];
  if (state == MoveState::just_undone) state = MoveState::stayed;
  if (state != MoveState::to_undo) return;
  state = MoveState::just_undone;
  level.take_back(surface, v);
  atomicAdd(count, 1ull);
}

// ---- midpoints ----

// The edges of all `marked` marked midpoints, found by a search over all states. This is the
// fallback if the list of MoveStatesView was too short for all of them.
DeviceArray<std::uint32_t> search_marked(const MidpointLevel& level, const MoveState* move_states,
                                         std::uint64_t marked, const Stream& stream) {
  DeviceArray<std::uint32_t> list(marked, stream.get());
  const DeviceArray<std::uint64_t> count(1, stream.get());
  const auto all = thrust::make_counting_iterator(std::uint32_t{0});
  const auto is_to_undo = [move_states] __device__(std::uint32_t edge) -> bool {
    return move_states[edge] == MoveState::to_undo;
  };
  run_cub("list of marks", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::If(
        scratch, bytes, all, list.data(), count.data(),
        static_cast<std::int64_t>(level.mesh.vertices - level.parent.vertices), is_to_undo,
        stream.get());
  });
  return list;
}

// The patch that a thread handles in a launch of two threads per listed edge, one for each of the
// two parent triangles at the edge. A patch may have up to three listed edges; the thread of the
// first one handles it, so that each patch is handled once. `state` tells listed edges from others:
// it is the state that the midpoints of exactly the listed edges have during the launch.
struct ListedPatch {
  std::uint64_t t;  // parent triangle
  bool has;         // whether the thread handles the patch
};
__device__ ListedPatch listed_patch(const MidpointLevel& level, const MoveStatesView& move_states,
                                    const std::uint32_t* edges, std::uint64_t count,
                                    MoveState state) {
  const std::uint64_t i = thread_index();
  if (i >= 2 * count) return {0, false};
  std::uint64_t h = level.edges.half_edge(edges[i / 2]);
  if (i % 2 != 0) h = level.parent.opposite[h];
  const std::uint64_t t = h / 3;
  for (std::uint64_t before = 3 * t; before < h; ++before) {
    if (move_states.of(level.midpoint_of(before)) == state) return {t, false};
  }
  return {t, true};
}

// Subtracts the turned children of the patches at listed edges from the count of turned triangles,
// before their vertices go back; judge_listed() adds the children of the same patches that are
// turned afterwards. Two threads per edge.
__global__ void discount_turned(SurfaceView surface, MidpointLevel level,
                                MoveStatesView move_states, const std::uint32_t* edges,
                                std::uint64_t count, DeviceStats* stats) {
  const ListedPatch listed = listed_patch(level, move_states, edges, count, MoveState::to_undo);
  if (!listed.has) return;
  ParentPatch patch;
  load_vertices(level, listed.t, patch);
  load_places(level, listed.t, patch);
  const int turned = __popc(facing_of_children(surface.spheres, patch).turned);
  // Adds the two's complement, which subtracts: atomicAdd() on unsigned integers takes no negative
  // numbers.
  if (turned > 0) atomicAdd(&stats->turned, ~static_cast<unsigned long long>(turned) + 1);
}

// Puts the midpoints of the listed edges back into the middle of their edges, and recomputes their
// normals if the mesh has any. One thread per edge.
__global__ void restore_listed(SurfaceView surface, MidpointLevel level, MoveState* move_states,
                               const std::uint32_t* edges, std::uint64_t count) {
  const std::uint64_t i = thread_index();
  if (i >= count) return;
  const auto v = static_cast<std::uint32_t>(level.parent.vertices + edges[i]);
  level.take_back(surface, level.edges.half_edge(edges[i]), v);
  if (level.mesh.normals != nullptr) {
    const VertexSpheres label = level.mesh.vertex_spheres[v];
    level.mesh.normals[v] = surface.normal(level.mesh.positions[v], ids(label));
  }
  move_states[edges[i]] = MoveState::just_undone;
}

// Tests the patches at listed edges again after their midpoints have gone back: adds their turned
// children to the count, renews their safe marks and marks further bad moves for the next pass. Two
// threads per edge.
__global__ void judge_listed(SurfaceView surface, MidpointLevel level, MoveStatesView move_states,
                             const std::uint32_t* edges, std::uint64_t count, DeviceStats* stats) {
  const ListedPatch listed = listed_patch(level, move_states, edges, count, MoveState::just_undone);
  if (!listed.has) return;
  ParentPatch patch;
  load_vertices(level, listed.t, patch);
  load_places(level, listed.t, patch);
  const ChildrenFacing facing = facing_of_children(surface.spheres, patch);
  if (facing.turned != 0) {
    atomicAdd(&stats->turned, static_cast<unsigned long long>(__popc(facing.turned)));
  }
  if (level.marks.child_safe != nullptr) {
    level.marks.child_safe[listed.t] = static_cast<std::uint8_t>(facing.safe);
  }
  mark_turned_children(surface, level, listed.t, patch, facing.against_one_atom, move_states);
}

// Gives the midpoints of the listed edges the state `stayed`. One thread per edge.
__global__ void settle_listed(MoveState* move_states, const std::uint32_t* edges,
                              std::uint64_t count) {
  const std::uint64_t i = thread_index();
  if (i < count) move_states[edges[i]] = MoveState::stayed;
}

// Puts the listed midpoints back and tests their patches again. Three kernels, because every patch
// must be discounted before any vertex moves, and every vertex must be back before any patch is
// judged.
void take_back_listed(const MidpointLevel& level, const LevelPasses& passes, const EdgeList& list,
                      const Stream& stream) {
  const std::uint32_t* const edges = list.edges;
  const LaunchShape sides = over(2 * list.count, kThreads);
  launch("discount_turned", discount_turned, sides, stream, passes.surface, level,
         passes.move_states, edges, list.count, passes.stats);
  launch("restore_listed", restore_listed, over(list.count, kThreads), stream, passes.surface,
         level, passes.move_states.move_states, edges, list.count);
  launch("judge_listed", judge_listed, sides, stream, passes.surface, level, passes.move_states,
         edges, list.count, passes.stats);
}

// Gives the midpoints of the listed edges their final state; see settle_listed().
void settle(const EdgeList& list, MoveState* move_states, const Stream& stream) {
  launch("settle_listed", settle_listed, over(list.count, kThreads), stream, move_states,
         list.edges, list.count);
}

// Counts the triangles that do not face outward, with one atomic addition per warp. If `safe` is
// not null, writes the safe marks as PatchMarks::parent_safe has them: a byte for four triangles,
// which the first of their four lanes takes from a vote of the warp. One thread per triangle.
__global__ void count_turned(SurfaceView surface, DeviceMeshView mesh, std::uint8_t* safe,
                             DeviceStats* stats) {
  const std::uint64_t t = thread_index();
  unsigned turned = 0;
  bool is_safe_now = false;
  if (t < mesh.triangles) {
    Vec3d p[3];
    SphereId atom[3];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.corners[3 * t + k];
      p[k] = mesh.positions[v];
      atom[k] = mesh.triangle_spheres != nullptr ? mesh.triangle_spheres[t]
                                                 : mesh.vertex_spheres.atoms[v];
    }
    turned = facing(surface.spheres, p, atom) != Facing::outward ? 1 : 0;
    is_safe_now = safe != nullptr && is_safe(surface.spheres, p, atom);
  }
  if (safe != nullptr) {
    const unsigned lane = threadIdx.x % 32, votes = __ballot_sync(0xffffffffu, is_safe_now);
    if (lane % 4 == 0 && t < mesh.triangles) {
      safe[t / 4] = static_cast<std::uint8_t>(votes >> lane & 0xf);
    }
  }
  turned = __reduce_add_sync(0xffffffffu, turned);
  if (turned > 0 && threadIdx.x % 32 == 0) {
    atomicAdd(&stats->turned, static_cast<unsigned long long>(turned));
  }
}

// Takes back the bad moves of midpoints; the patches are those in which crossings are looked for.
template <class Patches>
std::uint64_t take_back_midpoints(const Patches& level, const LevelPasses& passes,
                                  const Stream& stream) {
  auto finder = finder_for(level, passes, stream);
  LevelPasses now = passes;
  // Two arrays for lists take turns: one holds the edges whose midpoints go back, while the other
  // collects the marks of the next pass. The marks of pass 0 are there already:
  // make_children_on_device() has made those of turned triangles.
  const DeviceArray<std::uint32_t> spare(passes.move_states.room, stream.get());
  std::uint32_t* other = spare.data();
  DeviceArray<std::uint32_t> searched;
  EdgeList last;
  std::uint64_t undone = 0;
  for (int pass = 0;; ++pass) {
    advance(passes.monitor, 0);
    if (finder) finder->mark(now.move_states, pass, last);
    const std::uint64_t marked = fetch(now.move_states.marked, stream);
    // Only now are the midpoints done that the previous pass has put back: by their state
    // just_undone the finder has recognised the triangles to test again.
    settle(last, now.move_states.move_states, stream);
    if (marked == 0) return undone;
    last = {now.move_states.list, marked};
    if (marked > now.move_states.room) {
      searched = search_marked(level, now.move_states.move_states, marked, stream);
      last.edges = searched.data();
    }
    undone += marked;
    std::swap(now.move_states.list, other);
    clear_marks(now.move_states, stream);
    take_back_listed(level, now, last, stream);
  }
}

}  // namespace

// Level 0: every pass tests triangles by one thread each, then puts the marked vertices back.
std::uint64_t take_back_bad_moves(const GivenLevel& level, const LevelPasses& passes,
                                  const Stream& stream) {
  auto finder = finder_for(GivenPatches{level}, passes, stream);
  const auto restored = zeros<unsigned long long>(1, stream);
  for (int pass = 0;; ++pass) {
    // No step of progress is done: the call throws if the run has been cancelled.
    advance(passes.monitor, 0);
    clear_marks(passes.move_states, stream);
    launch("mark_turned", mark_turned, over(level.patches(), kThreads), stream, passes.surface,
           level, passes.move_states, pass);
    if (finder) finder->mark(passes.move_states, pass, {});
    if (fetch(passes.move_states.marked, stream) == 0) return fetch(restored.data(), stream);
    launch("restore_marked", restore_marked, over(level.given.vertices, kThreads), stream,
           passes.surface, level, passes.move_states.move_states, restored.data());
  }
}

std::uint64_t take_back_bad_moves(const MidpointLevel& level, const LevelPasses& passes,
                                  const Stream& stream) {
  if (level.is_first) return take_back_midpoints(MidpointPatches{level}, passes, stream);
  return take_back_midpoints(DividedPatches{level}, passes, stream);
}

void count_turned_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                            std::uint8_t* safe, DeviceStats* stats, const Stream& stream) {
  launch("count_turned", count_turned, over(mesh.triangles, kThreads), stream, surface, mesh, safe,
         stats);
}

}  // namespace vdwmesh
