// Projects the boundary of a patch and finds pieces that overlap or cross. Pieces are straight
// segments in the plane.
//
// Pieces with two common ends are found in a list sorted by their ends. Crossings are found by a
// sweep along x over the bounding boxes of the pieces (sweep and prune); CGAL's exact predicate
// decides about each pair of overlapping boxes. patch_mesher.cpp calls this before and during its
// triangulation.
#include "arrangement/mesher/flat_boundary.hpp"

#include <algorithm>
#include <utility>

namespace vdwmesh {

FlatBoundary::FlatBoundary(const PatchBoundary& boundary, const Stereographic& plane)
    : boundary_(boundary) {
  points_.reserve(boundary.points.size());
  for (const Vec3d& u : boundary.points) {
    const PlanePoint p = plane.project(u);
    points_.emplace_back(p.x, p.y);
  }
  // Equal points are neighbours after sorting.
  std::vector<Point> sorted = points_;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) throw CoincidentPoints();
  for (std::uint32_t p = 0; p < boundary.pieces.size(); ++p) {
    const auto [low, high] = std::minmax(boundary.pieces[p].from, boundary.pieces[p].to);
    by_ends_.push_back({low, high, p});
  }
  std::sort(by_ends_.begin(), by_ends_.end());
}

std::uint32_t FlatBoundary::piece_between(std::uint32_t a, std::uint32_t b) const {
  const auto key = std::minmax(a, b);
  const auto found =
      std::lower_bound(by_ends_.begin(), by_ends_.end(), key, [](const auto& entry, const auto& k) {
        return std::pair(entry[0], entry[1]) < std::pair<std::uint32_t, std::uint32_t>(k);
      });
  return (*found)[2];
}

std::vector<std::uint32_t> FlatBoundary::doubled_pieces() const {
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < by_ends_.size(); ++i) {
    const auto& [low, high, piece] = by_ends_[i];
    if (low == high) found.push_back(piece);
    if (i == 0 || by_ends_[i - 1][0] != low || by_ends_[i - 1][1] != high) continue;
    found.push_back(by_ends_[i - 1][2]);
    found.push_back(piece);
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

// The boxes are sorted by their left ends, xmin. Two pieces can cross only if their boxes overlap.
// So for each box it is enough to look at the following ones up to the first that begins behind it.
std::vector<std::uint32_t> FlatBoundary::crossings(Monitor* monitor) const {
  std::vector<std::uint32_t> found;
  std::vector<std::pair<CGAL::Bbox_2, std::uint32_t>> boxes;
  boxes.reserve(boundary_.pieces.size());
  for (std::uint32_t p = 0; p < boundary_.pieces.size(); ++p) {
    boxes.push_back({segment(p).bbox(), p});
  }
  std::sort(boxes.begin(), boxes.end(),
            [](const auto& a, const auto& b) { return a.first.xmin() < b.first.xmin(); });
  for (auto a = boxes.begin(); a != boxes.end(); ++a) {
    check_cancelled(monitor, static_cast<std::size_t>(a - boxes.begin()));
    for (auto b = a + 1; b != boxes.end() && b->first.xmin() <= a->first.xmax(); ++b) {
      if (!CGAL::do_overlap(a->first, b->first) || !do_cross(a->second, b->second)) continue;
      found.push_back(a->second);
      found.push_back(b->second);
    }
  }
  return found;
}

FlatBoundary::Kernel::Segment_2 FlatBoundary::segment(std::uint32_t piece) const {
  return {points_[boundary_.pieces[piece].from], points_[boundary_.pieces[piece].to]};
}

// Pieces with a common end do not count as crossing: two segments from one point meet again only if
// one covers part of the other. Then a point of the boundary lies inside one of the two.
// mark_inside() in patch_mesher.cpp finds that piece, because it is no single edge of the
// triangulation.
bool FlatBoundary::do_cross(std::uint32_t p, std::uint32_t q) const {
  const BoundaryPiece &one = boundary_.pieces[p], &other = boundary_.pieces[q];
  const bool joined =
      other.from == one.from || other.from == one.to || other.to == one.from || other.to == one.to;
  return !joined && CGAL::do_intersect(segment(p), segment(q));
}

}  // namespace vdwmesh
