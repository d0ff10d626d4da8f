// The solvent-excluded surface of a few atoms, rings and cages by quadrature: values for tests that
// share no formula with the surface's patches.
//
// The solid of the grown balls is cut into pieces: cones of an atom over the exposed part of its
// grown sphere, triangles of two atoms and a probe that are turned along an arc, pyramids of a
// probe over the three or more atoms that it touches, and what lies between the atoms. In each
// piece the nearest accessible places are a part of the sphere, the arc, or the probe's centre
// alone. So it is known there what is nearer than the probe's radius and therefore not in the
// excluded solid. The pieces end at the axis of two atoms and at the plane of a probe's atoms, so
// the forms hold for spindles, and for low probes that meet their mirror image there; but not if
// other probes meet.
#pragma once

#include <array>
#include <vector>

#include "reference/cages.hpp"
#include "reference/point.hpp"

namespace vdwmesh::reference {

// Sums over pieces.
struct ExcludedForm {
  double contact = 0, saddle = 0, concave = 0;  // Å²: parts of the excluded surface
  double volume = 0;                            // Å³ of the excluded solid
  double area() const { return contact + saddle + concave; }
};

// The cone of a grown ball over a part of its sphere, in steradian.
void add_cone(double solid_angle, double atom_radius, ExcludedForm& sum);

// The triangle of two atoms and a probe that touches them, turned about their axis by `turn` rad.
void add_turned_triangle(double turn, const Ball& a, const Ball& b, double probe,
                         ExcludedForm& sum);

// Whether the probe's mirror image across the plane of its atoms is a probe too.
enum class MirrorProbe { no, yes };

// The pyramid of a probe over atoms whose centres are the corners of a plane polygon, in order.
void add_pyramid(const Point& probe_center, const std::vector<Point>& polygon, double probe,
                 MirrorProbe mirror, ExcludedForm& sum);

// Two atoms, neither in the other's grown ball. If their grown balls meet, the probe rolls around
// them.
ExcludedForm excluded_two_balls(const Ball& a, const Ball& b, double probe);

// What of it belongs to the first atom: the side of the plane in which the grown spheres meet.
// Precondition: they do, and the plane lies between the centres.
ExcludedForm share_of_first(const Ball& a, const Ball& b, double probe);

// Three atoms that a probe touches on both sides of their plane.
ExcludedForm excluded_three_balls(const std::array<Ball, 3>& atoms, double probe);

// Equal atoms on the corners of a cage. A probe touches all atoms of a face together from outside,
// and rolls along the edges. With `both` another one does so inside; without it the measures are
// those of the solid with its cavity filled up.
enum class CageSides { outer, both };
ExcludedForm excluded_cage(const Cage& cage, double atom_radius, double probe, CageSides sides);

}  // namespace vdwmesh::reference
