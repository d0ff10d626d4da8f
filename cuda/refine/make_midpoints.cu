// Midpoints of a level: positions, labels, normals and states, with one kernel or two per kind of
// surface. A level subdivides the parent mesh; each edge of the parent gets one midpoint.
// Half-edges are half-edges of the parent, and the midpoint of an edge belongs to its first
// half-edge (edge_numbers.cuh), whose number is the lower one.
//
// For the union of the balls, nearly all midpoints take a short cut: both ends of the edge lie on
// one ball, and a radial step to its sphere is proved to be the answer by a test in single
// precision. make_union_midpoints takes the short cut, and lists the midpoints for which it fails;
// make_deferred_midpoints then gives those the full projection. In both kernels a warp takes
// midpoints that are close together, so that it can gather the few balls near all of them
// (warp_balls.cuh). The results equal those of the CPU, bit for bit.
#include "cuda/refine/make_vertices.cuh"
#include "cuda/refine/warp_balls.cuh"
#include "refine/crossings/constraint_formulas.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 128;
constexpr unsigned kWarps = kThreads / kWarp;
// A warp takes a run of 512 consecutive half-edges, and makes the midpoints of those that are the
// first of their edge: about every second one. They are close together, because neighbouring
// triangles have close numbers.
constexpr unsigned kRunWords = 16;  // words of 32 half-edges
constexpr unsigned kRun = kRunWords * kHalfEdgesPerWord;

// Writes to `list` those half-edges of a warp's run that are the first of their edge, as offsets
// into the run, in rising order. The run has the words first_word .. end_word - 1 of `edges`; a
// lane looks at one bit of each word. Returns the length of the list. All lanes must call it.
__device__ unsigned list_first_half_edges(const EdgeNumbersView& edges, std::uint64_t first_word,
                                          std::uint64_t end_word, std::uint16_t* list) {
  const unsigned lane = threadIdx.x % kWarp;
  unsigned count = 0;
  for (std::uint64_t word = first_word; word < end_word; ++word) {
    const std::uint32_t bits = edges.words[word].first;
    if (bits >> lane & 1) {
      list[count + bits_below(bits, lane)] =
          static_cast<std::uint16_t>((word - first_word) * kHalfEdgesPerWord + lane);
    }
    count += static_cast<unsigned>(__popc(bits));
  }
  __syncwarp();
  return count;
}

// Gives the midpoint v of half-edge h the mean normal of the edge's ends.
__device__ void interpolate_normal(const MidpointLevel& level, std::uint64_t h, std::uint32_t v) {
  level.mesh.normals[v] = unit_normal(cast<double>(level.parent.normals[level.start_of(h)]) +
                                      cast<double>(level.parent.normals[level.end_of(h)]));
}

// Writes position and label of midpoint v of half-edge h, given the result p of its projection, and
// returns its state. A midpoint whose projection failed goes into the middle of its edge, which is
// the place from which it started.
__device__ MoveState store_midpoint(const SurfaceView& surface, const MidpointLevel& level,
                                    std::uint64_t h, std::uint32_t v, const ProjectedPoint& p) {
  if (p.outcome != ProjectionOutcome::converged) {
    level.take_back(surface, h, v);
    return MoveState::stayed;
  }
  level.mesh.positions[v] = p.position;
  level.mesh.vertex_spheres.set(v, make_label(p.spheres));
  return p.steps > 0 ? MoveState::moved : MoveState::stayed;
}

// The balls are gathered once for at most this many rounds of 32 midpoints, one per lane.
constexpr unsigned kMostRounds = 4;

// The middles of the edges whose midpoints a warp is about to project, in shared memory.
struct EdgeMiddles {
  Vec3d start[kMostRounds * kWarp];
  double reach[kMostRounds * kWarp];   // Å, see midpoint_reach()
  SphereId atom[kMostRounds * kWarp];  // of both ends; kNoSphere if they have different atoms
};

