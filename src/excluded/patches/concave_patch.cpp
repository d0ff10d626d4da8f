// concave_patch(): the polygon of a probe's sides and the caps of its neighbours, whose circles
// find_segments() cuts and chain_loops() joins.
//
// All decisions are made in double. If one of them is doubtful (kDoubtful), or if a neighbour is
// near (kNearProbe), all are made in wide numbers instead. There the probes have slightly different
// radii, which decides ties in the same way for all patches that meet in a point.
#include "excluded/patches/concave_patch.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/monitor.hpp"
#include "excluded/patches/patch_boundary.hpp"
#include "excluded/probes/wide_probes.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kPi = std::numbers::pi;

// A decision in wide numbers is a tie if its margin is smaller: the different radii have not
// decided it.
constexpr double kTied = 1e-56;
// Squared radii of probes differ by up to this fraction of themselves: enough to show in wide
// numbers, and so little that even for probes as near as the root of `kGrowth` the plane between
// them hardly moves.
constexpr double kTieBreak = 1e-50;
// Probes nearer than this are in one place.
constexpr double kSamePlace = 1e-30;

// The exterior angle of the polygon at an atom.
double exterior_angle(const AccessibleSurface& surface, const Probe& probe, std::uint32_t atom) {
  double angle = 0;
  for (const CornerIndex c : surface.corners_of(probe)) {
    const auto& v = surface.triangle_of(c).vertices;
    for (std::size_t k = 0; k < 3; ++k) {
      if (v[k] == atom) angle += surface.shapes().turning_angle(c / 2, k);
    }
  }
  return kPi - angle;
}

// The surface around a patch, as the steps of cut_patch.hpp ask for it. Arcs that do not count are
// passed over.
class ProbesAround {
 public:
  ProbesAround(const AccessibleSurface& surface, std::span<const std::uint8_t> included,
               std::uint32_t self)
      : surface_(surface), included_(included), self_(self) {}

  double radius() const { return surface_.probe_radius; }
  std::uint32_t self() const { return self_; }
  const RolledArc& arc(std::uint32_t i) const { return surface_.arcs[i]; }
  std::uint32_t probe_at(std::uint32_t i, ArcEnd end) const {
    return arc(i).probe[static_cast<std::size_t>(end)];
  }
  std::uint32_t next_arc(std::uint32_t i, ArcEnd end) const {
    const auto side = static_cast<std::size_t>(end);
    std::uint32_t next = arc(i).beyond[side];
    while (next != i && !surface_.counts(arc(next), included_)) next = arc(next).beyond[side];
    return next;
  }
  bool is_on_circle(std::uint32_t probe, std::uint32_t i) const {
    const auto sides = surface_.sides_of(surface_.probes[probe]);
    return std::any_of(sides.begin(), sides.end(),
                       [&](const ProbeSide& s) { return arc(s.arc).edge == arc(i).edge; });
  }
  Vec3d to(std::uint32_t probe) const {
    return surface_.between(surface_.probes[self_], surface_.probes[probe]);
  }

 private:
  const AccessibleSurface& surface_;
  std::span<const std::uint8_t> included_;
  std::uint32_t self_;
};

// Steps of the golden section spread numbers evenly over [0, 1).
double tie_weight(std::uint32_t probe) {
  constexpr double kGolden = 0.6180339887498949;
  const double product = kGolden * probe;
  return kTieBreak * (product - std::floor(product));
}

