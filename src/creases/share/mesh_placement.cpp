// Fills the mesh: positions in Å, normals, labels, and triangles. Every vertex and triangle has a
// place of its own, so all cores write at the same time. union_mesher.cpp numbers the vertices
// before; where a device has meshed patches, it writes them in the same way (cuda/mesher/).
#include "creases/share/mesh_placement.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"
#include "creases/plane/boundary_vertex.hpp"

namespace vdwmesh {

bool MeshPlacement::is_whole() const {
  return corners() == boundary_.corners.size() &&
         std::uint64_t{corners()} + points_ == sampling_.vertex_count();
}

// The difference of a number below a run wraps around to one that is beyond it.
bool MeshPlacement::is_own(std::uint32_t number) const {
  return number < boundary_.corners.size() ? number - share_.corners.first < corners()
                                           : number - first_point_ < points_;
}

std::uint32_t MeshPlacement::local(std::uint32_t number) const {
  if (is_own(number)) {
    return number < boundary_.corners.size() ? number - share_.corners.first
                                             : corners() + (number - first_point_);
  }
  const auto place = std::ranges::lower_bound(elsewhere_, number) - elsewhere_.begin();
  return static_cast<std::uint32_t>(own_vertices_ + static_cast<std::uint64_t>(place));
}

void MeshPlacement::find_elsewhere(const std::function<bool(std::uint32_t)>& has_patch,
                                   std::uint64_t own_vertices) {
  own_vertices_ = own_vertices;
  if (is_whole()) return;
  const auto [first_ball, end_ball] = share_.balls;
  elsewhere_ = collect<std::uint64_t>(
      end_ball - first_ball, [&](std::size_t i, std::vector<std::uint64_t>& found) {
        const auto ball = static_cast<std::uint32_t>(first_ball + i);
        if (!has_patch(ball)) return;
        std::vector<std::uint32_t> numbers;
        boundary_vertices(boundary_, sampling_, index_, ball, numbers);
        for (const std::uint32_t number : numbers) {
          if (!is_own(number)) found.push_back(number);
        }
      });
  std::ranges::sort(elsewhere_);
  const auto repeats = std::ranges::unique(elsewhere_);
  elsewhere_.erase(repeats.begin(), repeats.end());
}

void MeshPlacement::place_corners(IndexedMesh& mesh) const {
  for_each_index(corners(), [&](std::size_t i) {
    const BoundaryCorner& corner = boundary_.corners[share_.corners.first + i];
    place(corner.position, corner.balls, i, mesh);
  });
}

void MeshPlacement::place_arcs(IndexedMesh& mesh) const {
  tbb::parallel_for(share_.arcs.first, share_.arcs.second, [&](std::uint32_t a) {
    const BoundaryArc& arc = boundary_.arcs[a];
    for (std::uint32_t k = arc.is_circle() ? 0 : 1; k < sampling_.pieces(a); ++k) {
      place(sampling_.point(a, k), {arc.balls[0], arc.balls[1], kNoIndex},
            local(sampling_.vertex(a, k)), mesh);
    }
  });
}

// `vertices` maps the point numbers of the patch to vertices of the mesh: first the points of the
// boundary, then the interior points.
void MeshPlacement::place_patch(const PatchMesh& patch, std::uint32_t ball,
                                std::uint64_t first_vertex, std::uint64_t first_triangle,
                                IndexedMesh& mesh) const {
  if (patch.triangles.empty()) return;
  const Sphere& s = t_.balls[ball];
  const SphereId id = t_.ids[ball];
  std::vector<std::uint32_t> vertices;
  vertices.reserve(patch.sources.size() + patch.interior.size());
  const bool has_all = is_whole();
  for (const PointSource& source : patch.sources) {
    const std::uint32_t number = source.vertex(sampling_.first_vertices().data());
    vertices.push_back(has_all ? number : local(number));
  }
  for (std::size_t i = 0; i < patch.interior.size(); ++i) {
    const std::uint64_t v = first_vertex + i;
    mesh.positions[v] = unscaled(s.center + s.radius * patch.interior[i]);
    mesh.normals[v] = cast<float>(patch.interior[i]);
    mesh.vertex_spheres.set(v, on_sphere(id));
    vertices.push_back(static_cast<std::uint32_t>(v));
  }
  for (std::size_t t = 0; t < patch.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      mesh.triangles[first_triangle + t][k] = vertices[patch.triangles[t][k]];
    }
    mesh.triangle_spheres[first_triangle + t] = id;
  }
}

// Writes vertex `vertex` of the mesh at p (scaled), which lies on the spheres of these balls.
VDWMESH_MULTIVERSION void MeshPlacement::place(const Vec3d& p,
                                               const std::array<std::uint32_t, 3>& balls,
                                               std::size_t vertex, IndexedMesh& mesh) const {
  const BoundaryVertex v = boundary_vertex(p, balls, {t_.balls.data(), t_.ids.data(), unit_});
  mesh.positions[vertex] = v.position;
  mesh.normals[vertex] = v.normal;
  mesh.vertex_spheres.set(vertex, v.label);
}

}  // namespace vdwmesh
