// Probes and the circles on which they roll, in wide numbers: for decisions that double leaves
// open.
//
// The squared radius of every grown ball is larger by kGrowth here. That does not change the power
// diagram. Nor does it change the dual complex, because this is the complex of closed balls. So a
// tie between the given doubles is decided as in the complex: if grown balls have a single point in
// common, a probe fits on both sides of it, and a circle of just the probe's radius makes no
// spindle.
#pragma once

#include <array>

#include "complex/wide_points.hpp"
#include "excluded/patches/cap_arrangement.hpp"
#include "excluded/probes/accessible_surface.hpp"

namespace vdwmesh::excluded {

using WideVector = numbers::Vector<WideFloat>;

// By Newton's method from the root in double, with an error of some 2^-330 of it: the library's own
// takes 30 times as long.
template <>
WideFloat root_of(const WideFloat& x);

// Lengths are scaled: the largest grown ball has a radius from 1/2 to 1. Two probes in the plane of
// the atoms that they touch are moved apart by it: each is then at least the root of this from the
// plane.
inline constexpr double kGrowth = 1e-40;

// The circle in which two grown spheres meet. Positions are those of the triangulation.
struct WideCircle {
  WideVector center, axis;  // the axis from a to b, of length 1
  WideFloat squared_radius;
};
WideCircle wide_circle(const Sphere& a, const Sphere& b);

// The probe at a corner.
WideVector wide_corner(const AccessibleSurface& surface, CornerIndex corner);

// Whether the circle of two grown balls is smaller than the probe, and whether the points common to
// three of them are nearer than the probe's radius to the plane of the centres. `measured` is the
// radius or the distance in double, which decides unless it is next to the probe's radius.
bool is_circle_below(const Sphere& a, const Sphere& b, double probe_radius, double measured);
bool is_corner_below(const std::array<Sphere, 3>& balls, double probe_radius, double measured);

// How far from its circle's plane a spindle's cusps are: the root of p² - ρ². `measured` is ρ in
// double.
double cusp_height(const Sphere& a, const Sphere& b, double probe_radius, double measured);

}  // namespace vdwmesh::excluded
