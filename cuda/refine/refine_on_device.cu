// Refinement in device memory, level by level: memory, order of the kernels, and timing. The
// kernels are declared in make_vertices.cuh and bad_moves.cuh. Level 0 projects the given vertices;
// every further level subdivides the mesh of the level before, its parent.
//
// Vertices keep their numbers from level to level. Their arrays therefore get their final size at
// the start, and each level writes its midpoints behind the vertices that are there. Triangles are
// replaced on each level, so their arrays are allocated anew. All memory is taken in stream order.
#include <bit>
#include <utility>

#include "core/monitor.hpp"
#include "cuda/refine/device_crossings.cuh"
#include "cuda/refine/device_refinement.cuh"
#include "cuda/refine/half_edges.cuh"
#include "cuda/refine/make_vertices.cuh"

namespace vdwmesh {
namespace {

// Whether a mesh with so many triangles gets half-edges: if their numbers fit the 32 bits of
// `DeviceMeshView::opposite`.
bool has_half_edges(std::uint64_t triangles) { return 3 * triangles <= kMaxHalfEdges; }

// An array of `size` >= from.size() elements that begins with those of `from`; the others are
// uninitialised.
template <class T>
DeviceArray<T> grown(DeviceArray<T> from, std::uint64_t size, const Stream& stream) {
  if (from.size() == size) return from;
  DeviceArray<T> to(size, stream.get());
  if (from.size() > 0) {
    check_cuda(cudaMemcpyAsync(to.data(), from.data(), from.bytes(), cudaMemcpyDeviceToDevice,
                               stream.get()),
               "copy on the device");
  }
  return to;
}

// The mesh of the current level. Its vertex arrays are long enough for the vertices of all later
// levels.
struct GrowingMesh {
  DeviceMesh mesh;
  std::uint64_t vertices;  // vertices that exist so far
  // Which triangles are safe: those whose children face outward if their midpoints are regular. It
  // is PatchMarks::parent_safe of the next level. Empty: not kept.
  DeviceArray<std::uint8_t> safe;

