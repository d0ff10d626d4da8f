// Level 0 on the device: projects the vertices of the mesh that is to be refined onto the surface,
// and takes back the moves after which triangles would cross.
//
// Most vertices of a marching cubes mesh of the union lie on it already. The others are called
// astray here. A first kernel finds them: a warp gathers the balls near 128 vertices and compares
// each vertex with these. Only astray vertices need the full projection, and with it the length of
// the longest edge at the vertex, which limits its move. For a blended field every vertex counts as
// astray.
#include <cmath>
#include <cub/device/device_reduce.cuh>

#include "cuda/memory/cub_calls.cuh"
#include "cuda/refine/make_vertices.cuh"
#include "cuda/refine/warp_balls.cuh"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 128;
constexpr unsigned kWarps = kThreads / kWarp;

// The state of an astray vertex until it is projected. MoveState has no value for this. to_undo can
// be used, because these kernels mark no moves, and all astray vertices have another state when
// take_back_bad_moves() begins.
constexpr MoveState kAstray = MoveState::to_undo;

// Gives a projected vertex its new label, unless it has not moved and its old label is still right.
__device__ void relabel(const SurfaceView& surface, const DeviceMeshView& mesh, std::uint64_t v,
                        const ProjectedPoint& p) {
  const VertexSpheres label = mesh.vertex_spheres[v];
  const bool keeps_label = p.steps == 0 && surface.on_label(p.position, ids(label));
  if (!keeps_label) mesh.vertex_spheres.set(v, make_label(p.spheres));
}

// Gives vertex v the normal of the surface at its position, if the mesh has normals.
__device__ void renew_normal(const SurfaceView& surface, const DeviceMeshView& mesh,
                             std::uint64_t v) {
  if (mesh.normals == nullptr) return;
  const VertexSpheres label = mesh.vertex_spheres[v];
  mesh.normals[v] = surface.normal(mesh.positions[v], ids(label));
}

// A warp handles this many rounds of 32 vertices, one per lane, with one set of gathered balls.
constexpr unsigned kRounds = 4;
constexpr unsigned kGroup = kRounds * kWarp;

// Finishes the vertices that lie on the union (within kProjectionTolerance), and gives the others
// the state kAstray. One warp per kGroup = 128 consecutive vertices. Adds the number of astray
// vertices to `astray`. Shared memory: one WarpBallsStorage per warp.
__global__ void __launch_bounds__(kThreads)
    find_astray(SurfaceView surface, DeviceMeshView mesh, MoveState* move_states,
                unsigned long long* astray, DeviceStats* stats) {
  __shared__ WarpBallsStorage storage[kWarps];
  const unsigned warp = threadIdx.x / kWarp, lane = threadIdx.x % kWarp;
  const std::uint64_t first = (static_cast<std::uint64_t>(blockIdx.x) * kWarps + warp) * kGroup;
  if (first >= mesh.vertices) return;
  const std::uint64_t end = first + kGroup < mesh.vertices ? first + kGroup : mesh.vertices;
  // One box around the vertices of the warp: each lane adds its own, join() unites them.
  PointsBox box(mesh.positions[first]);
#pragma unroll
  for (unsigned round = 0; round < kRounds; ++round) {
    const std::uint64_t v = first + round * kWarp + lane;
    if (v < end) box.add(mesh.positions[v], kProjectionTolerance);
  }
  box.join();
  WarpBalls balls(surface.list, storage[warp], box);
  OutcomeTally tally;
  unsigned strays = 0;
  for (std::uint64_t v = first + lane; v < end; v += kWarp) {
    const Vec3d p = mesh.positions[v];
    balls.begin(0);  // the vertex does not move, so this search is its only one
    const NearestBall near = balls.nearest(p, kProjectionTolerance);
    const bool stays = near.found && std::abs(near.gap) <= kProjectionTolerance;
    move_states[v] = stays ? MoveState::stayed : kAstray;
    strays += stays ? 0 : 1;
    if (!stays) continue;
    // The result that a projection gives if no step is needed.
    const ProjectedPoint where{.position = p,
                               .residual = std::abs(near.gap),
                               .spheres = {surface.list.id[near.place], kNoSphere, kNoSphere},
                               .steps = 0,
                               .outcome = ProjectionOutcome::converged};
    tally.add(where);
    relabel(surface, mesh, v, where);
    renew_normal(surface, mesh, v);
  }
  // The loop ends earlier for some lanes, but all take part in the sums.
  __syncwarp();
  strays = __reduce_add_sync(kAllLanes, strays);
  if (strays > 0 && lane == 0) atomicAdd(astray, strays);
  tally.add_to(stats);
}

// Gives every vertex the state kAstray. One thread per vertex.
__global__ void set_astray(MoveState* move_states, std::uint64_t vertices) {
  const std::uint64_t v = thread_index();
  if (v < vertices) move_states[v] = kAstray;
}

