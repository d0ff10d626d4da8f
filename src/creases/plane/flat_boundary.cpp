// Finds pieces that overlap or cross. Pieces are straight segments in the plane.
//
// Crossings are found by a sweep along x over the bounding boxes of the pieces (sweep and prune);
// exact orientation tests decide about each pair of overlapping boxes. patch_mesher.cpp calls this
// before and during its triangulation.
#include "creases/plane/flat_boundary.hpp"

#include <algorithm>
#include <utility>

#include "creases/plane/plane_predicates.hpp"

namespace vdwmesh {
namespace {

// Whether the closed intervals [low, high] of two boxes overlap along y. Along x the sweep knows.
template <class PieceBox>
bool overlap_in_y(const PieceBox& a, const PieceBox& b) {
  return a.low.y <= b.high.y && b.low.y <= a.high.y;
}

// Whether points c and d lie on different sides of the line through a and b, or on it.
bool parts(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  return exact_orientation(a, b, c) * exact_orientation(a, b, d) <= 0;
}

}  // namespace

std::vector<std::uint32_t> FlatBoundary::doubles_of(std::span<const std::uint32_t> pieces) const {
  const auto ends = [&](std::uint32_t p) {
    return std::pair<std::uint32_t, std::uint32_t>(
        std::minmax(boundary_.pieces[p].from, boundary_.pieces[p].to));
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wanted;
  for (const std::uint32_t p : pieces) wanted.push_back(ends(p));
  std::ranges::sort(wanted);
  std::vector<std::uint32_t> found;
  for (std::uint32_t q = 0; q < boundary_.pieces.size(); ++q) {
    if (std::ranges::binary_search(wanted, ends(q))) found.push_back(q);
  }
  return found;
}

std::vector<std::uint32_t> FlatBoundary::crossings_of(std::uint32_t piece) const {
  std::vector<std::uint32_t> found = {piece};
  for (std::uint32_t q = 0; q < boundary_.pieces.size(); ++q) {
    if (do_cross(piece, q)) found.push_back(q);
  }
  return found;
}

// The boxes are sorted by their left ends. Two pieces can cross only if their boxes overlap. So for
// each box it is enough to look at the following ones up to the first that begins behind it.
std::vector<std::uint32_t> FlatBoundary::crossings(Monitor* monitor) const {
  std::vector<std::uint32_t> found;
  std::vector<PieceBox> boxes;
  boxes.reserve(boundary_.pieces.size());
  for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) boxes.push_back(box(p));
  std::sort(boxes.begin(), boxes.end(),
            [](const PieceBox& a, const PieceBox& b) { return a.low.x < b.low.x; });
  for (auto a = boxes.begin(); a != boxes.end(); ++a) {
    check_cancelled(monitor, static_cast<std::size_t>(a - boxes.begin()));
    for (auto b = a + 1; b != boxes.end() && b->low.x <= a->high.x; ++b) {
      if (!overlap_in_y(*a, *b) || !do_cross(a->piece, b->piece)) continue;
      found.push_back(a->piece);
      found.push_back(b->piece);
    }
  }
  return found;
}

std::array<PlanePoint, 2> FlatBoundary::segment(std::uint32_t piece) const {
  return {points_[boundary_.pieces[piece].from], points_[boundary_.pieces[piece].to]};
}

FlatBoundary::PieceBox FlatBoundary::box(std::uint32_t piece) const {
  const auto [a, b] = segment(piece);
  return {
      {std::min(a.x, b.x), std::min(a.y, b.y)}, {std::max(a.x, b.x), std::max(a.y, b.y)}, piece};
}

// Pieces with a common end do not count as crossing: two segments from one point meet again only if
// one covers part of the other. Then a point of the boundary lies inside one of the two, and
// PlaneTriangulation finds that piece blocked.
//
// Other segments meet if each has the ends of the other on different sides, or touches its line.
// That holds for all segments on one line as well, for which the boxes decide.
bool FlatBoundary::do_cross(std::uint32_t p, std::uint32_t q) const {
  const BoundaryPiece &one = boundary_.pieces[p], &other = boundary_.pieces[q];
  const bool joined =
      other.from == one.from || other.from == one.to || other.to == one.from || other.to == one.to;
  if (joined) return false;
  const PieceBox b = box(p), c = box(q);
  if (b.low.x > c.high.x || c.low.x > b.high.x || !overlap_in_y(b, c)) return false;
  const auto [p0, p1] = segment(p);
  const auto [q0, q1] = segment(q);
  return parts(p0, p1, q0, q1) && parts(q0, q1, p0, p1);
}

}  // namespace vdwmesh
