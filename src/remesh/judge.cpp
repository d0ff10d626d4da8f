// Judge: the cheapest test first; the oracle and the exact predicates last.
#include "remesh/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vdwmesh::remesh {
namespace {

// Cosines of the largest angle between the normal of a triangle and those of the surface: at its
// vertices, and at the foot of its middle.
constexpr double kTurnAtVertex = 0.2, kTurnAtMiddle = 0.31;  // 78°, 72°

Vec3d double_area(const NewTriangle& t) {
  return cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
}
Vec3d middle_of(const NewTriangle& t) {
  return (1.0 / 3) * (t.corner[0] + t.corner[1] + t.corner[2]);
}

}  // namespace

double shape_of(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double ab = squared_norm(b - a), bc = squared_norm(c - b), ca = squared_norm(a - c);
  const double longer = ab * bc * ca / std::min({ab, bc, ca});
  return longer > 0 ? squared_norm(cross(b - a, c - a)) / longer : 0;
}

bool Judge::faces_outward(const NewTriangle& t) const {
  const Vec3d n = double_area(t);
  const double length = norm(n);
  return std::ranges::all_of(t.vertex, [&](std::uint32_t v) {
    return vertices_.hold[v] != VertexHold::none ||
           dot(n, vertices_.normal[v]) > kTurnAtVertex * length;
  });
}

bool Judge::is_near(const NewTriangle& t) const {
  const Vec3d n = double_area(t);
  const std::optional<Foot> foot = oracle_.nearest(middle_of(t), &n);
  return foot && std::abs(foot->height) <= farthest_ &&
         dot(n, foot->normal) > kTurnAtMiddle * norm(n);
}

double Judge::height(const NewTriangle& t) const {
  const Vec3d n = double_area(t);
  const std::optional<Foot> foot = oracle_.nearest(middle_of(t), &n);
  return foot ? std::abs(foot->height) : std::numeric_limits<double>::infinity();
}

bool Judge::allows(const MeshChange& change, double least_shape) const {
  const auto is_well_shaped = [&](const NewTriangle& t) { return shape_of(t) >= least_shape; };
  return std::ranges::all_of(change.made, is_well_shaped) &&
         std::ranges::all_of(change.made, [&](const NewTriangle& t) { return faces_outward(t); }) &&
         std::ranges::all_of(change.made, [&](const NewTriangle& t) { return is_near(t); }) &&
         guard_.allows(change.made, change.removed);
}

}  // namespace vdwmesh::remesh
