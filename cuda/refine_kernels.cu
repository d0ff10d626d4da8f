#include <thrust/iterator/counting_iterator.h>
#include <thrust/iterator/transform_iterator.h>

#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "cuda/cub_calls.cuh"
#include "cuda/device_crossings.cuh"
#include "cuda/device_refinement.cuh"
#include "cuda/refine_levels.cuh"
#include "refine/constraint_formulas.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;

// ---- triangles judged together ----

// Marks the moved vertices of each triangle that its move turned. From the second pass on only a
// patch with a vertex that the last one took back can have changed.
template <class Level>
__global__ void mark_turned(SurfaceView surface, Level level, FatesView fates, int pass,
                            unsigned long long* count) {
  const std::uint64_t t = thread_index();
  if (t >= level.patches()) return;
  std::uint32_t vertex[Level::kVertices];
  bool moved = false, taken_back = false;
  for (int i = 0; i < Level::kVertices; ++i) {
    vertex[i] = level.vertex(t, i);
    const Fate fate = fates.of(vertex[i]);
    moved |= fate == Fate::moved || fate == Fate::taking_back;
    taken_back |= fate == Fate::taken_back;
  }
  // Only a move can have turned a triangle.
  if (!moved || (pass > 0 && !taken_back)) return;
  for (int child = 0; child < Level::kTriangles; ++child) {
    Vec3d now[3], before[3];
    SphereId atom[3];
    for (int k = 0; k < 3; ++k) {
      const int i = level.corner(child, k);
      now[k] = level.mesh.positions[vertex[i]];
      before[k] = level.before(t, i);
      atom[k] = ids(level.mesh.vertex_spheres[vertex[i]])[0];
    }
    if (facing(surface.spheres, now, atom) != Facing::against_one_atom) continue;
    if (facing(surface.spheres, before, atom) != Facing::outward) continue;
    atomicAdd(count, 1ull);
    for (int k = 0; k < 3; ++k) fates.mark(vertex[level.corner(child, k)]);
  }
}

template <class Level>
__global__ void restore_marked(SurfaceView surface, Level level, std::uint64_t items, Fate* fates,
                               unsigned long long* count) {
  const std::uint64_t item = thread_index();
  if (item >= items || !level.has_item(item)) return;
  Fate& fate = fates[level.handled_by_item(item)];
  if (fate == Fate::taken_back) fate = Fate::stayed;
  if (fate != Fate::taking_back) return;
  fate = Fate::taken_back;
  level.take_back(surface, item);
  atomicAdd(count, 1ull);
}

template <class Level>
CrossingFinder make_crossing_finder(const Level& level, const Stream& stream) {
  const std::uint64_t patches = level.patches(), triangles = level.mesh.triangles;
  require_device_memory(triangles * sizeof(FloatBox), "looking for crossing triangles");
  DeviceArray<FloatBox> boxes(triangles, stream.get());
  if (patches > 0) {
    bound_triangles<<<blocks_for(patches, kThreads), kThreads, 0, stream.get()>>>(level,
                                                                                  boxes.data());
    check_launch("bound_triangles");
  }
  return CrossingFinder(std::move(boxes), stream);
}

// The simultaneous passes of refine/bad_moves.hpp: all triangles are judged before any vertex goes
// back. Returns how many went.
template <class Level>
std::uint64_t take_back_bad_moves(const SurfaceView& surface, const Level& level, Fate* fates,
                                  const DeviceStats* stats, Crossings crossings,
                                  const Stream& stream) {
  // What needed no step did not move.
  if (fetch(stats, stream).iterations_max == 0) return 0;
  std::optional<CrossingFinder> finder;
  if (crossings == Crossings::undo) finder.emplace(make_crossing_finder(level, stream));
  const FatesView view{fates, level.first_handled()};
  const DeviceArray<unsigned long long> counts(2, stream.get());
  std::uint64_t undone = 0;
  for (int pass = 0;; ++pass) {
    clear(counts, stream.get());
    if (level.patches() > 0) {
      mark_turned<<<blocks_for(level.patches(), kThreads), kThreads, 0, stream.get()>>>(
          surface, level, view, pass, counts.data());
      check_launch("mark_turned");
    }
    if (finder) finder->mark(level.mesh, view, pass, counts.data());
    if (fetch(counts.data(), stream) == 0) return undone;
    restore_marked<<<blocks_for(level.items(), kThreads), kThreads, 0, stream.get()>>>(
        surface, level, level.items(), fates, counts.data() + 1);
    check_launch("restore_marked");
    undone += fetch(counts.data() + 1, stream);
  }
}