  DeviceMeshView view() const {
    DeviceMeshView v = mesh.view();
    v.vertices = vertices;
    return v;
  }
};

// Labels for `vertices` vertices, of three spheres each, that begin with the given labels. The
// given ones may name one sphere only: filling the others with 0xff bytes makes them kNoSphere.
DeviceVertexLabels with_room(DeviceVertexLabels labels, std::uint64_t vertices,
                             const Stream& stream) {
  if (labels.others.size() == 0 && vertices > 0) {
    labels.others = DeviceArray<OtherSpheres>(vertices, stream.get());
    static_assert(kNoSphere == 0xffffffffu);
    check_cuda(cudaMemsetAsync(labels.others.data(), 0xff, labels.others.bytes(), stream.get()),
               "labels");
  }
  labels.atoms = grown(std::move(labels.atoms), vertices, stream);
  labels.others = grown(std::move(labels.others), vertices, stream);
  return labels;
}

// Makes the vertex arrays of the mesh long enough for `vertices` vertices. What becomes of the
// normals depends on the surface:
// - none: given normals are kept, and interpolated on each level.
// - vdw, triangles without labels: the kernels that make the vertices compute the normals too.
// - otherwise: normals are dropped here, and computed after the last level by finish_normals().
GrowingMesh with_room(DeviceMesh mesh, Projection projection, std::uint64_t vertices,
                      const Stream& stream) {
  GrowingMesh growing{std::move(mesh), 0, {}};
  DeviceMesh& m = growing.mesh;
  growing.vertices = m.vertex_count();
  const bool has_normals = m.normals.size() > 0;
  m.positions = grown(std::move(m.positions), vertices, stream);
  m.vertex_spheres = with_room(std::move(m.vertex_spheres), vertices, stream);
  if (projection == Projection::none) {
    if (has_normals) m.normals = grown(std::move(m.normals), vertices, stream);
  } else if (projection == Projection::vdw && m.triangle_labels() == TriangleLabels::none) {
    if (m.normals.size() != vertices) m.normals = DeviceArray<Vec3f>(vertices, stream.get());
  } else {
    m.normals = DeviceArray<Vec3f>();
  }
  return growing;
}

// Downloads the counts of a level. The kernels have counted as projected all vertices that
// converged; the `undone` vertices whose moves were taken back are subtracted here.
ProjectionStats to_host(const DeviceArray<DeviceStats>& stats, std::uint64_t undone,
                        const Stream& stream) {
  const DeviceStats s = fetch(stats.data(), stream);
  return {.projected = s.projected - undone,
          .unconverged = s.unconverged,
          .out_of_reach = s.out_of_reach,
          .undone = undone,
          .turned = s.turned,
          .iterations_max = s.iterations_max,
          .residual_max = std::bit_cast<double>(s.residual_bits)};
}

// Whether vertices are projected onto the union without being bound to the labels of triangles.
// Safe triangles are marked in this case only: the proof at PatchMarks assumes that a midpoint
// moves radially to the sphere of both ends of its edge, and only here do most.
bool is_freely_projected_union(const SurfaceView& surface, const DeviceMeshView& mesh) {
  return surface.projection == Projection::vdw && mesh.triangle_spheres == nullptr;
}

// Level 0: projects the vertices and counts the turned triangles, those that do not face outward.
// If a subdivision follows, it also marks the safe triangles for it. Vertices of labelled triangles
// are not moved, only counted.
ProjectionStats project_given(const SurfaceView& surface, GrowingMesh& growing,
                              const RefineOptions& options, std::uint64_t pairs_at_once,
                              const Stream& stream) {
  const auto stats = zeros<DeviceStats>(1, stream);
  const DeviceMeshView mesh = growing.view();
  std::uint64_t undone = 0;
  if (surface.projection != Projection::none) {
    if (mesh.triangle_spheres != nullptr) {
      count_constrained_on_device(surface, mesh, stats.data(), stream);
    } else {
      undone = project_given_on_device(surface, mesh, options, pairs_at_once, stats.data(), stream);
    }
  }
  if (is_freely_projected_union(surface, mesh) && options.subdivisions > 0) {
    // A byte for four consecutive triangles; on later levels these are the children of a parent.
    growing.safe = DeviceArray<std::uint8_t>((mesh.triangles + 3) / 4, stream.get());
  }
  count_turned_on_device(surface, mesh, growing.safe.data(), stats.data(), stream);
  return to_host(stats, undone, stream);
}

// Length of the list of bad moves: those that turn a triangle over or make triangles cross. Fewer
// than 2 % of the midpoints went back in all measured cases (docs/refinement.md); 1/32 is 3 %, and
// the constant serves small meshes. If a list is too short, a search over all midpoints is made.
std::uint64_t room_for_bad_moves(std::uint64_t midpoints) { return midpoints / 32 + 4096; }

// Subdivision level_number, from 1 on: adds the midpoints to `growing` and replaces its triangles
// by their children.
ProjectionStats subdivide(const SurfaceView& surface, GrowingMesh& growing, int level_number,
                          const RefineOptions& options, std::uint64_t pairs_at_once,
                          RefineTimings& timings, const Stream& stream) {
  StageMarks stages(stream.get());
  const DeviceMeshView parent = growing.view();
  const MeshSize size = subdivided({parent.vertices, parent.triangles});
  const DeviceEdgeNumbers edges(parent.opposite, 3 * parent.triangles, stream);
  DeviceMesh children;
  children.corners = DeviceArray<std::uint32_t>(3 * size.triangles, stream.get());
  const bool is_last = level_number == options.subdivisions;
  // The next level numbers its edges by half-edges; after the last one they serve the caller.
  if (has_half_edges(size.triangles) && (!is_last || size.triangles <= options.half_edges_up_to)) {
    children.opposite = DeviceArray<std::uint32_t>(3 * size.triangles, stream.get());
  }
  const bool constrained = parent.triangle_spheres != nullptr;
  if (constrained) children.triangle_spheres = DeviceArray<SphereId>(size.triangles, stream.get());
  DeviceMeshView mesh = parent;  // with the vertex arrays of `parent`, but other triangles
  mesh.corners = children.corners.data();
  mesh.opposite = children.opposite.data();
  mesh.vertices = size.vertices;
  mesh.triangles = size.triangles;
  mesh.triangle_spheres = children.triangle_spheres.data();
  const std::uint64_t midpoints = size.vertices - parent.vertices;
  const bool keeps_marks = growing.safe.size() > 0;  // PatchMarks
  const DeviceArray<std::uint8_t> regular(keeps_marks ? midpoints : 0, stream.get());
  // The last level keeps no marks of its children: no level follows that would read them.
  DeviceArray<std::uint8_t> child_safe(keeps_marks && !is_last ? parent.triangles : 0,
                                       stream.get());
  // The parents whose children's orientation must be tested.
  const DeviceArray<std::uint32_t> to_test(keeps_marks ? parent.triangles : 0, stream.get());
  const auto to_test_count = zeros<unsigned long long>(1, stream);
  const MidpointLevel level{.parent = parent,
                            .mesh = mesh,
                            .edges = edges.view(),
                            .marks = {.regular = regular.data(),
                                      .parent_safe = growing.safe.data(),
                                      .child_safe = child_safe.data(),
                                      .list = to_test.data(),
                                      .listed = to_test_count.data()},
                            .is_first = level_number == 1};
  const bool moves = surface.projection != Projection::none && !constrained;
  // One byte each. The kernels write them with Projection::none too, though nothing moves.
  static_assert(sizeof(MoveState) == 1);
  const DeviceArray<MoveState> move_states(constrained ? 0 : move_state_bytes(midpoints),
                                           stream.get());
  const std::uint64_t room = moves ? room_for_bad_moves(midpoints) : 0;
  const DeviceArray<std::uint32_t> bad_moves(room, stream.get());
  const auto bad_move_count = zeros<unsigned long long>(1, stream);
  const auto stats = zeros<DeviceStats>(1, stream);
  stages.mark();
  if (constrained) {
    make_constrained_midpoints_on_device(surface, level, stats.data(), stream);
  } else {
    make_midpoints_on_device(surface, level, move_states.data(), stats.data(), stream);
  }
  stages.mark();
  const LevelPasses passes{.surface = surface,
                           .move_states = {.move_states = moves ? move_states.data() : nullptr,
                                           .first_handled = parent.vertices,
                                           .marked = bad_move_count.data(),
                                           .list = bad_moves.data(),
                                           .room = room},
                           .stats = stats.data(),
                           .crossings = options.crossings,
                           .monitor = options.monitor,
                           .pairs_at_once = pairs_at_once};
  make_children_on_device(level, passes, stream);
  stages.mark();
  const std::uint64_t undone = moves ? take_back_bad_moves(level, passes, stream) : 0;
  stages.mark();
  const ProjectionStats result = to_host(stats, undone, stream);
  timings = {stages.stage(0), stages.stage(1), stages.stage(2), stages.stage(3)};
  growing.mesh.corners = std::move(children.corners);
  growing.mesh.opposite = std::move(children.opposite);
  growing.mesh.triangle_spheres = std::move(children.triangle_spheres);
  growing.vertices = size.vertices;
  growing.safe = std::move(child_safe);
  return result;
}

// Computes the normals after the last level, if the levels have not made them: see with_room().
// Frees them if none are wanted.
void finish_normals(const SurfaceView& surface, Normals wanted, DeviceMesh& mesh,
                    const Stream& stream) {
  if (wanted == Normals::none) {
    mesh.normals = DeviceArray<Vec3f>();
    return;
  }
  if (surface.projection == Projection::none) return;
  if (surface.projection == Projection::vdw && mesh.triangle_labels() == TriangleLabels::none) {
    return;
  }
  mesh.normals = DeviceArray<Vec3f>(mesh.vertex_count(), stream.get());
  compute_normals_on_device(surface, mesh.view(), stream);
}

}  // namespace

std::uint64_t device_refine_bytes(std::uint64_t vertices, std::uint64_t triangles,
                                  const RefineOptions& options, TriangleLabels labels,
                                  std::uint64_t pairs_at_once) {
  const MeshSize given{vertices, triangles};
  const MeshSize parent =
      options.subdivisions > 0 ? subdivided(given, options.subdivisions - 1) : MeshSize{};
  const MeshSize size = subdivided(given, options.subdivisions);
  const auto triangle_bytes = [&](const MeshSize& s) {
    const std::uint64_t arrays = has_half_edges(s.triangles) ? 6 : 3;
    return s.triangles * (arrays * sizeof(std::uint32_t) +
                          (labels == TriangleLabels::spheres ? sizeof(SphereId) : 0));
  };
  const std::uint64_t mesh =
      size.vertices * (sizeof(Vec3d) + sizeof(Vec3f) + label_bytes(LabelWidth::three)) +
      triangle_bytes(size) + triangle_bytes(parent) +
      DeviceEdgeNumbers::bytes(3 * parent.triangles);
  if (labels == TriangleLabels::spheres) return mesh;
  // Per midpoint its state (1 byte), its regular mark (1) and its place in make_midpoints.cu's list
  // of deferred midpoints (4); per parent triangle its place in the list of those to test; per four
  // triangles a byte of safe marks; and two lists of bad moves (take_back_bad_moves() has a spare).
  const std::uint64_t midpoints = size.vertices - parent.vertices;
  const std::uint64_t level_arrays = (1 + 1 + sizeof(std::uint32_t)) * midpoints +
                                     sizeof(std::uint32_t) * parent.triangles + size.triangles / 4 +
                                     2 * sizeof(std::uint32_t) * room_for_bad_moves(midpoints);
  if (options.crossings == Crossings::allow || options.projection == Projection::none) {
    return mesh + level_arrays;
  }
  // The patches in which the last level looks for crossings: the given triangles if it is level 0
  // or 1, else the triangles of two levels before, of which each has four children in `parent`.
  const std::uint64_t patches = options.subdivisions < 2 ? given.triangles : parent.triangles / 4;
  return mesh + level_arrays +
         crossing_search_bytes(patches, options.subdivisions > 0, pairs_at_once);
}

DeviceRefinement refine_on_device(const SurfaceView& surface, DeviceMesh mesh,
                                  const RefineOptions& options, const Stream& stream,
                                  std::uint64_t pairs_at_once) {
  const MeshSize given{mesh.vertex_count(), mesh.triangle_count()};
  require_device_memory(device_refine_bytes(given.vertices, given.triangles, options,
                                            mesh.triangle_labels(), pairs_at_once),
                        "refinement", options.device_memory);
  if (options.subdivisions > 0 && mesh.opposite.size() == 0) {
    mesh.opposite = find_opposite_on_device(mesh.view(), stream);
  }
  DeviceRefinement result;
  StageClock clock(stream.get());
  GrowingMesh growing = with_room(std::move(mesh), options.projection,
                                  subdivided(given, options.subdivisions).vertices, stream);
  const auto observe = [&](int level) {
    if (!options.on_level) return;
    DeviceMeshView seen = growing.view();
    seen.normals = nullptr;
    options.on_level(level, download(seen, Connectivity::triangles, stream));
  };
  // The observer of a level downloads the mesh: its time is left out of the measured times. It sees
  // level 0 before the projection (LevelObserver).
  float ms = clock.lap();
  observe(0);
  clock.restart();
  result.levels.push_back(project_given(surface, growing, options, pairs_at_once, stream));
  result.level_milliseconds.push_back(ms + clock.lap());
  advance(options.monitor, 1);
  for (int l = 1; l <= options.subdivisions; ++l) {
    RefineTimings timings;
    ProjectionStats stats;
    if (growing.mesh.triangle_count() > 0) {
      stats = subdivide(surface, growing, l, options, pairs_at_once, timings, stream);
    }
    result.levels.push_back(stats);
    result.timings.push_back(timings);
    result.level_milliseconds.push_back(clock.lap());
    observe(l);
    clock.restart();
    advance(options.monitor, 1);
  }
  finish_normals(surface, options.normals, growing.mesh, stream);
  result.level_milliseconds.push_back(clock.lap());
  result.mesh = std::move(growing.mesh);
  return result;
}

}  // namespace vdwmesh
