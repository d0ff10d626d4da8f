// What every backend does before it refines. It checks options, sizes, bytes and mesh;
// refine_bytes() estimates the bytes for the memory limit. It completes the arrays that level 0
// needs, and makes the field and the cell list of the projection. Arrays are searched in parallel
// for the bad element of lowest index, so the error names the same element whatever the number of
// threads.
#include "refine/crossings/preparation.hpp"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "extract/field_list.hpp"
#include "refine/crossings/part_boxes.hpp"
#include "refine/crossings/patch_grid.hpp"
#include "refine/crossings/patch_lanes.hpp"
#include "refine/crossings/patch_outline.hpp"
#include "refine/half_edges.hpp"
#include "surface/star_fans.hpp"

namespace vdwmesh {
namespace {

// The mesh of the last level and its parent. The parent is divided, for which it has half-edges.
// Its normals count where the child's do: without a projection they are there at the same time.
std::uint64_t bytes_of_meshes(const MeshSize& parent, const MeshSize& size, const RefineOptions& o,
                              TriangleLabels labels) {
  MeshArrays arrays{.connectivity = Connectivity::half_edges,
                    .labels = labels,
                    .normals = Normals::gradients,
                    .width = LabelWidth::three};
  if (o.subdivisions == 0) return indexed_mesh_bytes(size, arrays);
  arrays.normals = o.normals;
  const std::uint64_t of_parent = indexed_mesh_bytes(parent, arrays);
  if (size.triangles > o.half_edges_up_to) arrays.connectivity = Connectivity::triangles;
  return of_parent + indexed_mesh_bytes(size, arrays);
}

// Bytes that each thread keeps of the patches of the fullest cell so far (bad_moves.cpp): outline,
// triangles and numbers of each part. Some 100 patches are in the fullest cells of crowds of balls
// at random.
std::uint64_t scratch_bytes(const MeshSize& patched, int subdivisions) {
  constexpr std::uint64_t kFullCell = 112, kNumbers = 64;
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  const std::uint64_t parts = subdivisions < 2 ? 1 : 4;
  return threads * std::min(kFullCell, patched.triangles) * parts *
         (sizeof(PatchOutline) + sizeof(PatchLanes) + kNumbers);
}

void check_options(const RefineOptions& o) {
  if (o.subdivisions < 0 || o.subdivisions > kMaxSubdivisions) {
    throw InvalidInput(
        fmt::format("subdivisions {}: must be from 0 to {}", o.subdivisions, kMaxSubdivisions));
  }
}

// Indices have 32 bits. The half-edges of each level that is subdivided further must fit them, and
// the vertices of each level. If crossings are looked for, so must the triangles of the last level,
// because a device lists pairs of them by numbers of 32 bits (cuda/refine/device_crossings.cu).
// Finally the memory limit is checked; the error names the number of subdivisions that would fit.
void check_limits(std::uint64_t spheres, MeshSize size, const RefineOptions& o,
                  TriangleLabels labels) {
  const MeshSize given = size;
  for (int l = 1; l <= o.subdivisions; ++l) {
    const MeshSize next = subdivided(size);
    if (3 * size.triangles > kMaxHalfEdges || next.vertices > kMaxVertices) {
      throw LimitExceeded(fmt::format(
          "subdivision {} of {} would have {} vertices and {} triangles; at most {} vertices, and "
          "{} triangles before the last subdivision, can be numbered: use fewer subdivisions",
          l, o.subdivisions, next.vertices, next.triangles, kMaxVertices, kMaxHalfEdges / 3));
    }
    size = next;
  }
  const bool looks_for_crossings = labels == TriangleLabels::none &&
                                   o.projection != Projection::none &&
                                   o.crossings != Crossings::allow;
  if (looks_for_crossings && size.triangles > PatchGrid::kMostEntries) {
    throw LimitExceeded(fmt::format(
        "refinement to {} triangles: crossings are looked for among {} at most: use fewer "
        "subdivisions, or allow crossings",
        size.triangles, PatchGrid::kMostEntries));
  }
  const std::uint64_t bytes = refine_bytes(given, spheres, o, labels);
  if (bytes <= o.memory_limit) return;
  const auto fits = [&](int levels) {
    RefineOptions fewer = o;
    fewer.subdivisions = levels;
    return refine_bytes(given, spheres, fewer, labels) <= o.memory_limit;
  };
  int fitting = o.subdivisions - 1;
  while (fitting > 0 && !fits(fitting)) --fitting;
  throw LimitExceeded(fmt::format(
      "refinement to {} triangles needs {} bytes, {} are allowed: use {}, or allow more memory",
      size.triangles, bytes, o.memory_limit,
      fitting > 0 ? fmt::format("at most {} subdivisions", fitting)
                  : "no subdivision, a coarser mesh"));
}

void check_size(const char* what, std::size_t size, std::size_t expected) {
  if (size == 0 || size == expected) return;
  throw InvalidInput(fmt::format("the mesh has {} {}, {} are needed", size, what, expected));
}

bool is_beyond(const SphereSet& spheres, SphereId id) { return id >= spheres.size(); }

void check_triangle_spheres(const SphereSet& spheres, const IndexedMesh& mesh) {
  if (mesh.triangle_labels() == TriangleLabels::none) return;
  if (mesh.vertex_spheres.empty()) {
    throw InvalidInput("the mesh's triangles name their spheres, its vertices do not: label them");
  }
  const auto triangle = first_of_all(mesh.triangle_count(), [&](std::size_t t) {
    return is_beyond(spheres, mesh.triangle_spheres[t]);
  });
  if (triangle) {
    throw InvalidInput(
        fmt::format("triangle {} lies on a sphere beyond the set's {}", *triangle, spheres.size()));
  }
}

}  // namespace

void check_refinement_size(std::uint64_t spheres, std::uint64_t vertices, std::uint64_t triangles,
                           const RefineOptions& options, TriangleLabels labels) {
  check_options(options);
  if (labels == TriangleLabels::spheres && options.projection == Projection::field) {
    throw InvalidInput(
        "the mesh's triangles lie on spheres, not on a blended field: project them to vdw");
  }
  check_limits(spheres, {vertices, triangles}, options, labels);
}

void check_mesh(const SphereSet& spheres, const IndexedMesh& mesh) {
  check_size("normals", mesh.normals.size(), mesh.vertex_count());
  check_size("vertex labels", mesh.vertex_spheres.size(), mesh.vertex_count());
  check_size("labels of creases", mesh.vertex_spheres.others.size(), mesh.vertex_count());
  check_size("triangle labels", mesh.triangle_spheres.size(), mesh.triangle_count());
  check_size("opposite half-edges", mesh.opposite.size(), 3 * mesh.triangle_count());
  const auto triangle = first_of_all(mesh.triangle_count(), [&](std::size_t t) {
    const Triangle& v = mesh.triangles[t];
    return *std::max_element(v.begin(), v.end()) >= mesh.vertex_count();
  });
  if (triangle) {
    throw InvalidInput(fmt::format("triangle {} has a vertex beyond the mesh's {}", *triangle,
                                   mesh.vertex_count()));
  }
  const auto vertex = first_of_all(mesh.vertex_count(), [&](std::size_t v) {
    const Vec3d& p = mesh.positions[v];
    const auto is_near = [](double x) { return std::abs(x) <= kFarthestSphere; };  // false for NaN
    return !(is_near(p.x) && is_near(p.y) && is_near(p.z));
  });
  if (vertex) {
    throw InvalidInput(
        fmt::format("vertex {} has a coordinate that is not finite, or farther than {:g} Å from 0",
                    *vertex, kFarthestSphere));
  }
  const auto label = first_of_all(mesh.vertex_spheres.size(), [&](std::size_t v) {
    const VertexSpheres s = mesh.vertex_spheres[v];
    return std::any_of(s.begin(), s.end(),
                       [&](SphereId id) { return id != kNoSphere && is_beyond(spheres, id); });
  });
  if (label) {
    throw InvalidInput(
        fmt::format("vertex {} lies on a sphere beyond the set's {}", *label, spheres.size()));
  }
}

void check_refinement(const SphereSet& spheres, const IndexedMesh& mesh,
                      const RefineOptions& options) {
  check_refinement_size(spheres.size(), mesh.vertex_count(), mesh.triangle_count(), options,
                        mesh.triangle_labels());
  check_mesh(spheres, mesh);
  check_triangle_spheres(spheres, mesh);
}

namespace {

// `= {}` would leave an array without elements its memory.
void drop_normals(IndexedMesh& mesh, const RefineOptions& options) {
  const bool is_projected = options.projection != Projection::none;
  if (is_projected || options.normals == Normals::none) mesh.normals = Buffer<Vec3f>();
}

}  // namespace

IndexedMesh complete_labels(IndexedMesh mesh, const RefineOptions& options) {
  drop_normals(mesh, options);
  if (mesh.vertex_spheres.empty()) {
    mesh.vertex_spheres.assign(mesh.vertex_count(), on_sphere(kNoSphere));
  }
  mesh.vertex_spheres.widen();
  return mesh;
}

IndexedMesh prepare_mesh(IndexedMesh mesh, const RefineOptions& options) {
  drop_normals(mesh, options);  // before more memory is taken
  if (options.subdivisions > 0) mesh.opposite = find_opposite(mesh);
  return complete_labels(std::move(mesh), options);
}

std::uint64_t refine_bytes(std::uint64_t vertices, std::uint64_t triangles, std::uint64_t spheres,
                           int subdivisions, TriangleLabels labels) {
  RefineOptions all;
  all.subdivisions = subdivisions;
  return refine_bytes({vertices, triangles}, spheres, all, labels);
}

std::uint64_t refine_bytes(const MeshSize& given, std::uint64_t spheres,
                           const RefineOptions& options, TriangleLabels labels) {
  const int subdivisions = options.subdivisions;
  const MeshSize parent = subdivisions > 0 ? subdivided(given, subdivisions - 1) : MeshSize{};
  const MeshSize size = subdivided(given, subdivisions);
  // Besides the two meshes, the numbers of the parent's edges, one per half-edge.
  const std::uint64_t edges = parent.triangles * 3 * sizeof(std::uint32_t);
  const std::uint64_t meshes = bytes_of_meshes(parent, size, options, labels) + edges;
  if (labels == TriangleLabels::spheres) return meshes;
  // `marks`: one byte per vertex for its MoveState, and 8 per given vertex for its longest edge.
  // `grid`: the grid in which crossings are looked for, with a box of 24 bytes per patch, two cells
  // (4 bytes for the start of the list and 1 for the dirty flag) and about three entries of 4
  // bytes, and whether the patch is wanted. A patch is a triangle of the given mesh, of the parent
  // on level 1, and from level 2 on of the parent's parent; it then has boxes of its parts.
  // `list`: the cell list. It has the sphere and four integers per sphere, among them rank and id,
  // and the starts of its cells: each of its levels has at most 4096 cells, or 8 per sphere of the
  // level if that is more.
  const std::uint64_t marks = size.vertices + given.vertices * sizeof(std::uint64_t);
  // Its triangles are the patches, and its vertices their corners.
  const MeshSize patched = subdivided(given, std::max(0, subdivisions - 2));
  const std::uint64_t of_parts = subdivisions < 2 ? 0 : sizeof(PartBoxes);
  const std::uint64_t grid = patched.triangles * (24 + 2 * (4 + 1) + 3 * 4 + 1 + of_parts);
  // `fans`: state and direction of the fan of each corner of patches, and what is known of each
  // patch. Level 0 has none.
  const std::uint64_t fans = subdivisions == 0
                                 ? 0
                                 : patched.vertices * (sizeof(std::uint64_t) + sizeof(Vec3f)) +
                                       patched.triangles * sizeof(StarFans::Judgement);
  // `chosen`: numbers of 8 bytes of the patches and cells that a pass has chosen, two for each
  // patch, which is more than crowds of balls at random need. `copies`: places and labels of
  // vertices, from which level 0 puts them back.
  const std::uint64_t chosen = patched.triangles * 2 * sizeof(std::size_t);
  const std::uint64_t copies =
      subdivisions > 0 ? 0 : size.vertices * (sizeof(Vec3d) + label_bytes(LabelWidth::three));
  const std::uint64_t scratch = scratch_bytes(patched, subdivisions);
  const std::uint64_t list = spheres * (sizeof(Sphere) + (4 + 8) * sizeof(std::uint32_t)) +
                             std::uint64_t{CellListView::kMaxLevels} * 4096 * 4;
  return meshes + marks + grid + fans + chosen + copies + scratch + list;
}

FieldModel projection_model(const RefineOptions& o) {
  if (o.projection != Projection::field) return {};
  if (o.field.kind == FieldKind::vdw) {
    throw InvalidInput(
        "projection onto the field needs a blended field (blinn, soft, inverse-squared); project "
        "the vdw field with vdw");
  }
  if (!(o.grid.spacing > 0 && std::isfinite(o.grid.spacing))) {
    throw InvalidInput("projection onto the field needs the grid of the extraction");
  }
  return make_field_model(o.field, o.grid);
}

CellListView projection_list(const SphereSet& spheres, const RefineOptions& options,
                             TriangleLabels labels, Workspace& workspace) {
  const bool searches = labels == TriangleLabels::none && options.projection != Projection::none;
  if (!searches) return {};
  const bool to_field = options.projection == Projection::field;
  const FieldModel model = to_field ? projection_model(options) : FieldModel{};
  return field_list(spheres, model, to_field ? options.frame : nullptr, workspace);
}

SurfaceView target_surface(const SphereSet& spheres, const RefineOptions& options,
                           TriangleLabels labels, Workspace& workspace) {
  return {.projection = options.projection,
          .list = projection_list(spheres, options, labels, workspace),
          .model = projection_model(options),
          .spheres = spheres.spheres().data()};
}

}  // namespace vdwmesh
