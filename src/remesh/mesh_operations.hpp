// MeshOperations: a mesh on the surface, and the operations that change it, each behind the judge.
// For the library's own use.
#pragma once

#include <span>
#include <vector>

#include "remesh/judge.hpp"

namespace vdwmesh::remesh {

// Shapes: squared sines of the least angle (shape_of()), here of 7, 40 and 10°. Collapses may leave
// thin triangles, which flips and moves mend: with 20° in place of 7° the collapses get stuck, and
// 1 % of the angles stay 5° smaller. A flip of good triangles must not take them farther away.
inline constexpr double kLeastCollapsedShape = 0.015, kGoodShape = 0.41, kLeastSplitShape = 0.03;
// Edges are split from this share of the wanted length on, and no collapse makes longer ones. With
// 1.5 the density is the one of equilateral triangles of that length within some 7 %.
inline constexpr double kLongestShare = 1.5;

class MeshOperations {
 public:
  // `edge_length` and `farthest` in Å, as the judge's. The oracle and the circles must outlive
  // this.
  MeshOperations(DynamicMesh mesh, VertexTable vertices, std::span<const CreaseCircle> circles,
                 const FootOracle& oracle, std::span<const Box> zones, double edge_length,
                 double farthest);
  MeshOperations(const MeshOperations&) = delete;  // its parts look at each other

  const DynamicMesh& mesh() const { return mesh_; }
  const VertexTable& vertices() const { return vertices_; }
  std::uint64_t joined() const { return joined_; }

  // The length of an edge as a share of the length that is wanted at its ends.
  double share(HalfEdge h) const;
  double shape(std::uint32_t triangle) const;

  // Each returns whether it changed the mesh. A collapse returns the vertex that is left, or kNone.
  // None of its triangles is worse than `least_shape`, or all are better than the worst one before.
  std::uint32_t collapse(HalfEdge h, double least_shape);
  bool split(HalfEdge h);
  bool flip(HalfEdge h);
  // Moves a vertex this share of the way to the middle of its neighbours. Its worst triangle
  // becomes better, or has at least the shape `good`.
  bool smooth(std::uint32_t vertex, double good, double share_of_way);

 private:
  std::uint32_t collapse_onto(HalfEdge h, double least_shape);
  bool may_leave(HalfEdge h) const;
  Vec3d middle_of_ring(std::uint32_t vertex) const;
  Vec3d middle_of_crease(std::uint32_t vertex, std::uint32_t& circle) const;
  // A point of the surface near p, on the circle unless that is kNone.
  std::optional<Foot> place(const Vec3d& p, const Vec3d& hint, std::uint32_t circle) const;
  // Sets change_ to the triangles at a vertex and those with `vertex` at `to` in its place, but for
  // those that have that vertex already. Returns the worst shape of the former.
  double replace_at(std::uint32_t at, std::uint32_t vertex, const Vec3d& to);
  void note_ring(std::uint32_t vertex);
  NewTriangle placed(const Triangle& vertices) const;

  DynamicMesh mesh_;
  VertexTable vertices_;
  std::span<const CreaseCircle> circles_;
  const FootOracle& oracle_;
  CrossingGuard guard_;
  Judge judge_;
  double edge_length_;
  std::uint64_t joined_ = 0;
  MeshChange change_;  // kept for its memory
};

}  // namespace vdwmesh::remesh
