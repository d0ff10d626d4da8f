// DynamicMesh: a closed triangle mesh whose edges can be collapsed, split and flipped. For the
// library's own use.
//
// A corner table: half-edge 3 t + k of triangle t runs from its vertex k to the next one; its
// opposite runs back. The operations change connectivity alone and keep the mesh a closed oriented
// manifold of the same topology if they are allowed (the link condition of Dey, Edelsbrunner, Guha
// and Nekhayev, Publ. Inst. Math. 66 (1999) 23).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh::remesh {

using HalfEdge = std::uint32_t;
inline constexpr std::uint32_t kNone = 0xffffffffu;

class DynamicMesh {
 public:
  // Throws InvalidInput unless the mesh is a closed oriented manifold.
  explicit DynamicMesh(const IndexedMesh& mesh);

  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(corners_.size() / 3); }
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(out_.size()); }
  bool is_triangle(std::uint32_t t) const { return corners_[3 * t] != kNone; }
  bool is_vertex(std::uint32_t v) const { return out_[v] != kNone; }
  Triangle triangle(std::uint32_t t) const {
    return {corners_[3 * t], corners_[3 * t + 1], corners_[3 * t + 2]};
  }

  static HalfEdge next(HalfEdge h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static HalfEdge previous(HalfEdge h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t from(HalfEdge h) const { return corners_[h]; }
  std::uint32_t to(HalfEdge h) const { return corners_[next(h)]; }
  // The vertex across the triangle of a half-edge.
  std::uint32_t apex(HalfEdge h) const { return corners_[previous(h)]; }
  HalfEdge opposite(HalfEdge h) const { return opposite_[h]; }

  // The half-edges that begin at a vertex, one for each triangle around it.
  template <class Visit>
  void visit_spokes(std::uint32_t v, const Visit& visit) const {
    HalfEdge h = out_[v];
    do {
      visit(h);
      h = opposite_[previous(h)];
    } while (h != out_[v]);
  }
  // Every edge once, by the half-edge that begins at the lower vertex, as half-edges rise. A visit
  // may change the mesh; then edges that it makes are visited if they come later.
  template <class Visit>
  void visit_edges(const Visit& visit) const {
    for (HalfEdge h = 0; h < 3 * triangle_count(); ++h) {
      if (is_triangle(h / 3) && from(h) < to(h)) visit(h);
    }
  }
  std::uint32_t valence(std::uint32_t v) const;
  HalfEdge find(std::uint32_t from, std::uint32_t to) const;  // kNone: there is no such edge

  // A number that an edge carries, of either half-edge; kNone at first.
  std::uint32_t mark(HalfEdge h) const { return marks_[h]; }
  void set_mark(HalfEdge h, std::uint32_t mark) { marks_[h] = marks_[opposite_[h]] = mark; }

  // Whether the mesh without the first vertex of h, whose triangles go to the second one, is a
  // manifold of the same topology.
  bool may_collapse(HalfEdge h) const;
  void collapse(HalfEdge h);
  // Whether the other diagonal of the two triangles is no edge yet.
  bool may_flip(HalfEdge h) const;
  void flip(HalfEdge h);
  // Puts a new vertex on the edge and returns it. Both halves keep the mark.
  std::uint32_t split(HalfEdge h);

 private:
  void pair(HalfEdge a, HalfEdge b);
  void pair_edges();
  void set_triangle(std::uint32_t t, const Triangle& vertices,
                    const std::array<HalfEdge, 3>& across);

  std::vector<std::uint32_t> corners_;  // by half-edge: the vertex where it begins
  std::vector<HalfEdge> opposite_;
  std::vector<std::uint32_t> marks_;
  std::vector<HalfEdge> out_;  // by vertex: a half-edge from there
};

}  // namespace vdwmesh::remesh
