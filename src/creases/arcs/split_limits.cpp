// SplitLimits: limits on how straight a piece to be split may be, and on the number of pieces of
// one arc and of all, beside what there was at first.
#include "creases/arcs/split_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/blocks.hpp"

namespace vdwmesh {
namespace {

// How many pieces there may be on one arc, and in all, besides 64 for each piece there was at
// first: kMostGrowth for the usual and finer feature sizes, kCoarserGrowth for coarser ones.
// Coarser sizes are tried only after curves were found too close for the usual sizes, and several
// of them in turn, so less is spent on each. In a small set the limit on all ends the splitting of
// several curves; in a large molecule it allows millions of pieces, and the limit on one arc ends
// it.
constexpr std::uint64_t kMostGrowth = std::uint64_t{1} << 16, kCoarserGrowth = kMostGrowth / 4;
// A piece counts as straight if its sagitta, the largest distance between chord and arc, is below
// this fraction of the size of its coordinates. Rounding moves a coordinate of size S by up to
// 2^-53 S, which is 32 times as far. So the midpoint of such a piece lies on its chord, as far as
// coordinates tell.
constexpr double kStraight = 0x1p-58;

double largest_coordinate(const Vec3d& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

}  // namespace

SplitLimits::SplitLimits(std::span<const SphereId> ids, const BoundaryArcs& boundary,
                         const ArcSampling& sampling)
    : ids_(ids),
      boundary_(boundary),
      sampling_(sampling),
      pieces_of_arc_at_first_(sampling.pieces()),
      allowed_growth_(boundary.sizes.arc > FeatureSizes{}.arc ? kCoarserGrowth : kMostGrowth) {}

void SplitLimits::refuse(const ArcPiece& piece, const std::string& by) const {
  const auto& balls = boundary_.arcs[piece.arc].balls;
  throw CurvesTooClose(fmt::format(
      "where spheres {} and {} meet, curves of the boundary are too close to be told apart {}: "
      "leave out one of two spheres that all but coincide, or use marching cubes",
      ids_[balls[0]], ids_[balls[1]], by));
}

void SplitLimits::refuse_after(int rounds, const ArcPiece& piece) const {
  refuse(piece, fmt::format("in {} rounds of splitting them", rounds));
}

void SplitLimits::refuse_coincident(std::uint32_t ball) const {
  throw CurvesTooClose(fmt::format(
      "two curves on sphere {} are closer than double precision can tell: leave out one of two "
      "spheres that all but coincide, or use marching cubes",
      ids_[ball]));
}

// The split of a straight piece would not move any point off the chord, so whatever crosses the
// piece or folds over it would do so with the halves as well. The sagitta of an arc of radius r and
// angle a is r a² / 8 for small a.
bool SplitLimits::is_straight(const ArcPiece& piece, double times) const {
  const BoundaryArc& arc = boundary_.arcs[piece.arc];
  const double angle = sampling_.piece_angle(piece);
  const double size = largest_coordinate(arc.center) + arc.radius;
  return arc.radius * angle * angle / 8 < times * kStraight * size;
}

void SplitLimits::check_straightness(std::span<const PieceSplit> splits) const {
  const auto is_straight_piece = [&](std::size_t i) { return is_straight(splits[i].piece); };
  if (const auto i = first_of_all(splits.size(), is_straight_piece)) {
    refuse(splits[*i].piece, "in double precision");
  }
}

bool SplitLimits::has_grown(std::uint64_t now, std::uint64_t at_first) const {
  return now > allowed_growth_ + 64 * at_first;
}

// For angles, an arc gets at most so many pieces, besides 16 for each piece it had at first, and
// what one more round adds. Both are at most a quarter of what has_grown() allows.
bool SplitLimits::has_room_for_angles(std::uint32_t arc) const {
  constexpr std::uint64_t kMostForAngles = 1024;
  return sampling_.pieces(arc) <= kMostForAngles + 16 * pieces_of_arc_at_first_[arc];
}

bool SplitLimits::leave_room(std::span<const PieceSplit> splits) const {
  return !first_of_all(splits.size(),
                       [&](std::size_t i) { return !has_room_for_angles(splits[i].piece.arc); });
}

void SplitLimits::check_fit(const Growth& growth) const {
  if (growth.fits) return;
  throw LimitExceeded(fmt::format(
      "a mesh with {} points on its creases needs more than {} bytes of memory: allow more, or use "
      "a larger edge length",
      growth.pieces, growth.memory_limit));
}

// Curves that nearly coincide ask for shorter and shorter pieces. If the arcs have too many
// together, the message names the two spheres of that arc, among those just split, which has most.
void SplitLimits::check_growth(std::span<const PieceSplit> splits, const Growth& growth) const {
  const auto is_too_fine = [&](std::size_t i) {
    const std::uint32_t arc = splits[i].piece.arc;
    return has_grown(sampling_.pieces(arc), pieces_of_arc_at_first_[arc]);
  };
  if (const auto i = first_of_all(splits.size(), is_too_fine)) {
    const ArcPiece& piece = splits[*i].piece;
    refuse(piece, fmt::format("by {} points on one of them", sampling_.pieces(piece.arc)));
  }
  if (!has_grown(growth.pieces, growth.pieces_at_first)) return;
  if (splits.empty()) throw CurvesTooClose("the arcs of other processes have too many pieces");
  const auto& longest =
      *std::ranges::max_element(splits, [&](const PieceSplit& a, const PieceSplit& b) {
        return sampling_.pieces(a.piece.arc) < sampling_.pieces(b.piece.arc);
      });
  refuse(longest.piece, fmt::format("by {} points on all of them", growth.pieces));
}

}  // namespace vdwmesh
