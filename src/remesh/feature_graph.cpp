// FeatureGraph looks at the edges whose two triangles are of the concave patches of two probes:
// nowhere else has the surface a crease.
#include "remesh/feature_graph.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace vdwmesh::remesh {
namespace {

// The normals of two probes' spheres turn by 2 asin(|c - c'| / 2 p) where these meet. Less than
// this is no crease: triangles of any density turn by more.
constexpr double kLeastTurn = 15 * std::numbers::pi / 180;

bool is_crease(const SurfacePatch& a, const SurfacePatch& b) {
  return a.kind == PatchKind::concave && b.kind == PatchKind::concave &&
         norm(a.center - b.center) >= 2 * a.radius * std::sin(kLeastTurn / 2);
}

CreaseCircle circle_of(const PatchedMesh& surface, std::uint32_t i, std::uint32_t j) {
  const SurfacePatch &a = surface.patches[i], &b = surface.patches[j];
  const Vec3d between = b.center - a.center;
  const double length = norm(between);
  const double squared = (a.radius - length / 2) * (a.radius + length / 2);
  return {{i, j},
          a.center + 0.5 * between,
          (1 / length) * between,
          std::sqrt(squared > 0 ? squared : 0)};
}

bool is_cusp(const SurfacePatch& patch, const Vec3d& p) {
  return patch.kind == PatchKind::saddle && !(footing(patch, p).girth > 0);
}

}  // namespace

Vec3d CreaseCircle::nearest(const Vec3d& p) const {
  const Vec3d from = p - center;
  const Vec3d radial = from - dot(from, axis) * axis;
  const double length = norm(radial);
  return length > 0 ? center + (radius / length) * radial : p;
}

VertexHold hold_by_marks(const DynamicMesh& mesh, std::uint32_t vertex) {
  std::uint32_t first = kNone;
  int count = 0;
  bool same = true;
  mesh.visit_spokes(vertex, [&](HalfEdge h) {
    const std::uint32_t mark = mesh.mark(h);
    if (mark == kNone) return;
    if (count++ == 0) first = mark;
    same = same && mark == first;
  });
  if (count == 0) return VertexHold::none;
  return count == 2 && same ? VertexHold::crease : VertexHold::corner;
}

FeatureGraph::FeatureGraph(const PatchedMesh& surface, DynamicMesh& mesh)
    : hold(mesh.vertex_count(), VertexHold::none) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  for (HalfEdge h = 0; h < 3 * mesh.triangle_count(); ++h) {
    const std::uint32_t i = surface.triangle_patch[h / 3];
    const std::uint32_t j = surface.triangle_patch[mesh.opposite(h) / 3];
    if (i >= j || !is_crease(surface.patches[i], surface.patches[j])) continue;
    const auto next = static_cast<std::uint32_t>(circles.size());
    const auto [place, added] = numbers.try_emplace({i, j}, next);
    if (added) circles.push_back(circle_of(surface, i, j));
    mesh.set_mark(h, place->second);
    ++crease_edges;
  }
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.is_vertex(v)) hold[v] = hold_by_marks(mesh, v);
  }
  for (HalfEdge h = 0; h < 3 * mesh.triangle_count(); ++h) {
    const std::uint32_t v = mesh.from(h);
    if (is_cusp(surface.patches[surface.triangle_patch[h / 3]], surface.mesh.positions[v])) {
      hold[v] = VertexHold::corner;
    }
  }
  for (const VertexHold kept : hold) corners += kept == VertexHold::corner;
}

}  // namespace vdwmesh::remesh
