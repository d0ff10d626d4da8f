// A triangle by its corners: its area, its centre, its box, and its points by one number. For host
// and device.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {

// References to the coordinates of a triangle's vertices, Å. The mesh must outlive them.
struct Corners {
  const Vec3d &a, &b, &c;
};

// The area of a triangle, Å².
VDWMESH_HD inline double area_of(const Corners& t) {
  return 0.5 * norm(cross(t.b - t.a, t.c - t.a));
}

// The centre is computed from differences of the corners, whose rounding errors are relative to the
// size of the triangle. In (a + b + c) / 3 they would be relative to its distance from the
// coordinate origin.
VDWMESH_HD inline Vec3d center_of(const Corners& t) {
  return t.a + (1.0 / 3) * ((t.b - t.a) + (t.c - t.a));
}

VDWMESH_HD inline Box box_of(const Corners& t) {
  Box box{t.a, t.a};
  include(box, t.b);
  include(box, t.c);
  return box;
}

// Returns the bits 0, 2, 4, … 46 of x as bits 0, 1, 2, … 23. Each line joins pairs of groups of
// bits: each upper group moves down to the lower one, and the mask removes what is left behind.
VDWMESH_HD constexpr std::int32_t every_second_bit(std::uint64_t x) {
  x &= 0x555555555555u;
  x = (x | x >> 1) & 0x333333333333u;
  x = (x | x >> 2) & 0x0f0f0f0f0f0fu;
  x = (x | x >> 4) & 0x00ff00ff00ffu;
  x = (x | x >> 8) & 0xffff0000ffffu;
  x = (x | x >> 16) & 0x0000ffffffffu;
  return static_cast<std::int32_t>(x);
}

// Maps [0, 1] onto the triangle so that equal lengths become equal areas and a short interval
// becomes a small neighbourhood. This is the map of the triangular van der Corput sequence (K. Basu
// and A. B. Owen, "Low discrepancy constructions in the triangle", SIAM J. Numer. Anal. 53 (2015)
// 743). Each digit of `fraction` to the base 4 selects one of the four triangles into which the
// midpoints of the edges divide the current one. The result is the centre of the last triangle, of
// 24: points are resolved to 2^-24 of an edge, the resolution of a float.
//
// The current triangle is the whole triangle, scaled by ±2^-i after i digits about its centre and
// moved by the sum of weight[k] · (corner k - centre). Child 0, in the middle, has the same centre
// and is rotated by half a turn, which changes the sign of the scale. The centre of child k + 1 is
// half the way from the centre to corner k of the current triangle, so the digit adds ±2^-i to
// weight[k]. All digits are treated together: `low` and `high` have bit 24 - i of their two bits,
// and `flipped` has the parity of the digits 0 up to digit i, which a prefix sum of bits gives.
VDWMESH_HD inline Vec3d point_of_triangle(const Corners& triangle, double fraction) {
  constexpr std::uint64_t kMost = (std::uint64_t{1} << 48) - 1;
  auto digits = static_cast<std::uint64_t>(fraction * 0x1p48);
  digits = digits < kMost ? digits : kMost;  // 1, which rounding can cause, has all digits 3
  const std::int32_t low = every_second_bit(digits), high = every_second_bit(digits >> 1);
  std::int32_t flipped = ~(low | high) & 0xffffff;
  flipped ^= flipped >> 1;
  flipped ^= flipped >> 2;
  flipped ^= flipped >> 4;
  flipped ^= flipped >> 8;
  flipped ^= flipped >> 16;
  const auto weight = [&](std::int32_t digit) {
    return static_cast<double>((digit & ~flipped) - (digit & flipped)) * 0x1p-24;
  };
  const double second = weight(high & ~low), third = weight(high & low);
  // The centre of the last triangle, in barycentric coordinates of the whole one.
  const double rest = (1 - weight(low & ~high) - second - third) / 3;
  const Vec3d& a = triangle.a;
  return a + (second + rest) * (triangle.b - a) + (third + rest) * (triangle.c - a);
}

}  // namespace vdwmesh