// Writes the middles of `count` edges to `middles` and returns a box around them. half_edge(i) is
// the first half-edge of edge i. Precondition: 0 < count <= kRounds * 32. The box is for
// WarpBalls::nearest(), so each middle is added with the distance at which balls matter: a
// projection moves the point by `reach` at most, and at every place on its way it asks for balls
// within reach + kProjectionTolerance.
template <unsigned kRounds, class HalfEdge>
__device__ PointsBox load_middles(const MidpointLevel& level, unsigned count, EdgeMiddles& middles,
                                  const HalfEdge& half_edge) {
  static_assert(kRounds <= kMostRounds);
  const DeviceMeshView& parent = level.parent;
  const unsigned lane = threadIdx.x % kWarp;
  PointsBox box(level.middle_of(half_edge(0)));
#pragma unroll
  for (unsigned round = 0; round < kRounds; ++round) {
    const unsigned i = round * kWarp + lane;
    if (i >= count) continue;
    const std::uint64_t h = half_edge(i);
    const std::uint32_t u = level.start_of(h), v = level.end_of(h);
    const Vec3d a = parent.positions[u], b = parent.positions[v];
    const SphereId atom = parent.vertex_spheres.atoms[u];
    middles.atom[i] = parent.vertex_spheres.atoms[v] == atom ? atom : kNoSphere;
    const double reach = midpoint_reach(a, b);
    middles.start[i] = midpoint(a, b);
    middles.reach[i] = reach;
    box.add(middles.start[i], 2 * reach + kProjectionTolerance);
  }
  box.join();
  __syncwarp();
  return box;
}

// Whether a projected midpoint is regular (see PatchMarks): it went radially, by one step or none,
// to the sphere of the atom that both ends of its edge have, and lies on no second sphere.
// atom_of_ends is kNoSphere if the ends have different atoms; no converged midpoint has that label.
__device__ bool is_regular(const ProjectedPoint& p, SphereId atom_of_ends) {
  return p.outcome == ProjectionOutcome::converged && p.steps <= 1 && p.spheres[1] == kNoSphere &&
         p.spheres[0] == atom_of_ends;
}

// Output arrays of the two kernels for the union, besides the arrays of the mesh.
struct MidpointOutputs {
  MoveState* move_states;  // by edge number
  // The lists of deferred midpoints, one per run, which need the full projection. An entry is the
  // first half-edge of the midpoint's edge, as an offset into the run. Edges are numbered in the
  // order of their first half-edges, so the edges of a run are consecutive. The list of a run
  // begins at deferred[number of the run's first edge], which leaves space for all edges of the
  // run, and has deferred_count[run] entries.
  std::uint32_t* deferred;
  std::uint32_t* deferred_count;
};

// Writes state, label, position, normal and regular mark of the midpoint of an edge, given the
// result p of its projection from `start`. A midpoint that has not converged gets the normal at
// `start`, where it stays.
__device__ void finish_midpoint(const SurfaceView& surface, const MidpointLevel& level,
                                std::uint64_t h, std::uint32_t edge, const Vec3d& start,
                                SphereId atom_of_ends, const ProjectedPoint& p,
                                MoveState* move_states) {
  const auto v = static_cast<std::uint32_t>(level.parent.vertices + edge);
  move_states[edge] = store_midpoint(surface, level, h, v, p);
  level.marks.regular[edge] = is_regular(p, atom_of_ends);
  if (p.outcome == ProjectionOutcome::converged) {
    level.mesh.normals[v] = surface.normal(p.position, p.spheres);
  } else {
    const VertexSpheres label = level.mesh.vertex_spheres[v];
    level.mesh.normals[v] = surface.normal(start, ids(label));
  }
}

// Shared memory of make_union_midpoints, 32 KiB.
struct MidpointShared {
  std::uint16_t first[kWarps][kRun];  // first half-edges, from list_first_half_edges()
  EdgeMiddles middles[kWarps];
  WarpBallsStorage balls[kWarps];
};

