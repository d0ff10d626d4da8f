// The sample points on all arcs of the boundary. The two patches beside an arc use the same points,
// which makes the mesh watertight.
//
// Sample points divide an arc into pieces. An arc of n pieces has the points 0 .. n. Point 0 is its
// first corner and point n its last. On a whole circle both are the same point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/buffer.hpp"
#include "core/host_device.hpp"
#include "core/no_index.hpp"
#include "core/vec3.hpp"
#include "creases/arcs/patch_vector.hpp"

namespace vdwmesh {

struct BoundaryArcs;

// A whole circle has at least this many pieces. A piece of any arc turns by at most 2 pi over this
// number.
inline constexpr std::uint32_t kLeastPiecesOfCircle = 8;

// A piece of an arc between two neighbouring sample points. In the mesh it is a straight chord.
// Pieces are ordered by arc, then along the arc.
struct ArcPiece {
  std::uint32_t arc, piece;  // index of the arc; the piece runs from point `piece` to `piece` + 1
  friend auto operator<=>(const ArcPiece&, const ArcPiece&) = default;
};

// A request to split a piece into 2^halvings parts of equal angle; or, if `cut` is not 0, into two
// parts (halvings is 1), of which the first one along the arc has the fraction cut / 2^32.
struct PieceSplit {
  ArcPiece piece;
  std::uint32_t halvings, cut = 0;

  std::uint32_t parts() const { return 1u << halvings; }
  // The fraction of the angle that the first `count` parts along the arc have together.
  double fraction_of_first(std::uint32_t count) const {
    if (cut != 0 && count == 1) return cut * 0x1p-32;
    return static_cast<double>(count) / parts();
  }
  friend auto operator<=>(const PieceSplit&, const PieceSplit&) = default;
};

// Which vertex of the mesh a sample point is, in a form that the numbers of vertices do not change:
// vertex `offset` of those between the ends of an arc, or the corner `offset` if `arc` is kNoIndex.
struct PointSource {
  std::uint32_t arc, offset;

  // Its number. `first_vertices` has the number of the first vertex between the ends of each arc.
  VDWMESH_HD std::uint32_t vertex(const std::uint32_t* first_vertices) const {
    return arc == kNoIndex ? offset : first_vertices[arc] + offset;
  }
};

// Sorts requests by piece and keeps one for each: that with the most halvings, and of several such
// that with the largest `cut`.
void merge_splits(std::vector<PieceSplit>& splits);
// The patches on both sides of the pieces, by BoundaryArc::balls: ascending, each once. Splits are
// sorted.
std::vector<std::uint32_t> sides_of(const BoundaryArcs& boundary,
                                    std::span<const PieceSplit> splits);

// How each arc is divided into pieces, and which mesh vertex each sample point is.
class ArcSampling {
 public:
  // Divides every arc into equal pieces. They are no longer than the edge length of either of its
  // two balls, measured along the arc, and turn by no more than kLeastPiecesOfCircle allows.
  // `edge_lengths` are by ball, in scaled units. Keeps a reference to `boundary`. Throws
  // LimitExceeded for an arc of 10^9 pieces or more.
  ArcSampling(const BoundaryArcs& boundary, std::span<const double> edge_lengths);
  // Frees the lists of all arcs on all cores.
  ~ArcSampling();
  ArcSampling(const ArcSampling&) = delete;
  ArcSampling& operator=(const ArcSampling&) = delete;

  // The number of pieces of an arc, and of every arc.
  std::uint32_t pieces(std::uint32_t arc) const;
  const std::vector<std::uint32_t>& pieces() const { return pieces_; }
  // The number of pieces of all arcs.
  std::uint64_t all_pieces() const { return all_pieces_; }
  // Position of a sample point, 0 <= index <= pieces(arc). Ends of an arc are exactly its corners.
  Vec3d point(std::uint32_t arc, std::uint32_t index) const;
  // The angle of sample point `index` as a fraction of the arc's sweep, 0 to 1.
  double part(std::uint32_t arc, std::uint32_t index) const;
  // The fractions of all sample points of arcs with unequal pieces, one arc after another, and
  // where those of an arc begin; kNoIndex: its pieces are equal.
  struct Fractions {
    Buffer<std::uint32_t> first;
    Buffer<double> values;
  };
  // Precondition: the vertices are numbered, so that 32 bits number the points.
  Fractions unequal_fractions() const;
  // The angle (rad) by which the arc turns along the piece.
  double piece_angle(const ArcPiece& piece) const;
  // Splits pieces. `splits` must be sorted by piece and name each piece once, all with the numbers
  // that they have before the call. Afterwards the pieces of an arc that was split have new
  // numbers.
  void split(std::span<const PieceSplit> splits);
  // The first one of an arc among the splits of the last call of split(), which are given once
  // more; their number if there is none. In constant time.
  std::size_t first_split(std::uint32_t arc, std::span<const PieceSplit> splits) const;

  // Numbers the vertices: all corners first, then arc by arc the points between its ends. The
  // numbers are valid until the next split(). Throws LimitExceeded past 2^32 - 2 vertices.
  void number_vertices();
  // The number of a sample point, and of all of them.
  std::uint32_t vertex(std::uint32_t arc, std::uint32_t index) const;
  // It stays the same until a piece of the arc is split.
  PointSource source(std::uint32_t arc, std::uint32_t index) const;
  std::uint32_t vertex_count() const;
  // The number of the first point between the ends of an arc; of all vertices if there is no such
  // arc any more.
  std::uint32_t first_vertex(std::uint32_t arc) const { return first_vertex_[arc]; }
  const std::vector<std::uint32_t>& first_vertices() const { return first_vertex_; }

 private:
  // Splits pieces of the arc that the first request names; the requests for it come first.
  void split_arc(std::span<const PieceSplit> splits);

  const BoundaryArcs& boundary_;
  std::vector<std::uint32_t> pieces_;  // per arc: the number of its pieces
  std::uint64_t all_pieces_ = 0;
  // Per arc: the fractions of points 1 .. n - 1, ascending. Empty while all pieces of the arc are
  // equal.
  std::vector<PatchVector<double>> unequal_;
  // Per arc: the first of its splits when it was split last. It is not reset in rounds that leave
  // the arc alone.
  std::vector<std::uint32_t> first_split_;
  // Per arc: the vertex number of its first sample point that is no corner. One more entry at the
  // end is the number of all vertices.
  std::vector<std::uint32_t> first_vertex_;
};

}  // namespace vdwmesh
