// Directions of fans, and the fans of a divided mesh.
//
// A mesh counts as divided if every four consecutive triangles have the vertices of a patch with
// three different corners, all corners of patches come before all midpoints, and there are three
// midpoints for two patches. Then each midpoint belongs to two patches, and halves the same edge in
// both: of a closed mesh, each half of an edge is a half of an edge of another patch, where it runs
// backwards, for only there a corner and a midpoint are joined. (In a patch with two equal corners
// the two halves of the edge between them could run back along each other.) So there are at least
// two for each midpoint, and on average exactly two. Both halves of the edge are then in the same
// other patch, which has the midpoint only once, unless two of its midpoints are the same, and it
// has no area.
#include "surface/star_fans.hpp"

#include <algorithm>
#include <cmath>

#include "core/blocks.hpp"
#include "surface/patch_star.hpp"

namespace vdwmesh {
namespace {

// Patches are divided triangles, as refine/subdivision_formulas.hpp makes them. Triangles 4 t to
// 4 t + 3 of a mesh are patch t if they are the three children at its corners, each with the
// midpoints of the two sides that meet there, and the child of the midpoints.
//
// The vertices of patch t, as far as the mesh is divided: its corners, and its midpoints, of which
// number k is that of the side from corner k to the next one.
Triangle corners_of_patch(const IndexedMesh& mesh, std::size_t t) {
  return {mesh.triangles[4 * t][0], mesh.triangles[4 * t + 1][0], mesh.triangles[4 * t + 2][0]};
}
const Triangle& midpoints_of_patch(const IndexedMesh& mesh, std::size_t t) {
  return mesh.triangles[4 * t + 3];
}

// Whether triangles 4 t to 4 t + 3 are a patch with three different corners.
bool is_patch(const IndexedMesh& mesh, std::size_t t) {
  const Triangle& m = midpoints_of_patch(mesh, t);
  const Triangle corners = corners_of_patch(mesh, t);
  bool is = corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Triangle& child = mesh.triangles[4 * t + k];
    is &= child[1] == m[k] && child[2] == m[k == 0 ? 2 : k - 1];
  }
  return is;
}

// What the patches of a mesh have for vertices.
struct PatchVertices {
  bool all_are_patches = true;
  std::uint32_t last_corner = 0, first_midpoint = 0xffffffffu;

  // Whether all are patches, and all of their corners come before all of their midpoints.
  bool are_in_order() const { return all_are_patches && last_corner < first_midpoint; }
};

// Looks at every four consecutive triangles of the mesh, on all cores.
PatchVertices survey_patches(const IndexedMesh& mesh) {
  return reduce_all(
      mesh.triangle_count() / 4, PatchVertices{},
      [&](std::size_t t, PatchVertices& all) {
        const Triangle corner = corners_of_patch(mesh, t);
        const Triangle& middle = midpoints_of_patch(mesh, t);
        all.all_are_patches &= is_patch(mesh, t);
        all.last_corner = std::max({all.last_corner, corner[0], corner[1], corner[2]});
        all.first_midpoint = std::min({all.first_midpoint, middle[0], middle[1], middle[2]});
      },
      [](const PatchVertices& a, const PatchVertices& b) {
        return PatchVertices{a.all_are_patches && b.all_are_patches,
                             std::max(a.last_corner, b.last_corner),
                             std::min(a.first_midpoint, b.first_midpoint)};
      });
}

// Up to three triangles around a vertex: one of which it is the first vertex, one of which it is
// the second, and one of which it is the third. Of several the last one that was written.
using SomeTriangles = std::array<std::uint32_t, 3>;
constexpr std::uint32_t kNoTriangle = 0xffffffffu;

// For the first `vertices` vertices of `count` triangles; triangle_at(t) has the vertices of one.
template <class TriangleAt>
Buffer<SomeTriangles> triangles_around(std::size_t vertices, std::size_t count,
                                       const TriangleAt& triangle_at) {
  Buffer<SomeTriangles> around(vertices);
  for_all(vertices, [&](std::size_t v) { around[v] = {kNoTriangle, kNoTriangle, kNoTriangle}; });
  for_all(count, [&](std::size_t t) {
    const Triangle triangle = triangle_at(t);
    for (std::size_t k = 0; k < 3; ++k) {
      std::atomic_ref(around[triangle[k]][k])
          .store(static_cast<std::uint32_t>(t), std::memory_order_relaxed);
    }
  });
  return around;
}

template <class TriangleAt>
Buffer<Vec3f> directions_of(const Buffer<Vec3d>& positions, std::size_t vertices, std::size_t count,
                            const TriangleAt& triangle_at) {
  const Buffer<SomeTriangles> around = triangles_around(vertices, count, triangle_at);
  Buffer<Vec3f> directions(vertices);
  for_all(vertices, [&](std::size_t v) {
    Vec3d sum{0, 0, 0};
    for (const std::uint32_t t : around[v]) {
      if (t == kNoTriangle) continue;
      const Triangle triangle = triangle_at(t);
      const Vec3d &a = positions[triangle[0]], &b = positions[triangle[1]],
                  &c = positions[triangle[2]];
      sum = sum + cross(b - a, c - a);
    }
    directions[v] = cast<float>((1 / norm(sum)) * sum);
  });
  return directions;
}

// The number of different midpoints of patches, all of which are at least `first`.
std::uint64_t count_midpoints(const IndexedMesh& mesh, std::size_t first) {
  Buffer<std::uint8_t> used(mesh.vertex_count() - first, 0);
  for_all(mesh.triangle_count() / 4, [&](std::size_t t) {
    for (const std::uint32_t m : midpoints_of_patch(mesh, t)) {
      std::atomic_ref(used[m - first]).store(1, std::memory_order_relaxed);
    }
  });
  return sum_all(used.size(), [&](std::size_t i, std::uint64_t& n) { n += used[i]; });
}

// The number of vertices of the mesh that was divided; 0 if none was.
std::size_t vertices_before(const IndexedMesh& mesh) {
  if (mesh.triangle_count() == 0 || mesh.triangle_count() % 8 != 0) return 0;
  const PatchVertices found = survey_patches(mesh);
  if (!found.are_in_order()) return 0;
  const std::uint64_t patches = mesh.triangle_count() / 4;
  return 2 * count_midpoints(mesh, found.first_midpoint) == 3 * patches ? found.first_midpoint : 0;
}

}  // namespace

Buffer<Vec3f> fan_directions(const Buffer<Vec3d>& positions, std::size_t vertices,
                             const Buffer<Triangle>& triangles) {
  return directions_of(positions, vertices, triangles.size(),
                       [&](std::size_t t) { return triangles[t]; });
}

StarFans fans_of_divided(const IndexedMesh& mesh) {
  const std::size_t vertices = vertices_before(mesh), patches = mesh.triangle_count() / 4;
  if (vertices == 0) return {};
  const Buffer<Vec3d>& p = mesh.positions;
  const Buffer<Vec3f> direction =
      directions_of(p, vertices, patches, [&](std::size_t t) { return corners_of_patch(mesh, t); });
  StarFans fans(vertices);
  for_all(patches, [&](std::size_t t) {
    const Triangle v = corners_of_patch(mesh, t), &m = midpoints_of_patch(mesh, t);
    const LanePoint corner = at_corners(p[v[0]], p[v[1]], p[v[2]]),
                    middle = at_corners(p[m[0]], p[m[1]], p[m[2]]);
    fans.add(v, judge_patch(corner, middle,
                            at_corners(direction[v[0]], direction[v[1]], direction[v[2]])));
  });
  return fans;
}

}  // namespace vdwmesh