// The short cut for an edge with both ends on ball a: a radial step from `start`, the middle of the
// edge, to the sphere of a. Returns whether p is what project_to_union() would find; if not, p is
// meaningless.
//
// The gap of a ball is d - r, negative inside. The step is taken if `start` lies inside a: the gap
// of a is -s, with s > 0 the length of the step. The step must end at a point that lies in or on no
// ball but a; is_on_at_most_one_ball() counts a itself. This proves that a was the nearest ball
// (the one of least gap) of the start: a ball b with a gap of at most -s there would have a gap of
// at most -s + s = 0 at the end point, since a gap changes by no more than the point moves. But
// then the end point would lie in or on b. So project_to_union() makes the same step, and stops
// after it because the end point is on the surface.
__device__ bool step_to_own_sphere(const Sphere& a, const Vec3d& start, double reach,
                                   const WarpBalls& balls, ProjectedPoint& p) {
  const double gap_before = gap(a, start);
  if (!(gap_before < -kProjectionTolerance && gap_before >= -reach)) return false;
  const FoundPoint to = nearest_on_sphere(a, start);
  if (!to.found || !within_reach(to.position, start, reach)) return false;
  p.position = to.position;
  p.residual = std::abs(gap(a, to.position));
  return p.residual <= kProjectionTolerance && balls.is_on_at_most_one_ball(to.position);
}

// Makes the midpoints for which the short cut works, and lists the others. One warp per run, 4
// warps per block. Balls are gathered for a group of kRounds * 32 midpoints at a time. Level 1 has
// the longest edges; its groups have fewer midpoints, so that their box does not hold too many
// balls. The second launch bound keeps the registers so few that 6 blocks fit on a multiprocessor.
template <unsigned kRounds>
__global__ void __launch_bounds__(kThreads, 6)
    make_union_midpoints(SurfaceView surface, MidpointLevel level, MidpointOutputs outputs,
                         DeviceStats* stats) {
  __shared__ MidpointShared s;
  const unsigned warp = threadIdx.x / kWarp, lane = threadIdx.x % kWarp;
  const std::uint64_t run = static_cast<std::uint64_t>(blockIdx.x) * kWarps + warp;
  const std::uint64_t first_word = run * kRunWords;
  if (first_word >= level.edges.count) return;
  const std::uint64_t end_word =
      first_word + kRunWords < level.edges.count ? first_word + kRunWords : level.edges.count;
  std::uint16_t* const list = s.first[warp];
  const EdgeMiddles& middles = s.middles[warp];
  const unsigned count = list_first_half_edges(level.edges, first_word, end_word, list);
  const std::uint64_t first_half_edge = first_word * kHalfEdgesPerWord;
  const std::uint32_t first_edge = level.edges.number(first_half_edge);
  OutcomeTally tally;
  unsigned deferred = 0;
  for (unsigned group = 0; group < count; group += kRounds * kWarp) {
    const unsigned here = count - group < kRounds * kWarp ? count - group : kRounds * kWarp;
    const PointsBox box = load_middles<kRounds>(level, here, s.middles[warp], [&](unsigned i) {
      return first_half_edge + list[group + i];
    });
    WarpBalls balls(surface.list, s.balls[warp], box);
    balls.prepare_covers();
    for (unsigned begin = 0; begin < here; begin += kWarp) {
      const unsigned i = begin + lane;
      // False if this lane has a midpoint for which the short cut fails.
      bool settled = true;
      if (i < here) {
        const SphereId atom = middles.atom[i];
        // What project_to_union() gives after one radial step to the sphere of the atom; the step
        // fills in position and residual.
        ProjectedPoint p{.position = {0, 0, 0},
                         .residual = 0,
                         .spheres = {atom, kNoSphere, kNoSphere},
                         .steps = 1,
                         .outcome = ProjectionOutcome::converged};
        settled = atom != kNoSphere && step_to_own_sphere(surface.spheres[atom], middles.start[i],
                                                          middles.reach[i], balls, p);
        if (settled) {
          tally.add(p);
          const std::uint32_t edge = first_edge + group + i;
          const std::uint64_t v = level.parent.vertices + edge;
          level.mesh.positions[v] = p.position;
          level.mesh.vertex_spheres.set(v, on_sphere(atom));
          level.mesh.normals[v] = sphere_normal(surface.spheres[atom], p.position);
          level.marks.regular[edge] = 1;
          outputs.move_states[edge] = MoveState::moved;
        }
      }
      // Compaction: the lanes with deferred midpoints take consecutive entries of the list.
      const unsigned votes = __ballot_sync(kAllLanes, !settled);
      if (!settled) {
        const auto slot = deferred + bits_below(votes, lane);
        outputs.deferred[first_edge + slot] = list[group + i];
      }
      deferred += static_cast<unsigned>(__popc(votes));
    }
    // All lanes have read the middles before the next group overwrites them.
    __syncwarp();
  }
  if (lane == 0) outputs.deferred_count[run] = deferred;
  tally.add_to(stats);
}

