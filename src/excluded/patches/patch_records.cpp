// PatchRecords: makes all concave patches on all cores, and keeps what sums and topology need of
// them, in the order of the probes.
#include "excluded/patches/patch_records.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"
#include "excluded/patches/patch_boundary.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kPi = std::numbers::pi;

// Sorts the names of three probes; `positive` is turned over by an odd permutation.
CreaseEnd common_point(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  bool positive = true;
  const auto order = [&](std::uint32_t& x, std::uint32_t& y) {
    if (x <= y) return;
    std::swap(x, y);
    positive = !positive;
  };
  order(a, b);
  order(b, c);
  order(a, b);
  return {{a, b, c}, positive};
}

// A cusp of a spindle's side. The side has two segments: the first one ends in cusp 0, the second
// one begins in cusp 1.
CreaseEnd cusp(const AccessibleSurface& surface, const PatchSide& side, std::size_t which) {
  const RolledArc& arc = surface.arcs[side.arc];
  return cusp_of(arc, arc.ball[0] == side.atom[which] ? 0 : 1);
}

// The volume between the probe's centre and the patch in units of the probe's radius: cones over
// the patch and over the flat faces of its caps.
double cone_volume(const ConcavePatch& patch) {
  double sum = flat_faces(patch, [](CapFace<HeapLists>&) {});
  for (const PatchPiece& piece : patch.pieces) sum += piece.solid_angle;
  return sum / 3;
}

}  // namespace

CreaseEnd crease_end(const AccessibleSurface& surface, const ConcavePatch& patch, std::uint32_t i,
                     std::uint32_t j) {
  const auto caps = static_cast<std::uint32_t>(patch.caps.size());
  if (i == kNoIndex || j == kNoIndex) return {{0, kNoIndex, kNoIndex}, true};
  if (i >= caps) return cusp(surface, patch.sides[i - caps], 0);
  if (j >= caps) return cusp(surface, patch.sides[j - caps], 1);
  return common_point(patch.probe, patch.caps[i].probe, patch.caps[j].probe);
}

PatchRecords::PatchRecords(const AccessibleSurface& surface, std::span<const std::uint8_t> included,
                           Monitor* monitor)
    : side_piece(surface.sides.size(), {kNoIndex, kNoIndex}),
      first_crease(surface.probes.size() + 1, 0) {
  const LowProbes low(surface, included);
  std::uint32_t next = 0;
  const auto add_up_to = [&](std::uint32_t end) {
    for (; next < end; ++next) {
      if (included[surface.probes[next].component]) add_whole(surface, next);
      first_crease[next + 1] = static_cast<std::uint32_t>(creases.size());
    }
  };
  make_and_add(
      low.list().size(),
      [&](std::size_t i) {
        advance(monitor, 0);
        ConcavePatch patch = concave_patch(surface, low, included, low.list()[i]);
        const double cones = cone_volume(patch);
        return std::pair{std::move(patch), cones};
      },
      [&](std::size_t, const std::pair<ConcavePatch, double>& made) {
        const auto& [patch, cones] = made;
        add_up_to(patch.probe);
        add_cut(surface, patch);
        layer += cones;
        first_crease[++next] = static_cast<std::uint32_t>(creases.size());
      });
  add_up_to(static_cast<std::uint32_t>(surface.probes.size()));
  const double p = surface.probe_radius;
  layer *= p * p * p;
  find_homes(surface);
}

void PatchRecords::find_homes(const AccessibleSurface& surface) {
  DisjointSets together(surface.components.size());
  for (const Crease& c : creases) {
    together.join(surface.probes[c.probe].component, surface.probes[c.other].component);
  }
  for (std::uint32_t c = 0; c < surface.components.size(); ++c) {
    home.push_back(surface.components[together.find(c)].home);
  }
}

void PatchRecords::add_whole(const AccessibleSurface& surface, std::uint32_t probe) {
  const Probe& p = surface.probes[probe];
  const auto piece = static_cast<std::uint32_t>(pieces.size());
  const std::uint32_t loops = p.side_count > 0 ? 1 : 0;
  pieces.push_back(
      {probe, loops, p.solid_angle, polygon_vector(patch_sides(surface, p)), p.solid_angle});
  for (std::uint32_t s = 0; s < p.side_count; ++s) side_piece[p.sides_begin + s] = {piece, piece};
  layer += p.solid_angle / 3;
}

void PatchRecords::add_cut(const AccessibleSurface& surface, const ConcavePatch& patch) {
  const auto first = static_cast<std::uint32_t>(pieces.size());
  const auto caps = static_cast<std::uint32_t>(patch.caps.size());
  for (const PatchPiece& piece : patch.pieces) {
    pieces.push_back(
        {patch.probe, piece.loops, piece.solid_angle, piece.vector, piece.solid_angle});
  }
  for (const PatchSegment& s : patch.segments) {
    ConcavePiece& piece = pieces[first + s.piece];
    if (s.circle >= caps) {
      // The side of a spindle has two segments, one at either atom. Any other side has one.
      const PatchSide& side = patch.sides[s.circle - caps];
      const bool from_a = surface.arcs[side.arc].ball[0] == side.atom[0];
      auto& near = side_piece[surface.probes[patch.probe].sides_begin + s.circle - caps];
      if (!side.spindle || s.next == side.gap) near[from_a ? 0 : 1] = first + s.piece;
      if (!side.spindle || s.before == side.gap) near[from_a ? 1 : 0] = first + s.piece;
      if (side.spindle && s.next == side.gap) piece.bend -= kPi - s.turning;
      continue;
    }
    const PatchCap& cap = patch.caps[s.circle];
    const CreaseEnd from = crease_end(surface, patch, s.before, s.circle),
                    to = crease_end(surface, patch, s.circle, s.next);
    creases.push_back({patch.probe, cap.probe, first + s.piece, from, to});
    piece.bend -= s.angle * cap.cosine;
    piece.crease_turn += s.angle * cap.cosine;
    piece.crease_vector = piece.crease_vector + cap.cosine * segment_integral(patch, s);
    if (s.next == kNoIndex) continue;
    piece.bend -= kPi - s.turning;
    if (!to.is_cusp()) piece.bend += 2 * kPi / 3;
  }
  extended_decisions += patch.extended;
  ties += patch.tie;
  uncertified += !patch.certified;
}

}  // namespace vdwmesh::excluded
