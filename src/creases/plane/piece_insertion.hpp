// Insertion of pieces into the triangulation.
//
// A piece that is no edge yet is made one by flipping the edges that it crosses (Sloan 1993, "A
// fast algorithm for generating constrained Delaunay triangulations"), then the flipped edges are
// made Delaunay again. plane_insertion.hpp says why this ends.
//
// The templates are for plane_triangulation.cpp, which compiles them for the host, and for the
// kernels of the device.
#pragma once

#include "creases/plane/plane_triangulation.hpp"

namespace vdwmesh {

// Finds the edge between two vertices. Of its two triangles, takes the one that has it from a to b
// counter-clockwise, so on the left. Sides of the frame are not found.
template <class Memory>
VDWMESH_HD bool PlaneTriangulationOf<Memory>::find_edge(std::uint32_t a, std::uint32_t b,
                                                        TriangleEdge& edge) const {
  if (!is_frame(a)) return find_edge_at(a, b, edge);
  if (is_frame(b) || !find_edge_at(b, a, edge)) return false;
  const std::uint32_t n = triangles_[edge.triangle].neighbors[edge.corner];
  edge = {n, triangles_[n].corner_opposite(edge.triangle)};
  return true;
}

// find_edge() by the star of vertex a, which is no corner of the frame. No other triangle of the
// star has the edge from a to b on its left, so the first one ends the search.
template <class Memory>
VDWMESH_HD bool PlaneTriangulationOf<Memory>::find_edge_at(std::uint32_t a, std::uint32_t b,
                                                           TriangleEdge& edge) const {
  const std::uint32_t first = triangle_at(a);
  std::uint32_t t = first;
  do {
    const LinkedTriangle& w = triangles_[t];
    const std::uint32_t k = w.corner_at(a), k1 = corner_after(k);
    if (w.vertices[k1] == b) {
      edge = {t, corner_before(k)};
      return true;
    }
    t = w.neighbors[k1];
  } while (t != first);
  return false;
}

// find_edge() for a listed edge: mostly its triangle still has it.
template <class Memory>
VDWMESH_HD bool PlaneTriangulationOf<Memory>::find_listed(const ListedEdge& listed,
                                                          TriangleEdge& edge) const {
  const auto [a, b, t] = listed;
  const auto& v = triangles_[t].vertices;
  for (std::uint32_t k = 0; k < 3; ++k) {
    if (v[k] != a || v[corner_after(k)] != b) continue;
    edge = {t, corner_before(k)};
    return !is_frame(a) || !is_frame(b);
  }
  return find_edge(a, b, edge);
}

template <class Memory>
VDWMESH_HD PlaneTypes::Outcome PlaneTriangulationOf<Memory>::set_piece(const TriangleEdge& edge,
                                                                       std::uint32_t piece) {
  LinkedTriangle& one = triangles_[edge.triangle];
  if (one.pieces[edge.corner] != kNoPiece) return Outcome::doubled;
  LinkedTriangle& other = triangles_[one.neighbors[edge.corner]];
  one.pieces[edge.corner] = piece;
  other.pieces[other.corner_opposite(edge.triangle)] = piece;
  return Outcome::inserted;
}

template <class Memory>
VDWMESH_HD PlaneTypes::Outcome PlaneTriangulationOf<Memory>::insert_piece(std::uint32_t from,
                                                                          std::uint32_t to,
                                                                          std::uint32_t piece) {
  TriangleEdge edge{};
  if (!find_edge(from, to, edge)) {
    const Outcome outcome = find_crossed(from, to);
    if (outcome != Outcome::inserted) return outcome;
    flip_crossed(from, to);
    legalize_flipped(from, to);
    // Without room for all that had to be flipped, there may be no such edge.
    if (memory_.has_failed()) return Outcome::blocked;
    find_edge(from, to, edge);
  }
  return set_piece(edge, piece);
}

// Finds the triangle at `from` which the segment to `to` leaves through the opposite edge. The
// result is not `inserted` if there is none, or if that edge is a piece.
template <class Memory>
VDWMESH_HD PlaneTypes::Outcome PlaneTriangulationOf<Memory>::first_crossed(std::uint32_t from,
                                                                           std::uint32_t to,
                                                                           TriangleEdge& edge) {
  Outcome outcome = Outcome::blocked;
  visit_star(from, [&](std::uint32_t t) {
    const LinkedTriangle& w = triangles_[t];
    const std::uint32_t k = w.corner_at(from);
    const std::uint32_t right = w.vertices[corner_after(k)], left = w.vertices[corner_before(k)];
    if (orientation_of(from, right, to) <= 0 || orientation_of(from, left, to) >= 0) return;
    edge = {t, k};
    outcome = w.pieces[k] == kNoPiece ? Outcome::inserted : Outcome::crossing;
  });
  return outcome;
}

// Lists in crossed_ the edges that the segment crosses, from `from` on, as pairs of vertices. Stops
// at a piece or at a vertex that lies on the segment.
template <class Memory>
VDWMESH_HD PlaneTypes::Outcome PlaneTriangulationOf<Memory>::find_crossed(std::uint32_t from,
                                                                          std::uint32_t to) {
  crossed_.clear();
  TriangleEdge edge{};
  if (const Outcome first = first_crossed(from, to, edge); first != Outcome::inserted) return first;
  while (true) {
    const LinkedTriangle& w = triangles_[edge.triangle];
    crossed_.push_back({w.vertices[corner_after(edge.corner)],
                        w.vertices[corner_before(edge.corner)], edge.triangle});
    const std::uint32_t n = w.neighbors[edge.corner];
    const std::uint32_t m = triangles_[n].corner_opposite(edge.triangle);
    const std::uint32_t apex = triangles_[n].vertices[m];
    if (apex == to) return Outcome::inserted;
    const int side = orientation_of(from, to, apex);
    if (side == 0) return Outcome::blocked;
    // In n, corner m + 1 is on the left of the segment and m + 2 on the right. The segment leaves
    // between the apex and the vertex on its other side.
    edge = {n, side > 0 ? corner_after(m) : corner_before(m)};
    if (triangles_[n].pieces[edge.corner] != kNoPiece) return Outcome::crossing;
  }
}

// Flips the edges of crossed_ until none crosses the segment. An edge whose triangles form no
// convex quadrilateral has to wait until others are flipped. Lists the new edges in flipped_.
template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::flip_crossed(std::uint32_t from, std::uint32_t to) {
  flipped_.clear();
  for (std::size_t i = 0; i < crossed_.size() && !memory_.has_failed(); ++i) {
    const ListedEdge listed = crossed_[i];
    TriangleEdge edge{};
    find_listed(listed, edge);
    const std::uint32_t b = listed.from, c = listed.to;
    const std::uint32_t t = edge.triangle, n = triangles_[t].neighbors[edge.corner];
    const std::uint32_t a = triangles_[t].vertices[edge.corner];
    const std::uint32_t d = triangles_[n].vertices[triangles_[n].corner_opposite(t)];
    const bool convex = orientation_of(a, b, d) > 0 && orientation_of(a, d, c) > 0;
    if (!convex) {
      crossed_.push_back({b, c, t});
      continue;
    }
    flip_edge(t, edge.corner);
    const bool crosses = a != from && a != to && d != from && d != to &&
                         orientation_of(from, to, a) != orientation_of(from, to, d);
    (crosses ? crossed_ : flipped_).push_back({a, d, n});
  }
}

// Makes the new edges of flip_crossed() Delaunay, and the edges around those that are flipped for
// it, but leaves the segment itself.
template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::legalize_flipped(std::uint32_t from,
                                                               std::uint32_t to) {
  while (!flipped_.empty()) {
    const ListedEdge listed = flipped_.back();
    const std::uint32_t a = listed.from, b = listed.to;
    flipped_.pop_back();
    TriangleEdge edge{};
    if ((a == from && b == to) || (a == to && b == from) || !find_listed(listed, edge)) continue;
    if (!should_flip(edge.triangle, edge.corner)) continue;
    const std::uint32_t t = edge.triangle, n = triangles_[t].neighbors[edge.corner];
    flip_edge(t, edge.corner);
    // The four edges around: 0 and 2 of t, 0 and 1 of n.
    const auto &v = triangles_[t].vertices, &w = triangles_[n].vertices;
    for (const ListedEdge& around :
         {ListedEdge{v[1], v[2], t}, {v[0], v[1], t}, {w[1], w[2], n}, {w[2], w[0], n}}) {
      flipped_.push_back(around);
    }
  }
}

template <class Memory>
VDWMESH_HD void PlaneTriangulationOf<Memory>::remove_piece(std::uint32_t from, std::uint32_t to) {
  TriangleEdge edge{};
  if (!find_edge(from, to, edge)) return;
  LinkedTriangle& one = triangles_[edge.triangle];
  LinkedTriangle& other = triangles_[one.neighbors[edge.corner]];
  one.pieces[edge.corner] = kNoPiece;
  other.pieces[other.corner_opposite(edge.triangle)] = kNoPiece;
  flipped_.assign(1, ListedEdge{from, to, edge.triangle});
  legalize_flipped(kNoVertex, kNoVertex);
}

}  // namespace vdwmesh