constexpr unsigned kRunsTogether = 4;  // runs per warp of make_deferred_midpoints

// Shared memory of make_deferred_midpoints, 28 KiB.
struct DeferredShared {
  EdgeMiddles middles[kWarps];
  WarpBallsStorage balls[kWarps];
};

// Makes the deferred midpoints by the full projection. One warp per kRunsTogether neighbouring
// runs, whose lists it treats as one joined list, because the list of one run rarely fills a warp.
// The second launch bound: 4 blocks per multiprocessor.
__global__ void __launch_bounds__(kThreads, 4)
    make_deferred_midpoints(SurfaceView surface, MidpointLevel level, MidpointOutputs outputs,
                            std::uint64_t runs, DeviceStats* stats) {
  __shared__ DeferredShared s;
  const unsigned warp = threadIdx.x / kWarp, lane = threadIdx.x % kWarp;
  const std::uint64_t first_run =
      (static_cast<std::uint64_t>(blockIdx.x) * kWarps + warp) * kRunsTogether;
  if (first_run >= runs) return;
  // In the joined list of the warp, the list of run r ends at end[r]. In memory it begins at
  // deferred[first_edge[r]]. Runs beyond the last have empty lists.
  unsigned end[kRunsTogether], count = 0;
  std::uint32_t first_edge[kRunsTogether];
  for (unsigned r = 0; r < kRunsTogether; ++r) {
    const std::uint64_t run = first_run + r;
    if (run < runs) {
      count += outputs.deferred_count[run];
      first_edge[r] = level.edges.number(run * kRun);
    }
    end[r] = count;
  }
  // The first half-edge of entry i of the joined list. The last run whose list begins at or before
  // i has the entry: it is entry i - end[r - 1] of that list.
  const auto half_edge = [&](unsigned i) {
    unsigned r = 0;
    std::uint32_t at = first_edge[0] + i;
#pragma unroll
    for (unsigned n = 1; n < kRunsTogether; ++n) {
      if (i < end[n - 1]) continue;
      r = n;
      at = first_edge[n] + i - end[n - 1];
    }
    return (first_run + r) * kRun + outputs.deferred[at];
  };
  const EdgeMiddles& middles = s.middles[warp];
  constexpr unsigned group_size = kMostRounds * kWarp;
  OutcomeTally tally;
  for (unsigned group = 0; group < count; group += group_size) {
    const unsigned here = count - group < group_size ? count - group : group_size;
    const PointsBox box = load_middles<kMostRounds>(
        level, here, s.middles[warp], [&](unsigned i) { return half_edge(group + i); });
    WarpBalls balls(surface.list, s.balls[warp], box);
    for (unsigned i = lane; i < here; i += kWarp) {
      const Vec3d start = middles.start[i];
      const double reach = middles.reach[i];
      balls.begin(reach);
      const ProjectedPoint p = project_to_union(surface.list, start, reach, [&](const Vec3d& q) {
        return balls.nearest(q, reach + kProjectionTolerance);
      });
      tally.add(p);
      const std::uint64_t h = half_edge(group + i);
      finish_midpoint(surface, level, h, level.edges.number(h), start, middles.atom[i], p,
                      outputs.move_states);
    }
    __syncwarp();
  }
  // add_to() needs all lanes, but the loop ends earlier for some.
  __syncwarp();
  tally.add_to(stats);
}

