// A level as its passes see it: patches of vertices, the triangles among them, where the vertices
// were and which of them the level handles.
//   Given: a patch is one triangle of three vertices, all of them handled.
//   Midpoints: a patch is a parent triangle, three old vertices and three midpoints, with its four
//   children; the midpoints are handled.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "refine/subdivision_formulas.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// What became of a vertex on the level that handles it: taking_back while a pass marks, taken_back
// until the next pass has looked at its neighbours.
enum class Fate : std::uint8_t { stayed, moved, taking_back, taken_back };

struct Given {
  static constexpr int kVertices = 3, kTriangles = 1;
  const Buffer<Vec3d>& given;  // positions before projection
  const IndexedMesh& mesh;

  std::size_t patches() const { return mesh.triangle_count(); }
  static constexpr std::array<int, 3> triangle(int) { return {0, 1, 2}; }
  std::array<std::uint32_t, 3> vertices(std::size_t t) const { return mesh.triangles[t]; }
  Vec3d before(const std::array<std::uint32_t, 3>& v, std::size_t i) const { return given[v[i]]; }
  // First of the handled vertices, which are the last of the mesh; and the loop over them.
  std::size_t first_handled() const { return 0; }
  std::size_t items() const { return mesh.vertex_count(); }
  std::optional<std::size_t> handled_by_item(std::size_t item) const { return item; }
};

struct Midpoints {
  static constexpr int kVertices = 6, kTriangles = 4;
  const IndexedMesh& parent;
  const Buffer<std::uint32_t>& edge;
  const IndexedMesh& mesh;

  std::size_t patches() const { return parent.triangle_count(); }
  static constexpr std::array<int, 3> triangle(int child) {
    return {child_corner(child, 0), child_corner(child, 1), child_corner(child, 2)};
  }
  std::uint32_t midpoint_of(std::size_t h) const {
    return static_cast<std::uint32_t>(parent.vertex_count() + edge[h]);
  }
  std::array<std::uint32_t, 6> vertices(std::size_t t) const {
    const Triangle& v = parent.triangles[t];
    return {v[0], v[1], v[2], midpoint_of(3 * t), midpoint_of(3 * t + 1), midpoint_of(3 * t + 2)};
  }
  Vec3d before(const std::array<std::uint32_t, 6>& v, std::size_t i) const {
    if (i < 3) return parent.positions[v[i]];
    return midpoint(parent.positions[v[i - 3]], parent.positions[v[i == 5 ? 0 : i - 2]]);
  }
  std::size_t first_handled() const { return parent.vertex_count(); }
  // An edge is the item of its first half-edge.
  std::size_t items() const { return parent.opposite.size(); }
  std::optional<std::size_t> handled_by_item(std::size_t h) const {
    if (parent.opposite[h] < h) return std::nullopt;
    return edge[h];
  }

  std::uint32_t start_of(std::size_t h) const { return parent.triangles[h / 3][h % 3]; }
  std::uint32_t end_of(std::size_t h) const { return parent.triangles[h / 3][(h + 1) % 3]; }
  Vec3d start(std::size_t h) const {
    return midpoint(parent.positions[start_of(h)], parent.positions[end_of(h)]);
  }
  // The atom of a midpoint that is not on the surface.
  VertexSpheres unprojected_label(const Sphere* spheres, std::size_t h) const {
    return on_sphere(nearer_sphere(spheres, parent.vertex_spheres.atoms[start_of(h)],
                                   parent.vertex_spheres.atoms[end_of(h)], start(h)));
  }
};

// Of any vertex; others may be marking it at this moment.
template <class Level>
Fate fate_of(const Level& level, Buffer<Fate>& fates, std::uint32_t v) {
  if (v < level.first_handled()) return Fate::stayed;
  return std::atomic_ref(fates[v - level.first_handled()]).load(std::memory_order_relaxed);
}

// A moved vertex is to go back.
template <class Level>
void mark(const Level& level, Buffer<Fate>& fates, std::uint32_t v) {
  if (fate_of(level, fates, v) != Fate::moved) return;
  std::atomic_ref(fates[v - level.first_handled()])
      .store(Fate::taking_back, std::memory_order_relaxed);
}

// Whether a triangle's vertex moved and is not back: whether there is anything to take back.
inline bool is_away(Fate fate) { return fate == Fate::moved || fate == Fate::taking_back; }

}  // namespace vdwmesh
