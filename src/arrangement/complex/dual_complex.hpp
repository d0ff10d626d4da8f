// The dual complex of a union of closed balls: the simplices of the regular triangulation whose
// balls meet on their common power face (the alpha complex at 0; Edelsbrunner 1995, "The union of
// balls and its dual shape"). Combinatorics only, all of it exact.
//
// Every face of the union's boundary has its simplex: a vertex with a cell outside the complex has
// exposed patches; an edge with one, exposed arcs on the circle of its two spheres; a triangle side
// without a tetrahedron is an exposed corner.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "arrangement/complex/power_triangulation.hpp"

namespace vdwmesh {

// size: sign of the smallest orthogonal sphere. Strict simplices persist when all balls shrink a
// little; touching ones are there only because balls are closed.
enum class Contact : std::uint8_t { strict, touching };

struct DualEdge {
  std::array<std::uint32_t, 2> vertices;  // balls
  Contact contact;
  bool exposed;   // outside the complex somewhere around it
  bool singular;  // without triangles: a full circle, or a single point of contact
};

struct DualTriangle {
  std::array<std::uint32_t, 3> vertices;  // counter-clockwise seen from cells[0]
  std::array<std::uint32_t, 3> edges;     // opposite to each vertex
  std::array<std::uint32_t, 2> cells;     // of the triangulation, on both sides
  std::array<bool, 2> exposed;            // that side has no tetrahedron: a corner is exposed
};

struct DualComplex {
  std::vector<std::uint8_t> in_complex;  // per ball
  std::vector<std::uint8_t> exposed;     // per ball: its sphere has exposed area
  std::vector<DualEdge> edges;
  std::vector<DualTriangle> triangles;
  std::vector<std::uint32_t> tetrahedra;  // cells of the triangulation

  // Per cell of the triangulation: whether it is in the complex; the complex's triangle opposite
  // to each vertex (kNoIndex: not in the complex).
  std::vector<std::uint8_t> cell_in_complex;
  Buffer<std::array<std::uint32_t, 4>> cell_triangles;

  std::uint64_t point_contacts = 0;  // pairs that touch from outside, outside all other balls
};

// Edge of the triangle between two of its vertices.
inline std::uint32_t edge_between(const DualTriangle& t, std::uint32_t a, std::uint32_t b) {
  for (std::size_t k = 0; k < 2; ++k) {
    if (t.vertices[k] != a && t.vertices[k] != b) return t.edges[k];
  }
  return t.edges[2];
}

DualComplex dual_complex(const PowerTriangulation& triangulation);

}  // namespace vdwmesh
