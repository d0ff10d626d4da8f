// patch_fans(): every patch is judged by itself, as a piece of the fans of its three corners.
#include "refine/patch_fans.hpp"

#include "core/blocks.hpp"
#include "surface/patch_star.hpp"

namespace vdwmesh {

StarFans patch_fans(const Midpoints& level) {
  const Buffer<Vec3d>& p = level.mesh.positions;
  const Buffer<Vec3f> direction =
      fan_directions(p, level.parent.vertex_count(), level.parent.triangles);
  StarFans fans(level.parent.vertex_count());
  for_all(level.patches(), [&](std::size_t t) {
    const auto v = level.vertices(t);
    add_patch(fans, level.parent.triangles[t], at_corners(p[v[0]], p[v[1]], p[v[2]]),
              at_corners(p[v[3]], p[v[4]], p[v[5]]),
              at_corners(direction[v[0]], direction[v[1]], direction[v[2]]));
  });
  return fans;
}

StarFans patch_fans(const DividedMidpoints& level) {
  const Buffer<Vec3d>& p = level.mesh.positions;
  Buffer<Triangle> corners(level.patches());
  for_all(level.patches(), [&](std::size_t t) { corners[t] = level.corners(t); });
  // Corners are vertices of the parent. Those of them that are no corner have no star.
  const std::size_t vertices = level.parent.vertex_count();
  const Buffer<Vec3f> direction = fan_directions(p, vertices, corners);
  StarFans fans(vertices);
  for_all(level.patches(), [&](std::size_t t) {
    const auto v = level.vertices(t);
    const auto kind = [&](std::size_t i) { return at_corners(p[v[i]], p[v[i + 1]], p[v[i + 2]]); };
    add_twice_divided_patch(fans, corners[t], {kind(0), kind(3), kind(6), kind(9), kind(12)},
                            at_corners(direction[v[0]], direction[v[1]], direction[v[2]]));
  });
  return fans;
}

}  // namespace vdwmesh