// Makes the midpoints by projection onto the blended field. One warp per run. The warp lists the
// first half-edges before it projects, so that all lanes have a midpoint to make, although only
// every second half-edge is a first one. Shared memory: 4 KiB.
__global__ void __launch_bounds__(kThreads)
    make_field_midpoints(SurfaceView surface, MidpointLevel level, MoveState* move_states,
                         DeviceStats* stats) {
  __shared__ std::uint16_t first[kWarps][kRun];
  const unsigned warp = threadIdx.x / kWarp, lane = threadIdx.x % kWarp;
  const std::uint64_t first_word =
      (static_cast<std::uint64_t>(blockIdx.x) * kWarps + warp) * kRunWords;
  if (first_word >= level.edges.count) return;
  const std::uint64_t end_word =
      first_word + kRunWords < level.edges.count ? first_word + kRunWords : level.edges.count;
  const unsigned count = list_first_half_edges(level.edges, first_word, end_word, first[warp]);
  const std::uint32_t first_edge = level.edges.number(first_word * kHalfEdgesPerWord);
  OutcomeTally tally;
  for (unsigned i = lane; i < count; i += kWarp) {
    const std::uint64_t h = first_word * kHalfEdgesPerWord + first[warp][i];
    const double reach = midpoint_reach(level.parent.positions[level.start_of(h)],
                                        level.parent.positions[level.end_of(h)]);
    const ProjectedPoint p =
        project_to_field(surface.list, surface.model, level.middle_of(h), reach);
    tally.add(p);
    const std::uint32_t edge = first_edge + i;
    const auto v = static_cast<std::uint32_t>(level.parent.vertices + edge);
    move_states[edge] = store_midpoint(surface, level, h, v, p);
  }
  // add_to() needs all lanes, but the loop ends earlier for some.
  __syncwarp();
  tally.add_to(stats);
}

// Puts every midpoint into the middle of its edge, with interpolated normals if the mesh has any.
// One thread per half-edge; the thread of the first half-edge makes the midpoint.
__global__ void make_plain_midpoints(SurfaceView surface, MidpointLevel level,
                                     MoveState* move_states) {
  const std::uint64_t h = thread_index();
  if (h >= 3 * level.parent.triangles || !level.edges.is_first(h)) return;
  const std::uint32_t edge = level.edges.number(h);
  const auto v = static_cast<std::uint32_t>(level.parent.vertices + edge);
  level.take_back(surface, h, v);
  move_states[edge] = MoveState::stayed;
  if (level.mesh.normals != nullptr) interpolate_normal(level, h, v);
}

// Judges a vertex p that must lie on the spheres of its label: converged, without a step, if its
// distance to each of them (the residual, Å, is the largest) is within kProjectionTolerance. A
// vertex without a label is unconverged.
__device__ ProjectedPoint judge_constrained(const SurfaceView& surface, const Vec3d& p,
                                            const SphereId* label) {
  const double residual = label_residual(surface.spheres, label, p);
  const bool good = label[0] != kNoSphere && residual <= kProjectionTolerance;
  return {.position = p,
          .residual = residual,
          .spheres = {label[0], label[1], label[2]},
          .steps = 0,
          .outcome = good ? ProjectionOutcome::converged : ProjectionOutcome::unconverged};
}

// Counts the outcomes of all vertices of a mesh with labelled triangles. One thread per vertex.
__global__ void count_constrained(SurfaceView surface, DeviceMeshView mesh, DeviceStats* stats) {
  const std::uint64_t v = thread_index();
  OutcomeTally tally;
  if (v < mesh.vertices) {
    const VertexSpheres label = mesh.vertex_spheres[v];
    tally.add(judge_constrained(surface, mesh.positions[v], ids(label)));
  }
  tally.add_to(stats);
}