__global__ void count_turned(SurfaceView surface, DeviceMeshView mesh, DeviceStats* stats) {
  const std::uint64_t t = thread_index();
  if (t >= mesh.triangles) return;
  Vec3d p[3];
  SphereId atom[3];
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t v = mesh.corners[3 * t + k];
    p[k] = mesh.positions[v];
    atom[k] = mesh.triangle_spheres != nullptr ? mesh.triangle_spheres[t]
                                               : ids(mesh.vertex_spheres[v])[0];
  }
  if (facing(surface.spheres, p, atom) != Facing::outward) atomicAdd(&stats->turned, 1ull);
}

// ---- the given vertices ----

// Square of the longest edge at each vertex, as bits.
__global__ void raise_longest_edges(DeviceMeshView mesh, unsigned long long* square_bits) {
  const std::uint64_t h = thread_index();
  if (h >= 3 * mesh.triangles) return;
  const std::uint32_t a = mesh.corners[h], b = mesh.corners[h % 3 == 2 ? h - 2 : h + 1];
  const double s = squared_distance(mesh.positions[a], mesh.positions[b]);
  const auto bits = static_cast<unsigned long long>(__double_as_longlong(s));
  atomicMax(&square_bits[a], bits);
  atomicMax(&square_bits[b], bits);
}

__global__ void project_vertices(SurfaceView surface, DeviceMeshView mesh,
                                 const unsigned long long* square_bits, Fate* fates,
                                 DeviceStats* stats) {
  const std::uint64_t v = thread_index();
  if (v >= mesh.vertices) return;
  const double reach = std::sqrt(__longlong_as_double(static_cast<long long>(square_bits[v])));
  const ProjectedPoint p = surface.project(mesh.positions[v], reach);
  fates[v] = Fate::stayed;
  count_outcome(p, true, stats);
  if (p.outcome != ProjectionOutcome::converged) return;
  mesh.positions[v] = p.position;
  const bool keeps_label =
      p.steps == 0 && surface.on_label(p.position, ids(mesh.vertex_spheres[v]));
  if (!keeps_label) mesh.vertex_spheres[v] = make_label(p.spheres);
  if (p.steps > 0) fates[v] = Fate::moved;
}

// What count_outcome() is to be told of a vertex that must lie on the spheres of its label.
__device__ ProjectedPoint judge_constrained(const SurfaceView& surface, const Vec3d& p,
                                            const SphereId* label) {
  const double residual = label_residual(surface.spheres, label, p);
  const bool good = label[0] != kNoSphere && residual <= kProjectionTolerance;
  return {p,
          residual,
          {label[0], label[1], label[2]},
          0,
          good ? ProjectionOutcome::converged : ProjectionOutcome::unconverged};
}

__global__ void count_constrained(SurfaceView surface, DeviceMeshView mesh, DeviceStats* stats) {
  const std::uint64_t v = thread_index();
  if (v >= mesh.vertices) return;
  const SphereId* label = ids(mesh.vertex_spheres[v]);
  count_outcome(judge_constrained(surface, mesh.positions[v], label), true, stats);
}

template <class T>
DeviceArray<T> copy_of(const DeviceArray<T>& array, const Stream& stream) {
  DeviceArray<T> copy(array.size(), stream.get());
  if (array.size() > 0) {
    check_cuda(cudaMemcpyAsync(copy.data(), array.data(), array.bytes(), cudaMemcpyDeviceToDevice,
                               stream.get()),
               "copy on the device");
  }
  return copy;
}