WideVector scaled(const WideFloat& factor, const WideVector& v) {
  return {factor * v.x, factor * v.y, factor * v.z};
}
WideVector difference(const WideVector& a, const WideVector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

// The circles of a patch from the balls of the atoms. They are also written, rounded, to the patch.
// A probe's centre is a corner of three grown balls. The circle of a cap is in the plane that
// bisects the balls of the two probes. To break ties, the probes' radii are made slightly
// different, by their numbers. If another probe is in the same place, the patch is not certified.
class WidePatch {
 public:
  WidePatch(const AccessibleSurface& surface, ConcavePatch& patch)
      : surface_(surface),
        patch_(patch),
        p_(surface.probe_radius),
        center_(wide_corner(surface, surface.probes[patch.probe].corner)) {}

  PatchCircles<WideFloat, HeapLists> circles() {
    PatchCircles<WideFloat, HeapLists> out;
    for (PatchCap& cap : patch_.caps) out.caps.push_back(circle_of(cap));
    for (PatchSide& side : patch_.sides) out.sides.push_back(circle_of(side));
    return out;
  }

 private:
  CapCircle<WideFloat> circle_of(PatchCap& cap) {
    const WideVector apart =
        difference(wide_corner(surface_, surface_.probes[cap.probe].corner), center_);
    const WideFloat distance = root_of(WideFloat(dot(apart, apart)));
    if (distance < kSamePlace) {
      patch_.certified = false;
      return cap_circle(vector_in<WideFloat>(cap.axis), WideFloat(cap.cosine));
    }
    const WideFloat weight = p_ * p_ * (tie_weight(patch_.probe) - tie_weight(cap.probe));
    const WideVector axis = scaled(1 / distance, apart);
    const WideFloat cosine = (distance + weight / distance) / (2 * p_);
    cap.axis = to_vec(axis);
    cap.cosine = to_double(cosine);
    return cap_circle(axis, cosine);
  }

  SideCircle<WideFloat> circle_of(PatchSide& side) const {
    const RolledArc& arc = surface_.arcs[side.arc];
    const auto& balls = surface_.triangulation().balls;
    const WideCircle circle = wide_circle(balls[arc.ball[0]], balls[arc.ball[1]]);
    const WideVector inwards = difference(circle.center, center_);
    const WideVector across = cross(inwards, circle.axis);
    const WideFloat length = root_of(WideFloat(dot(across, across)));
    const bool at_end = side.end == ArcEnd::end;
    SideCircle<WideFloat> out{scaled((at_end ? 1 : -1) / length, across), {}};
    side.inward = to_vec(out.inward);
    if (!side.spindle) return out;
    const WideFloat cusp = root_of(WideFloat(p_ * p_ - circle.squared_radius));
    for (std::size_t k = 0; k < 2; ++k) {
      const std::size_t place = at_end ? k : 1 - k;  // of ball k, as in the side
      out.cusp[place] = scaled(1 / p_, combination(WideFloat(1), inwards,
                                                   k == 0 ? WideFloat(-cusp) : cusp, circle.axis));
      side.cusp[place] = to_vec(out.cusp[place]);
    }
    return out;
  }

  const AccessibleSurface& surface_;
  ConcavePatch& patch_;
  const WideFloat p_;
  const WideVector center_;
};

// The pieces of a patch from the loops of its boundary. A patch with a loop that does not close, or
// with a hole in no piece, is not certified.
class PieceMaker {
 public:
  explicit PieceMaker(ConcavePatch& patch) : patch_(patch) {}

  void run() {
    find_loops();
    std::vector<std::uint32_t> outer;  // loops, by piece
    // Without a side the patch is the whole sphere less its caps.
    if (patch_.sides.empty()) add_piece(4 * kPi, kNoIndex, outer);
    for (std::uint32_t i = 0; i < loops_.size(); ++i) {
      if (loops_[i].is_hole) continue;
      add_piece(0, i, outer);
      add_to_piece(static_cast<std::uint32_t>(outer.size() - 1), loops_[i]);
    }
    // There are holes, but no piece: a decision was wrong.
    if (outer.empty() && !loops_.empty()) {
      patch_.certified = false;
      patch_.pieces.push_back({4 * kPi, {0, 0, 0}, 0});
    }
    for (std::uint32_t i = 0; i < loops_.size(); ++i) {
      if (loops_[i].is_hole) add_to_piece(piece_around(i, outer), loops_[i]);
    }
    for (PatchSegment& s : patch_.segments) s.piece = loops_[s.piece].piece;
  }

 private:
  struct BoundaryLoop {
    double solid_angle;
    Vec3d vector;
    bool is_hole;
    std::uint32_t piece;
  };

  void find_loops() {
    Vec3d vector{0, 0, 0};
    const bool closes = chain_loops(
        patch_, [&](const PatchSegment& s) { vector = vector + segment_vector(patch_, s); },
        [&](double solid_angle, bool is_hole) {
          loops_.push_back({solid_angle, vector, is_hole, kNoIndex});
          vector = {0, 0, 0};
        });
    patch_.certified = patch_.certified && closes;
  }

  void add_piece(double solid_angle, std::uint32_t loop, std::vector<std::uint32_t>& outer) {
    patch_.pieces.push_back({solid_angle, {0, 0, 0}, 0});
    outer.push_back(loop);
  }
  void add_to_piece(std::uint32_t piece, BoundaryLoop& loop) {
    PatchPiece& p = patch_.pieces[piece];
    p.solid_angle += loop.solid_angle;
    p.vector = p.vector + loop.vector;
    ++p.loops;
    loop.piece = piece;
  }

  // The piece in which a hole is: the smallest of the pieces whose outer loop is around it.
  std::uint32_t piece_around(std::uint32_t hole, const std::vector<std::uint32_t>& outer) {
    if (outer.size() == 1) return 0;
    const Vec3d& point =
        std::find_if(patch_.segments.begin(), patch_.segments.end(), [&](const PatchSegment& s) {
          return s.piece == hole;
        })->from;
    std::uint32_t best = kNoIndex;
    for (std::uint32_t i = 0; i < outer.size(); ++i) {
      if (outer[i] != kNoIndex && !is_inside(point, outer[i])) continue;
      if (best == kNoIndex || patch_.pieces[i].solid_angle < patch_.pieces[best].solid_angle) {
        best = i;
      }
    }
    if (best == kNoIndex) patch_.certified = false;
    return best == kNoIndex ? 0 : best;
  }

  // Whether a loop is around a point. Half a great circle leads from the point, through the
  // hemisphere without the polygon, to the opposite point, which is outside of the polygon. The
  // loop is around the point if it crosses this half an odd number of times.
  bool is_inside(const Vec3d& point, std::uint32_t loop) const {
    Vec3d away{0, 0, 0};
    for (const PatchSide& s : patch_.sides) away = away - s.contact[0];
    const Vec3d toward = unit(away - dot(away, point) * point);
    bool inside = false;
    for (const PatchSegment& s : patch_.segments) {
      if (s.piece == loop) inside ^= (crossings(s, point, toward) & 1) != 0;
    }
    return inside;
  }

  // How often a segment crosses the half great circle cos(τ) point + sin(τ) toward, 0 < τ < π.
  int crossings(const PatchSegment& s, const Vec3d& point, const Vec3d& toward) const {
    const Vec3d axis = patch_.axis_of(s.circle);
    const double x = dot(axis, point), y = dot(axis, toward), size = std::hypot(x, y);
    const double ratio = patch_.cosine_of(s.circle) / size;
    if (!(std::abs(ratio) < 1)) return 0;
    int count = 0;
    for (const double sign : {-1.0, 1.0}) {
      const double tau = std::remainder(std::atan2(y, x) + sign * std::acos(ratio), 2 * kPi);
      if (tau <= 0) continue;
      const Vec3d w = std::cos(tau) * point + std::sin(tau) * toward;
      const Vec3d from = s.from - dot(s.from, axis) * axis, at = w - dot(w, axis) * axis;
      double angle = -std::atan2(triple_product(axis, from, at), dot(from, at));
      if (angle < 0) angle += 2 * kPi;
      count += angle < s.angle;
    }
    return count;
  }

  ConcavePatch& patch_;
  std::vector<BoundaryLoop> loops_;
};

}  // namespace