// Makes the midpoints of a mesh with labelled triangles. One thread per half-edge; the thread of
// the first half-edge makes the midpoint.
__global__ void make_constrained_midpoints(SurfaceView surface, MidpointLevel level,
                                           DeviceStats* stats) {
  const std::uint64_t h = thread_index();
  const DeviceMeshView& parent = level.parent;
  OutcomeTally tally;
  if (h < 3 * parent.triangles && level.edges.is_first(h)) {
    const auto v = static_cast<std::uint32_t>(parent.vertices + level.edges.number(h));
    const VertexSpheres label =
        edge_label(parent.triangle_spheres[h / 3], parent.triangle_spheres[parent.opposite[h] / 3]);
    // The label names the spheres of the two triangles at the edge: one sphere, or two on whose
    // circle the midpoint belongs.
    const bool projects = surface.projection != Projection::none;
    const Vec3d p = projects ? constrained_midpoint(surface.spheres, ids(label),
                                                    parent.positions[level.start_of(h)],
                                                    parent.positions[level.end_of(h)])
                             : level.middle_of(h);
    level.mesh.vertex_spheres.set(v, label);
    level.mesh.positions[v] = p;
    if (projects) {
      tally.add(judge_constrained(surface, p, ids(label)));
    } else if (level.mesh.normals != nullptr) {
      interpolate_normal(level, h, v);
    }
  }
  tally.add_to(stats);
}

// Computes the normals of all vertices. One thread per vertex.
__global__ void compute_normals(SurfaceView surface, DeviceMeshView mesh) {
  const std::uint64_t v = thread_index();
  if (v >= mesh.vertices) return;
  const Vec3d& p = mesh.positions[v];
  const VertexSpheres label = mesh.vertex_spheres[v];
  mesh.normals[v] = mesh.triangle_spheres != nullptr
                        ? constrained_normal(surface.spheres, ids(label), p)
                        : surface.normal(p, ids(label));
}

}  // namespace

namespace {

// Launches the two kernels for the union. A closed mesh has half as many edges as half-edges, so
// `deferred` has one entry per edge.
void make_union_midpoints_on_device(const SurfaceView& surface, const MidpointLevel& level,
                                    MoveState* move_states, DeviceStats* stats,
                                    const Stream& stream) {
  const std::uint64_t half_edges = 3 * level.parent.triangles;
  const std::uint64_t runs = (half_edges + kRun - 1) / kRun;
  const DeviceArray<std::uint32_t> deferred(half_edges / 2, stream.get()),
      counts(runs, stream.get());
  const MidpointOutputs outputs{move_states, deferred.data(), counts.data()};
  // On level 1 groups of 64 midpoints, later of 128: see make_union_midpoints.
  const auto make = level.is_first ? make_union_midpoints<2> : make_union_midpoints<kMostRounds>;
  launch("make_union_midpoints", make, over(runs, kWarps, kThreads), stream, surface, level,
         outputs, stats);
  launch("make_deferred_midpoints", make_deferred_midpoints,
         over(runs, kWarps * kRunsTogether, kThreads), stream, surface, level, outputs, runs,
         stats);
}

}  // namespace

void make_midpoints_on_device(const SurfaceView& surface, const MidpointLevel& level,
                              MoveState* move_states, DeviceStats* stats, const Stream& stream) {
  const std::uint64_t half_edges = 3 * level.parent.triangles;
  switch (surface.projection) {
    case Projection::vdw:
      make_union_midpoints_on_device(surface, level, move_states, stats, stream);
      break;
    case Projection::field:
      launch("make_field_midpoints", make_field_midpoints,
             over(half_edges, kRun * kWarps, kThreads), stream, surface, level, move_states, stats);
      break;
    case Projection::none:
      launch("make_plain_midpoints", make_plain_midpoints, over(half_edges, kThreads), stream,
             surface, level, move_states);
      break;
  }
}

void make_constrained_midpoints_on_device(const SurfaceView& surface, const MidpointLevel& level,
                                          DeviceStats* stats, const Stream& stream) {
  const std::uint64_t half_edges = 3 * level.parent.triangles;
  launch("make_constrained_midpoints", make_constrained_midpoints, over(half_edges, kThreads),
         stream, surface, level, stats);
}

void count_constrained_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                                 DeviceStats* stats, const Stream& stream) {
  launch("count_constrained", count_constrained, over(mesh.vertices, kThreads), stream, surface,
         mesh, stats);
}

void compute_normals_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                               const Stream& stream) {
  launch("compute_normals", compute_normals, over(mesh.vertices, kThreads), stream, surface, mesh);
}

}  // namespace vdwmesh
