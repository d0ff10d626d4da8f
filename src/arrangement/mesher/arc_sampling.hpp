// Vertices on the arcs of the boundary, shared by the patches on both sides of each arc.
//
// An arc of n pieces has the points 0 .. n: point 0 is its first corner and point n its last; on a
// whole circle they are one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/mesher/boundary_arcs.hpp"

namespace vdwmesh {

// Pieces of a whole circle, at least; an arc's piece never turns further than one of these.
inline constexpr std::uint32_t kLeastPiecesOfCircle = 8;

struct ArcPiece {
  std::uint32_t arc, piece;  // from point `piece` to point `piece` + 1
  friend auto operator<=>(const ArcPiece&, const ArcPiece&) = default;
};

// A piece that is to be halved, its halves again and so on.
struct PieceSplit {
  ArcPiece piece;
  std::uint32_t halvings;
  friend auto operator<=>(const PieceSplit&, const PieceSplit&) = default;
};

class ArcSampling {
 public:
  // Equal pieces of at most `edge_length` (scaled). The arcs must outlive this.
  ArcSampling(const BoundaryArcs& boundary, double edge_length);

  std::uint32_t pieces(std::uint32_t arc) const;
  Vec3d point(std::uint32_t arc, std::uint32_t index) const;
  double piece_angle(const ArcPiece& piece) const;
  // `splits` are sorted, each piece once, as numbered before the call.
  void split(std::span<const PieceSplit> splits);

  // Vertices: the corners, then the points between the ends of arc after arc. Valid until the next
  // split().
  void number_vertices();
  std::uint32_t vertex(std::uint32_t arc, std::uint32_t index) const;
  std::uint32_t vertex_count() const;

 private:
  // Angle of a point as a part of the sweep.
  double part(std::uint32_t arc, std::uint32_t index) const;

  const BoundaryArcs& boundary_;
  std::vector<std::uint32_t> pieces_;         // per arc
  std::vector<std::vector<double>> unequal_;  // per arc: parts of points 1 .. n - 1; empty: equal
  std::vector<std::uint32_t> first_vertex_;   // per arc, and one more
};

}  // namespace vdwmesh
