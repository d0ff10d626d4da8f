// Areas and volumes known in closed form.
#pragma once

#include <array>

#include "reference/point.hpp"

namespace vdwmesh::reference {

struct Measures {
  double area;    // Å²
  double volume;  // Å³
};

Measures ball(double radius);

// Cap of height h cut off a ball: curved area alone, volume under the plane. 0 <= h <= 2 r.
Measures cap(double radius, double height);

// Union of two balls at centre distance d: nested, overlapping, tangent or apart.
Measures two_balls(double r1, double r2, double distance);

// Ring of n equal balls whose centres lie on a circle; each meets its two neighbours and no other.
Measures ring_of_balls(int n, double ring_radius, double ball_radius);

// Union of three balls whose spheres have two points in common, which are on its boundary, so that
// each pair's circle leaves one arc there. Areas by Gauss-Bonnet, the volume by the divergence
// theorem.
Measures three_balls(const std::array<Ball, 3>& balls);

// Volume that two balls have in common.
double lens_volume(double r1, double r2, double distance);

}  // namespace vdwmesh::reference
