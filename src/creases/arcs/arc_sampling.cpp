// Divides arcs into pieces. At first all pieces of an arc are equal, and a count describes them.
// Once a piece has been split, the arc keeps a list of fractions of its sweep instead.
//
// Points are computed anew from the arc's frame at each call. Equal arguments give equal bits, so
// the two patches beside an arc agree on its points without sharing storage. union_mesher.cpp owns
// the sampling and splits pieces between the rounds of meshing.
#include "creases/arcs/arc_sampling.hpp"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "creases/arcs/boundary_arcs.hpp"

namespace vdwmesh {
namespace {

// The largest angle of a piece, rad.
constexpr double kLargestPiece = 2 * std::numbers::pi / kLeastPiecesOfCircle;

// The least number of equal pieces that keeps each piece within both limits: `edge_length` for its
// length along the arc and kLargestPiece for its angle.
std::uint32_t piece_count(const BoundaryArc& arc, double edge_length) {
  const double wanted = std::max(arc.sweep * arc.radius / edge_length, arc.sweep / kLargestPiece);
  // If the quotient is a whole number except for rounding, it must not be rounded up to one more
  // piece. So 1e-12 of it is taken off first, which is far above the rounding of two operations. A
  // piece can exceed the limits by that fraction at most.
  const double count = std::ceil(wanted * (1 - 1e-12));
  if (!(count < 1e9)) throw LimitExceeded("an arc has more than 10^9 pieces; a larger edge length");
  return std::max(1u, static_cast<std::uint32_t>(count));
}

}  // namespace

// The comparison takes a.piece with b.halvings and the other way round, which puts the larger
// number of halvings first; unique() keeps it. Of two cuts the larger one is kept, whoever asked
// first.
void merge_splits(std::vector<PieceSplit>& splits) {
  tbb::parallel_sort(splits.begin(), splits.end(), [](const PieceSplit& a, const PieceSplit& b) {
    return std::tuple(a.piece, b.halvings, b.cut) < std::tuple(b.piece, a.halvings, a.cut);
  });
  const auto same = [](const PieceSplit& a, const PieceSplit& b) { return a.piece == b.piece; };
  splits.erase(std::unique(splits.begin(), splits.end(), same), splits.end());
}

std::vector<std::uint32_t> sides_of(const BoundaryArcs& boundary,
                                    std::span<const PieceSplit> splits) {
  std::vector<std::uint32_t> sides =
      collect<std::uint32_t>(splits.size(), [&](std::size_t i, std::vector<std::uint32_t>& found) {
        const std::uint32_t arc = splits[i].piece.arc;
        if (i > 0 && splits[i - 1].piece.arc == arc) return;
        const auto& beside = boundary.arcs[arc].balls;
        found.insert(found.end(), beside.begin(), beside.end());
      });
  tbb::parallel_sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  return sides;
}

ArcSampling::ArcSampling(const BoundaryArcs& boundary, std::span<const double> edge_lengths)
    : boundary_(boundary), unequal_(boundary.arcs.size()), first_split_(boundary.arcs.size(), 0) {
  pieces_.resize(boundary.arcs.size());
  for_each_index(pieces_.size(), [&](std::size_t a) {
    const BoundaryArc& arc = boundary.arcs[a];
    const double shorter = std::min(edge_lengths[arc.balls[0]], edge_lengths[arc.balls[1]]);
    pieces_[a] = piece_count(arc, shorter);
  });
  all_pieces_ = std::accumulate(pieces_.begin(), pieces_.end(), std::uint64_t{0});
}

ArcSampling::~ArcSampling() {
  for_each_index(unequal_.size(), [&](std::size_t a) { unequal_[a] = {}; });
}

std::uint32_t ArcSampling::pieces(std::uint32_t arc) const { return pieces_[arc]; }

double ArcSampling::part(std::uint32_t arc, std::uint32_t index) const {
  if (index == 0) return 0;
  if (index == pieces_[arc]) return 1;
  return unequal_[arc].empty() ? static_cast<double>(index) / pieces_[arc]
                               : unequal_[arc][index - 1];
}

Vec3d ArcSampling::point(std::uint32_t arc, std::uint32_t index) const {
  const BoundaryArc& a = boundary_.arcs[arc];
  if (a.is_circle()) return a.at(index == pieces_[arc] ? 0 : a.sweep * part(arc, index));
  if (index == 0) return boundary_.corners[a.ends[0]].position;
  if (index == pieces_[arc]) return boundary_.corners[a.ends[1]].position;
  return a.at(a.sweep * part(arc, index));
}

ArcSampling::Fractions ArcSampling::unequal_fractions() const {
  Fractions all;
  all.first.resize(unequal_.size());
  std::uint32_t next = 0;
  for (std::size_t a = 0; a < unequal_.size(); ++a) {
    all.first[a] = unequal_[a].empty() ? kNoIndex : next;
    next += static_cast<std::uint32_t>(unequal_[a].size());
  }
  all.values.resize(next);
  for_each_index(unequal_.size(), [&](std::size_t a) {
    if (!unequal_[a].empty()) std::ranges::copy(unequal_[a], all.values.data() + all.first[a]);
  });
  return all;
}

double ArcSampling::piece_angle(const ArcPiece& piece) const {
  return boundary_.arcs[piece.arc].sweep *
         (part(piece.arc, piece.piece + 1) - part(piece.arc, piece.piece));
}

void ArcSampling::split(std::span<const PieceSplit> splits) {
  // One arc at a time, on all cores.
  for_each_index(splits.size(), [&](std::size_t begin) {
    if (begin > 0 && splits[begin - 1].piece.arc == splits[begin].piece.arc) return;
    first_split_[splits[begin].piece.arc] = static_cast<std::uint32_t>(begin);
    split_arc(splits.subspan(begin));
  });
  for (const PieceSplit& split : splits) all_pieces_ += split.parts() - 1;
}

// An entry of an earlier call does no harm: either it does not lead to a split of the arc, and then
// there is none, or to one, and then this call has set it.
std::size_t ArcSampling::first_split(std::uint32_t arc, std::span<const PieceSplit> splits) const {
  const std::size_t first = first_split_[arc];
  return first < splits.size() && splits[first].piece.arc == arc ? first : splits.size();
}

void ArcSampling::split_arc(std::span<const PieceSplit> splits) {
  const std::uint32_t arc = splits[0].piece.arc;
  PatchVector<double> parts;   // the new entry of unequal_
  auto next = splits.begin();  // the first request that is not yet met
  for (std::uint32_t k = 0; k < pieces_[arc]; ++k) {
    const double low = part(arc, k), high = part(arc, k + 1);
    if (k > 0) parts.push_back(low);
    if (next == splits.end() || next->piece != ArcPiece{arc, k}) continue;
    const PieceSplit& split = *next++;
    for (std::uint32_t i = 1; i < split.parts(); ++i) {
      parts.push_back(low + (high - low) * split.fraction_of_first(i));
    }
  }
  unequal_[arc] = std::move(parts);
  pieces_[arc] = static_cast<std::uint32_t>(unequal_[arc].size() + 1);
}

void ArcSampling::number_vertices() {
  first_vertex_.resize(pieces_.size() + 1);
  // At first, how many vertices each arc has. A whole circle of n pieces has n points of its own;
  // any other arc shares its two ends and has n - 1.
  for_each_index(pieces_.size(), [&](std::size_t a) {
    first_vertex_[a] = pieces_[a] - (boundary_.arcs[a].is_circle() ? 0 : 1);
  });
  first_vertex_.back() = 0;
  std::uint64_t next = boundary_.corners.size();
  for (std::uint32_t& first : first_vertex_) {
    next += std::exchange(first, static_cast<std::uint32_t>(next));
  }
  if (next >= kNoIndex) throw LimitExceeded("the arcs have more than 2^32 - 2 vertices");
}

PointSource ArcSampling::source(std::uint32_t arc, std::uint32_t index) const {
  const BoundaryArc& a = boundary_.arcs[arc];
  if (a.is_circle()) return {arc, index == pieces_[arc] ? 0 : index};
  if (index == 0) return {kNoIndex, a.ends[0]};
  if (index == pieces_[arc]) return {kNoIndex, a.ends[1]};
  return {arc, index - 1};
}

std::uint32_t ArcSampling::vertex(std::uint32_t arc, std::uint32_t index) const {
  return source(arc, index).vertex(first_vertex_.data());
}

std::uint32_t ArcSampling::vertex_count() const { return first_vertex_.back(); }

}  // namespace vdwmesh