ProjectionStats to_host(const DeviceArray<DeviceStats>& stats, std::uint64_t undone,
                        const Stream& stream) {
  const DeviceStats s = fetch(stats.data(), stream);
  return {s.projected - undone,
          s.unconverged,
          s.out_of_reach,
          undone,
          s.turned,
          s.iterations_max,
          std::bit_cast<double>(s.residual_bits)};
}

void count_turned_triangles(const SurfaceView& surface, const DeviceMeshView& mesh,
                            const DeviceArray<DeviceStats>& stats, const Stream& stream) {
  if (mesh.triangles == 0) return;
  count_turned<<<blocks_for(mesh.triangles, kThreads), kThreads, 0, stream.get()>>>(surface, mesh,
                                                                                    stats.data());
  check_launch("count_turned");
}

ProjectionStats project_given(const SurfaceView& surface, DeviceMesh& mesh, Crossings crossings,
                              const Stream& stream) {
  const DeviceArray<DeviceStats> stats(1, stream.get());
  clear(stats, stream.get());
  std::uint64_t undone = 0;
  const DeviceMeshView view = mesh.view();
  const bool projects = surface.projection != Projection::none && view.vertices > 0;
  if (projects && mesh.triangle_labels() == TriangleLabels::spheres) {
    count_constrained<<<blocks_for(view.vertices, kThreads), kThreads, 0, stream.get()>>>(
        surface, view, stats.data());
    check_launch("count_constrained");
  } else if (projects) {
    const DeviceArray<Vec3d> positions = copy_of(mesh.positions, stream);
    const DeviceArray<VertexSpheres> labels = copy_of(mesh.vertex_spheres, stream);
    DeviceMeshView given = view;
    given.positions = positions.data();
    given.vertex_spheres = labels.data();
    const DeviceArray<unsigned long long> squares(view.vertices, stream.get());
    clear(squares, stream.get());
    if (view.triangles > 0) {
      raise_longest_edges<<<blocks_for(3 * view.triangles, kThreads), kThreads, 0, stream.get()>>>(
          given, squares.data());
      check_launch("raise_longest_edges");
    }
    const DeviceArray<Fate> fates(view.vertices, stream.get());
    project_vertices<<<blocks_for(view.vertices, kThreads), kThreads, 0, stream.get()>>>(
        surface, view, squares.data(), fates.data(), stats.data());
    check_launch("project_vertices");
    undone = take_back_bad_moves(surface, GivenLevel{given, view}, fates.data(), stats.data(),
                                 crossings, stream);
  }
  count_turned_triangles(surface, view, stats, stream);
  return to_host(stats, undone, stream);
}

// ---- subdivision ----

struct OwnsEdge {
  const std::uint32_t* opposite;
  __host__ __device__ std::uint32_t operator()(std::uint64_t h) const {
    return opposite[h] >= h ? 1u : 0u;
  }
};

__global__ void number_edges(const std::uint32_t* opposite, const std::uint32_t* before,
                             std::uint64_t half_edges, std::uint32_t* edge) {
  const std::uint64_t h = thread_index();
  if (h < half_edges) edge[h] = before[opposite[h] >= h ? h : opposite[h]];
}

__global__ void write_children(MidpointLevel level) {
  const std::uint64_t t = thread_index();
  if (t >= level.parent.triangles) return;
  for (int child = 0; child < 4; ++child) {
    for (int k = 0; k < 3; ++k) {
      level.mesh.corners[3 * (4 * t + child) + k] = level.vertex(t, child_corner(child, k));
    }
  }
  if (level.mesh.triangle_spheres != nullptr) {
    for (int child = 0; child < 4; ++child) {
      level.mesh.triangle_spheres[4 * t + child] = level.parent.triangle_spheres[t];
    }
  }
  if (level.mesh.opposite == nullptr) return;
  for (std::uint64_t h = 3 * t; h < 3 * t + 3; ++h) {
    write_child_opposites(static_cast<std::uint32_t>(h), level.parent.opposite[h],
                          level.mesh.opposite);
  }
}

__device__ void interpolate_normal(const MidpointLevel& level, std::uint64_t h) {
  level.mesh.normals[level.midpoint_of(h)] =
      unit_normal(cast<double>(level.parent.normals[level.start_of(h)]) +
                  cast<double>(level.parent.normals[level.end_of(h)]));
}

