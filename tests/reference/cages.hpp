// Points on the corners of convex polyhedra, with their faces: sets of atoms of which a probe can
// touch four, five or six at once.
#pragma once

#include <cstddef>
#include <vector>

#include "reference/point.hpp"

namespace vdwmesh::reference {

// Each face lists its corners counter-clockwise as seen from outside. Corners of one plane have two
// faces, one for each side.
struct Cage {
  std::vector<Point> centers;
  std::vector<std::vector<std::size_t>> faces;
};

// The convex hull of points that all are corners of it, in one plane or not. Points within 1e-9 of
// the plane of a face belong to the face.
Cage hull_cage(const std::vector<Point>& corners);

// All with edges of the length given, Å.
std::vector<Point> tetrahedron(double edge);
std::vector<Point> octahedron(double edge);
std::vector<Point> cube(double edge);
std::vector<Point> icosahedron(double edge);
std::vector<Point> dodecahedron(double edge);
std::vector<Point> regular_polygon(int corners, double edge);

// Carbon atoms of buckminsterfullerene: an icosahedron with its corners cut off. The bonds around
// pentagons and those between two hexagons may differ, Å.
std::vector<Point> fullerene(double pentagon_bond, double hexagon_bond);

}  // namespace vdwmesh::reference
