// Triangles as plain arrays of indices that know their neighbours, the flip of an edge, and places
// in a triangulation of the plane. For host and device. Both the triangulation in the plane and the
// smoothing on the sphere use the triangles.
#pragma once

#include <array>
#include <cstdint>

#include "core/host_device.hpp"
#include "creases/arcs/patch_vector.hpp"
#include "creases/plane/plane_predicates.hpp"

namespace vdwmesh {

// In place of a neighbour: no triangle lies beyond the edge.
inline constexpr std::uint32_t kNoNeighbor = 0xffffffffu;
// In place of a piece: the edge is no piece of the boundary.
inline constexpr std::uint32_t kNoPiece = 0xffffffffu;

// The corner of a triangle that follows or precedes corner k counter-clockwise.
VDWMESH_HD constexpr std::uint32_t corner_after(std::uint32_t k) { return k == 2 ? 0 : k + 1; }
VDWMESH_HD constexpr std::uint32_t corner_before(std::uint32_t k) { return k == 0 ? 2 : k - 1; }

// Edge k of a triangle is opposite to its vertex k. It has a neighbouring triangle, or kNoNeighbor,
// and it may be a piece of the boundary.
struct LinkedTriangle {
  std::array<std::uint32_t, 3> vertices, neighbors, pieces;

  // The corner whose opposite edge leads to triangle t. Precondition: t is a neighbour.
  VDWMESH_HD std::uint32_t corner_opposite(std::uint32_t t) const {
    return neighbors[0] == t ? 0 : (neighbors[1] == t ? 1 : 2);
  }
  // The corner at vertex v. Precondition: v is a vertex.
  VDWMESH_HD std::uint32_t corner_at(std::uint32_t v) const {
    return vertices[0] == v ? 0 : (vertices[1] == v ? 1 : 2);
  }
};

// Makes the triangle beyond edge k of triangle t, if there is one, name t as its neighbour in place
// of triangle `before`.
VDWMESH_HD inline void relink(LinkedTriangle* triangles, std::uint32_t t, std::uint32_t k,
                              std::uint32_t before) {
  const std::uint32_t n = triangles[t].neighbors[k];
  if (n != kNoNeighbor) triangles[n].neighbors[triangles[n].corner_opposite(before)] = t;
}

// Flips edge k of triangle t, which must have a neighbour n and be no piece. With vertex a of t
// opposite to the edge bc, and vertex d of n, triangles (a, b, c) and (d, c, b) become (a, b, d),
// which is t, and (a, d, c), which is n. So a is corner 0 of both, and their edges 0 are those of
// n. The corner of n opposite to the edge is m.
//
// Every number is read by itself, before any is written: copies of whole triangles would be read in
// larger parts than those in which the flip before has written them, for which a processor waits.
VDWMESH_HD inline void flip(LinkedTriangle* triangles, std::uint32_t t, std::uint32_t k,
                            std::uint32_t m) {
  LinkedTriangle& one = triangles[t];
  const std::uint32_t n = one.neighbors[k];
  LinkedTriangle& two = triangles[n];
  const std::uint32_t k1 = corner_after(k), k2 = corner_before(k);
  const std::uint32_t m1 = corner_after(m), m2 = corner_before(m);
  const std::uint32_t a = one.vertices[k], b = one.vertices[k1], c = one.vertices[k2],
                      d = two.vertices[m];
  // What lies beyond each edge. The corners m1 and m2 of n are c and b. So edge bd of n is opposite
  // to m1, and dc to m2.
  const std::uint32_t beyond_ab = one.neighbors[k2], beyond_ca = one.neighbors[k1],
                      beyond_bd = two.neighbors[m1], beyond_dc = two.neighbors[m2];
  const std::uint32_t piece_ab = one.pieces[k2], piece_ca = one.pieces[k1],
                      piece_bd = two.pieces[m1], piece_dc = two.pieces[m2];
  one.vertices = {a, b, d};
  one.neighbors = {beyond_bd, n, beyond_ab};
  one.pieces = {piece_bd, kNoPiece, piece_ab};
  two.vertices = {a, d, c};
  two.neighbors = {beyond_dc, beyond_ca, t};
  two.pieces = {piece_dc, piece_ca, kNoPiece};
  relink(triangles, t, 0, n);
  relink(triangles, n, 1, t);
}
VDWMESH_HD inline void flip(LinkedTriangle* triangles, std::uint32_t t, std::uint32_t k) {
  flip(triangles, t, k, triangles[triangles[t].neighbors[k]].corner_opposite(t));
}

// Places in a triangulation of the plane, and what became of insertions into it.
// PlaneTriangulation has them as members.
struct PlaneTypes {
  // An edge of a triangle by the number of the opposite corner.
  struct TriangleEdge {
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
