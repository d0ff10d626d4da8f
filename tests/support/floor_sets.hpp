// Sets of balls whose crease-exact meshes have angles below their floors unless the mesher does
// something for them (creases/patch/angle_floors.hpp).
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::testing {

// Four spheres through one point but for one of them, whose radius is larger by the difference: two
// of them meet in an arc about as long.
inline SphereSet short_arc(double difference) {
  const Vec3d corner{0.3, 0.2, 0.1};
  std::vector<Sphere> balls;
  for (const Vec3d& c :
       {Vec3d{1, 0.2, -1}, Vec3d{-0.9, 0.8, -1.1}, Vec3d{-0.7, -1, -0.9}, Vec3d{0.6, -0.8, -1.2}}) {
    balls.push_back({c, norm(c - corner)});
  }
  balls[0].radius += difference;
  return SphereSet(std::move(balls));
}

// A unit ball between two others, whose circles on it lie at the distances h and k from its centre
// and cross in two points, with a strip between them that ends in two corners of this angle; and a
// fourth ball that takes one of the two away, so that the pieces at the other differ in length. For
// the directions n and m of the two others, the cosine of the angle is
// (h k - n·m) / (√(1 - h²) √(1 - k²)).
inline SphereSet strip(double degrees, double h, double k) {
  const double cosine = std::cos(degrees * std::numbers::pi / 180);
  const double dots = h * k - cosine * std::sqrt((1 - h * h) * (1 - k * k));
  const Vec3d n{1, 0, 0}, m{dots, std::sqrt(1 - dots * dots), 0};
  return SphereSet({{{0, 0, 0}, 1}, {2 * h * n, 1}, {2 * k * m, 1}, {{0.1, 0.35, -1.15}, 0.8}});
}

// Balls whose spheres all but share a circle, and one that cuts them there: splits for the floors
// would not come to an end, so the mesher gives them up.
inline SphereSet near_pencil() {
  std::vector<Sphere> balls{
      {{1.712963801033452, -0.0001075490012266559, 3.9792331649028919e-05}, 1.2332815593305173},
      {{1.4586702314585918, -0.00013637510369390242, 2.0929798046333744e-05}, 1.0754531742001814},
      {{-1.5064185260992617, 1.8210918241811882e-05, -0.00020408943538244287}, 1.1038249653889807},
      {{0.64532273866465806, -8.291980603418556e-05, -5.6685318412767985e-05}, 0.70154866015749695},
      {{-0.094010268838367939, 2.3694579400701921, 0.3}, 0.6}};
  for (Sphere& ball : balls) ball.radius += 1.4;
  return SphereSet(std::move(balls));
}

}  // namespace vdwmesh::testing