// Midpoints on the spheres of the triangles on both sides.
__global__ void make_constrained_midpoints(SurfaceView surface, MidpointLevel level,
                                           bool with_normals, DeviceStats* stats) {
  const std::uint64_t h = thread_index();
  if (h >= 3 * level.parent.triangles || !level.has_item(h)) return;
  if (with_normals) interpolate_normal(level, h);
  const DeviceMeshView& parent = level.parent;
  const VertexSpheres label =
      edge_label(parent.triangle_spheres[h / 3], parent.triangle_spheres[parent.opposite[h] / 3]);
  const std::uint32_t v = level.midpoint_of(h);
  level.mesh.vertex_spheres[v] = label;
  if (surface.projection == Projection::none) {
    level.mesh.positions[v] = level.start(h);
    return;
  }
  const Vec3d p =
      constrained_midpoint(surface.spheres, ids(label), parent.positions[level.start_of(h)],
                           parent.positions[level.end_of(h)]);
  level.mesh.positions[v] = p;
  count_outcome(judge_constrained(surface, p, ids(label)), true, stats);
}

__global__ void make_midpoints(SurfaceView surface, MidpointLevel level, bool with_normals,
                               Fate* fates, DeviceStats* stats) {
  const std::uint64_t h = thread_index();
  if (h >= 3 * level.parent.triangles || !level.has_item(h)) return;
  const std::uint32_t v = level.midpoint_of(h);
  const Vec3d start = level.start(h);
  if (with_normals) interpolate_normal(level, h);
  Fate fate = Fate::stayed;
  bool projected = false;
  if (surface.projection != Projection::none) {
    const double reach = midpoint_reach(level.parent.positions[level.start_of(h)],
                                        level.parent.positions[level.end_of(h)]);
    const ProjectedPoint p = surface.project(start, reach);
    count_outcome(p, true, stats);
    projected = p.outcome == ProjectionOutcome::converged;
    if (projected) {
      level.mesh.positions[v] = p.position;
      level.mesh.vertex_spheres[v] = make_label(p.spheres);
      if (p.steps > 0) fate = Fate::moved;
    }
  }
  if (!projected) level.take_back(surface, h);
  fates[level.handled_by_item(h)] = fate;
}

__global__ void compute_normals(SurfaceView surface, DeviceMeshView mesh) {
  const std::uint64_t v = thread_index();
  if (v >= mesh.vertices) return;
  const Vec3d& p = mesh.positions[v];
  const SphereId* label = ids(mesh.vertex_spheres[v]);
  mesh.normals[v] = mesh.triangle_spheres != nullptr ? constrained_normal(surface.spheres, label, p)
                                                     : surface.normal(p, label);
}

DeviceArray<std::uint32_t> edge_numbers(const DeviceMeshView& parent, const Stream& stream) {
  const std::uint64_t half_edges = 3 * parent.triangles;
  DeviceArray<std::uint32_t> edge(half_edges, stream.get());
  const DeviceArray<std::uint32_t> before(half_edges + 1, stream.get());
  sums_before(thrust::make_transform_iterator(thrust::counting_iterator<std::uint64_t>(0),
                                              OwnsEdge{parent.opposite}),
              half_edges, before.data(), stream.get());
  number_edges<<<blocks_for(half_edges, kThreads), kThreads, 0, stream.get()>>>(
      parent.opposite, before.data(), half_edges, edge.data());
  check_launch("number_edges");
  return edge;
}

template <class T>
void copy_front(const DeviceArray<T>& from, const DeviceArray<T>& to, const Stream& stream) {
  if (from.size() == 0) return;
  check_cuda(
      cudaMemcpyAsync(to.data(), from.data(), from.bytes(), cudaMemcpyDeviceToDevice, stream.get()),
      "copy on the device");
}

struct Subdivided {
  DeviceMesh mesh;
  ProjectionStats stats;
};