// Raises square_bits[v] to the squared length (Å²) of the longest edge at each astray vertex v, as
// the bits of a double. The bits of doubles that are not negative have the order of the numbers, so
// atomicMax() works on them. One thread per half-edge.
__global__ void raise_longest_edges(DeviceMeshView mesh, const MoveState* move_states,
                                    unsigned long long* square_bits) {
  const std::uint64_t h = thread_index();
  if (h >= 3 * mesh.triangles) return;
  const std::uint32_t a = mesh.corners[h], b = mesh.corners[h % 3 == 2 ? h - 2 : h + 1];
  const bool a_strays = move_states[a] == kAstray, b_strays = move_states[b] == kAstray;
  if (!a_strays && !b_strays) return;
  const double s = squared_distance(mesh.positions[a], mesh.positions[b]);
  const auto bits = static_cast<unsigned long long>(__double_as_longlong(s));
  if (a_strays) atomicMax(&square_bits[a], bits);
  if (b_strays) atomicMax(&square_bits[b], bits);
}

// Projects the astray vertices. Each may move by the length of its longest edge at most; if the
// projection fails, it stays. One thread per vertex.
__global__ void project_astray(SurfaceView surface, DeviceMeshView mesh,
                               const unsigned long long* square_bits, MoveState* move_states,
                               DeviceStats* stats) {
  const std::uint64_t v = thread_index();
  OutcomeTally tally;
  if (v < mesh.vertices && move_states[v] == kAstray) {
    const double reach = std::sqrt(__longlong_as_double(static_cast<long long>(square_bits[v])));
    const ProjectedPoint p = surface.project(mesh.positions[v], reach);
    tally.add(p);
    const bool converged = p.outcome == ProjectionOutcome::converged;
    move_states[v] = converged && p.steps > 0 ? MoveState::moved : MoveState::stayed;
    if (converged) {
      mesh.positions[v] = p.position;
      relabel(surface, mesh, v, p);
    }
    renew_normal(surface, mesh, v);
  }
  tally.add_to(stats);
}

// Gives all astray vertices the state kAstray and finishes the others. Returns how many are astray.
std::uint64_t mark_astray(const SurfaceView& surface, const DeviceMeshView& mesh,
                          MoveState* move_states, DeviceStats* stats, const Stream& stream) {
  if (surface.projection == Projection::field) {
    launch("set_astray", set_astray, over(mesh.vertices, kThreads), stream, move_states,
           mesh.vertices);
    return mesh.vertices;
  }
  const auto astray = zeros<unsigned long long>(1, stream);
  launch("find_astray", find_astray, over(mesh.vertices, kWarps * kGroup, kThreads), stream,
         surface, mesh, move_states, astray.data(), stats);
  return fetch(astray.data(), stream);
}

}  // namespace

std::uint64_t project_given_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                                      const RefineOptions& options, std::uint64_t pairs_at_once,
                                      DeviceStats* stats, const Stream& stream) {
  if (mesh.vertices == 0) return 0;
  const DeviceArray<MoveState> move_states(move_state_bytes(mesh.vertices), stream.get());
  if (mark_astray(surface, mesh, move_states.data(), stats, stream) == 0) return 0;
  const DeviceArray<Vec3d> positions = copy_of(mesh.positions, mesh.vertices, stream);
  const DeviceVertexLabels labels{copy_of(mesh.vertex_spheres.atoms, mesh.vertices, stream),
                                  copy_of(mesh.vertex_spheres.others, mesh.vertices, stream)};
  // The mesh before the projection. Its positions and labels are copies. All other arrays are those
  // of `mesh`: triangles do not change, and normals are computed again.
  DeviceMeshView given = mesh;
  given.positions = positions.data();
  given.vertex_spheres = labels.view();
  // A scope of its own: the squares are given back before the search for crossings takes memory.
  {
    const auto squares = zeros<unsigned long long>(mesh.vertices, stream);
    launch("raise_longest_edges", raise_longest_edges, over(3 * mesh.triangles, kThreads), stream,
           given, move_states.data(), squares.data());
    launch("project_astray", project_astray, over(mesh.vertices, kThreads), stream, surface, mesh,
           squares.data(), move_states.data(), stats);
  }
  const DeviceArray<unsigned long long> marked(1, stream.get());
  return take_back_bad_moves(
      // All vertices are handled, and no list of marked vertices is kept.
      GivenLevel{given, mesh},
      {.surface = surface,
       .move_states = {.move_states = move_states.data(),
                       .first_handled = 0,
                       .marked = marked.data(),
                       .list = nullptr,
                       .room = 0},
       .stats = stats,
       .crossings = options.crossings,
       .monitor = options.monitor,
       .pairs_at_once = pairs_at_once},
      stream);
}

}  // namespace vdwmesh
