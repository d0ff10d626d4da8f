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

#include <cmath>

#include "core/blocks.hpp"
#include "surface/divided_patches.hpp"
#include "surface/patch_star.hpp"

namespace vdwmesh {
namespace {

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