Subdivided subdivide(const SurfaceView& surface, const DeviceMesh& parent, Crossings crossings,
                     const Stream& stream) {
  const std::uint64_t half_edges = 3 * parent.triangle_count();
  const std::uint64_t vertices = parent.vertex_count() + half_edges / 2;
  Subdivided child;
  DeviceMesh& mesh = child.mesh;
  mesh.positions = DeviceArray<Vec3d>(vertices, stream.get());
  mesh.vertex_spheres = DeviceArray<VertexSpheres>(vertices, stream.get());
  mesh.corners = DeviceArray<std::uint32_t>(4 * half_edges, stream.get());
  if (4 * half_edges <= kMaxHalfEdges) {
    mesh.opposite = DeviceArray<std::uint32_t>(4 * half_edges, stream.get());
  }
  mesh.triangle_spheres = DeviceArray<SphereId>(4 * parent.triangle_spheres.size(), stream.get());
  copy_front(parent.positions, mesh.positions, stream);
  copy_front(parent.vertex_spheres, mesh.vertex_spheres, stream);
  // Without a surface to take them from, normals are interpolated where the parent has them.
  const bool keeps_normals = surface.projection == Projection::none && parent.normals.size() > 0;
  if (keeps_normals || surface.projection != Projection::none) {
    mesh.normals = DeviceArray<Vec3f>(vertices, stream.get());
  }
  if (keeps_normals) copy_front(parent.normals, mesh.normals, stream);

  const DeviceArray<std::uint32_t> edge = edge_numbers(parent.view(), stream);
  const MidpointLevel level{parent.view(), mesh.view(), edge.data()};
  const std::uint64_t triangles = parent.triangle_count();
  write_children<<<blocks_for(triangles, kThreads), kThreads, 0, stream.get()>>>(level);
  check_launch("write_children");
  const DeviceArray<DeviceStats> stats(1, stream.get());
  clear(stats, stream.get());
  std::uint64_t undone = 0;
  if (parent.triangle_labels() == TriangleLabels::spheres) {
    make_constrained_midpoints<<<blocks_for(half_edges, kThreads), kThreads, 0, stream.get()>>>(
        surface, level, keeps_normals, stats.data());
    check_launch("make_constrained_midpoints");
  } else {
    const DeviceArray<Fate> fates(half_edges / 2, stream.get());
    make_midpoints<<<blocks_for(half_edges, kThreads), kThreads, 0, stream.get()>>>(
        surface, level, keeps_normals, fates.data(), stats.data());
    check_launch("make_midpoints");
    undone = take_back_bad_moves(surface, level, fates.data(), stats.data(), crossings, stream);
  }
  count_turned_triangles(surface, mesh.view(), stats, stream);
  child.stats = to_host(stats, undone, stream);
  return child;
}

}  // namespace

DeviceRefinement refine_on_device(const SurfaceView& surface, DeviceMesh mesh,
                                  const RefineOptions& options, const Stream& stream) {
  DeviceRefinement result;
  const auto observe = [&](int level) {
    if (options.on_level) options.on_level(level, download(mesh, Connectivity::triangles, stream));
  };
  observe(0);
  StageClock clock(stream.get());
  result.levels.push_back(project_given(surface, mesh, options.crossings, stream));
  result.level_milliseconds.push_back(clock.lap());
  advance(options.monitor, 1);
  for (int l = 1; l <= options.subdivisions; ++l) {
    ProjectionStats stats;
    if (mesh.triangle_count() > 0) {
      Subdivided next = subdivide(surface, mesh, options.crossings, stream);
      mesh = std::move(next.mesh);
      stats = next.stats;
    }
    result.levels.push_back(stats);
    result.level_milliseconds.push_back(clock.lap());
    observe(l);
    clock.restart();
    advance(options.monitor, 1);
  }
  if (surface.projection != Projection::none && mesh.vertex_count() > 0) {
    compute_normals<<<blocks_for(mesh.vertex_count(), kThreads), kThreads, 0, stream.get()>>>(
        surface, mesh.view());
    check_launch("compute_normals");
  }
  result.level_milliseconds.push_back(clock.lap());
  result.mesh = std::move(mesh);
  return result;
}

}  // namespace vdwmesh
