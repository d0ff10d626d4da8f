// The dual complex of a union of closed balls: the alpha complex of the weighted centres for alpha
// = 0 (Edelsbrunner 1995, "The union of balls and its dual shape"). A simplex of the regular
// triangulation is in it if its balls have a point in common on their common power face, that is,
// in the power cells of all of them. The complex is combinatorics only, and exact.
//
// The faces of the union's boundary follow from the complex. "Outside cells" are the tetrahedra of
// the triangulation that are not in the complex.
// - A ball of the complex with an outside cell around it has exposed patches.
// - An edge of the complex with an outside cell around it has exposed arcs, on the circle in which
//   its two spheres meet.
// - A triangle of the complex with an outside cell on one side has an exposed corner on that side.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "complex/power_triangulation.hpp"

namespace vdwmesh {

// The size of a simplex is the squared radius of the smallest sphere orthogonal to its balls. A
// simplex of negative size (strict) stays in the complex when all balls shrink a little. A simplex
// of size 0 (touching) is in the complex only because balls are closed.
enum class Contact : std::uint8_t { strict, touching };

struct DualEdge {
  std::array<std::uint32_t, 2> vertices;  // balls of the triangulation, ascending
  Contact contact;  // decided for singular edges only; all other edges say `strict` without a test
  bool exposed;     // a cell around the edge is outside the complex
  bool singular;    // in no triangle of the complex: a full circle, or a point of contact
  friend auto operator<=>(const DualEdge&, const DualEdge&) = default;
};

struct DualTriangle {
  std::array<std::uint32_t, 3> vertices;  // balls, ascending
  std::array<std::uint32_t, 3> edges;     // of the complex; edges[k] is opposite to vertices[k]
  // Cells of the triangulation, one on each side; from cells[0] the vertices are seen
  // counter-clockwise.
  std::array<std::uint32_t, 2> cells;
  std::array<bool, 2> exposed;  // cells[s] is outside the complex: an exposed corner
};

// Edges and triangles are sorted by their vertices. So the order of the balls alone gives that of
// all simplices, whatever the cells outside the complex are.
struct DualComplex {
  std::vector<std::uint8_t> in_complex;  // per ball of the triangulation
  std::vector<std::uint8_t> exposed;     // per ball: its sphere has exposed area
  std::vector<DualEdge> edges;
  std::vector<DualTriangle> triangles;
  std::vector<std::uint32_t> tetrahedra;  // cells of the triangulation, ascending

  // Per cell of the triangulation: whether it is in the complex, and for each of its vertices the
  // index in `triangles` of the triangle opposite to it (kNoIndex: not in the complex).
  std::vector<std::uint8_t> cell_in_complex;
  Buffer<std::array<std::uint32_t, 4>> cell_triangles;

  std::uint64_t point_contacts = 0;  // pairs of balls that touch in a point outside all other balls
};

// The index of the triangle's edge between its vertices a and b: opposite to the third vertex.
inline std::uint32_t edge_between(const DualTriangle& t, std::uint32_t a, std::uint32_t b) {
  for (std::size_t k = 0; k < 2; ++k) {
    if (t.vertices[k] != a && t.vertices[k] != b) return t.edges[k];
  }
  return t.edges[2];
}

// Throws LimitExceeded if there are 2^32 - 1 edges or 2^31 triangles, or more, and Cancelled (the
// monitor is asked once in some thousand cells).
DualComplex dual_complex(const PowerTriangulation& triangulation, Monitor* monitor = nullptr);

}  // namespace vdwmesh