std::vector<PatchSide> patch_sides(const AccessibleSurface& surface, const Probe& probe) {
  std::vector<PatchSide> sides;
  for (const ProbeSide& at : surface.sides_of(probe)) {
    const RolledArc& arc = surface.arcs[at.arc];
    sides.push_back(
        patch_side(arc, at.arc, at.end, arc.ball[0], arc.ball[1], surface.probe_radius));
    sides.back().turning = exterior_angle(surface, probe, sides.back().atom[1]);
  }
  return sides;
}

ConcavePatch whole_patch(const AccessibleSurface& surface, std::uint32_t probe) {
  const Probe& p = surface.probes[probe];
  ConcavePatch patch;
  patch.probe = probe;
  patch.sides = patch_sides(surface, p);
  for (std::uint32_t s = 0; s < patch.sides.size(); ++s) {
    const PatchSide& side = patch.sides[s];
    patch.segments.push_back({kNoIndex, s, kNoIndex, 0, side.angle[0] + side.angle[1],
                              side.contact[0], side.contact[1], side.turning});
  }
  const std::uint32_t loops = patch.sides.empty() ? 0 : 1;
  patch.pieces.push_back({p.solid_angle, polygon_vector(patch.sides), loops});
  return patch;
}

Vec3d polygon_vector(const std::vector<PatchSide>& sides) {
  Vec3d sum{0, 0, 0};
  for (const PatchSide& s : sides) {
    sum = sum + (0.5 * (s.angle[0] + s.angle[1])) * s.inward;
  }
  return sum;
}

ConcavePatch concave_patch(const AccessibleSurface& surface, const LowProbes& low,
                           std::span<const std::uint8_t> included, std::uint32_t probe) {
  const ProbesAround probes(surface, included, probe);
  ConcavePatch patch;
  patch.probe = probe;
  patch.sides = patch_sides(surface, surface.probes[probe]);
  add_gap_caps(patch, probes);
  low.near(probe, [&](std::uint32_t other) { add_cap(patch, other, probes); });
  patch.certified = !cuts_itself(patch, probes);
  patch.extended = is_intricate(patch, probes);
  if (!patch.extended) {
    patch.margin = find_segments(patch, circles_in_double(patch));
    patch.extended = !(patch.margin >= kDoubtful);
  }
  if (patch.extended) {
    patch.margin = find_segments(patch, WidePatch(surface, patch).circles());
    patch.tie = !(patch.margin >= kTied);
  }
  PieceMaker(patch).run();
  return patch;
}

std::vector<ConcavePatch> cut_patches(const AccessibleSurface& surface,
                                      std::span<const std::uint8_t> included, Monitor* monitor) {
  const LowProbes low(surface, included);
  std::vector<ConcavePatch> patches(low.list().size());
  tbb::parallel_for(std::size_t{0}, patches.size(), [&](std::size_t i) {
    advance(monitor, 0);
    patches[i] = concave_patch(surface, low, included, low.list()[i]);
  });
  return patches;
}

}  // namespace vdwmesh::excluded
