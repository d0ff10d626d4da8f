// Places in a triangulation of the plane, and what became of insertions into it. For host and
// device; PlaneTriangulation has them as members.
#pragma once

#include <cstdint>

#include "arrangement/mesher/linked_triangle.hpp"
#include "arrangement/mesher/patch_vector.hpp"
#include "arrangement/mesher/plane_predicates.hpp"

namespace vdwmesh {

struct PlaneTypes {
  // An edge of a triangle by the number of the opposite corner.
  struct Edge {
    std::uint32_t triangle, corner;
  };
  enum class Place : std::uint8_t { inside, on_edge, on_vertex, outside };
  // Where a point lies. `corner` is that of the vertex, or opposite to the edge, that it lies on.
  struct Location {
    std::uint32_t triangle, corner;
    Place place;
  };
  // What became of a piece that should be an edge. It is crossed by another piece, or joins the
  // same points as another one, or a third point lies on it; only `inserted` makes it one. After a
  // failure of bounded memory it is `blocked`, too.
  enum class Outcome : std::uint8_t { inserted, doubled, crossing, blocked };
  // The points and triangles, without marks. With resume() one can go on from there later.
  struct State {
    double largest = 0;
    PatchVector<PlanePoint> points;
    PatchVector<LinkedTriangle> triangles;
    PatchVector<std::uint32_t> star;
  };
  // An edge between two vertices, and the triangle that had it on its left when it was listed.
  // Flips may have changed that triangle since.
  struct ListedEdge {
    std::uint32_t from, to, triangle;
  };
};

}  // namespace vdwmesh
