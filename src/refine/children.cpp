// make_children(): copies what stays and writes four triangles for each one, on all cores. Each
// turn of a loop writes array entries of its own, so the result does not depend on the threads.
#include "refine/children.hpp"

#include <algorithm>

#include "core/blocks.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

// Writes the corners, labels and opposite half-edges of all children. See the top of
// subdivision_formulas.hpp for their order.
void write_children(const Midpoints& level, Connectivity connectivity, IndexedMesh& mesh) {
  const IndexedMesh& parent = level.parent;
  mesh.triangles.resize(4 * parent.triangle_count());
  mesh.triangle_spheres.resize(4 * parent.triangle_spheres.size());
  // Four children with three half-edges each. A level with more than kMaxHalfEdges has no
  // `opposite`. It can only be the last one: check_limits() in preparation.cpp refuses further
  // subdivisions of such a mesh.
  if (connectivity == Connectivity::half_edges && 12 * parent.triangle_count() <= kMaxHalfEdges) {
    mesh.opposite.resize(12 * parent.triangle_count());
  }
  for_all(parent.triangle_count(), [&](std::size_t t) {
    const auto v = level.vertices(t);
    for (int child = 0; child < 4; ++child) {
      for (int k = 0; k < 3; ++k) {
        mesh.triangles[4 * t + static_cast<std::size_t>(child)][static_cast<std::size_t>(k)] =
            v[static_cast<std::size_t>(child_corner(child, k))];
      }
    }
    if (!mesh.triangle_spheres.empty()) {
      std::fill_n(&mesh.triangle_spheres[4 * t], 4, parent.triangle_spheres[t]);
    }
    if (mesh.opposite.empty()) return;
    for (std::size_t h = 3 * t; h < 3 * t + 3; ++h) {
      write_child_opposites(static_cast<std::uint32_t>(h), parent.opposite[h],
                            &mesh.opposite[12 * t]);
    }
  });
}

// Resizes `to` and copies `from` to its front. An array that is absent (empty) stays absent.
template <class T>
void copy_front(const Buffer<T>& from, std::size_t size, Buffer<T>& to) {
  if (from.empty()) return;
  to.resize(size);
  for_all(from.size(), [&](std::size_t i) { to[i] = from[i]; });
}

}  // namespace

void make_children(const Midpoints& level, Connectivity connectivity, IndexedMesh& mesh) {
  const IndexedMesh& parent = level.parent;
  // A closed mesh has one edge per two half-edges.
  const std::size_t vertices = parent.vertex_count() + parent.opposite.size() / 2;
  copy_front(parent.positions, vertices, mesh.positions);
  copy_front(parent.vertex_spheres.atoms, vertices, mesh.vertex_spheres.atoms);
  copy_front(parent.vertex_spheres.others, vertices, mesh.vertex_spheres.others);
  copy_front(parent.normals, vertices, mesh.normals);
  write_children(level, connectivity, mesh);
}

}  // namespace vdwmesh
