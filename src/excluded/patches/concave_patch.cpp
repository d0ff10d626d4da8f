// concave_patch(): the polygon of a probe's sides and the caps of its neighbours, whose circles
// find_segments() cuts and join_loops() chains.
//
// All decisions are made in double. If one of them is doubtful (kDoubtful), or if a neighbour is
// near (kNearProbe), all are made in wide numbers instead. There the probes have slightly different
// radii, which decides ties in the same way for all patches that meet in a point.
#include "excluded/patches/concave_patch.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "excluded/patches/patch_boundary.hpp"
#include "excluded/patches/patch_circles.hpp"
#include "excluded/patches/patch_loops.hpp"
#include "excluded/probes/circle_gap.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kPi = std::numbers::pi;

// A decision in double is doubtful if its margin is smaller than this. A cap's axis is wrong by
// about 1e-15 divided by the distance of the two probes, in units of the probe's radius. If that
// distance is below kNearProbe, or the radius of a side's circle is, wide numbers are used at once.
constexpr double kDoubtful = 1e-10, kNearProbe = 1e-4;
// A decision in wide numbers is a tie if its margin is smaller: the different radii have not
// decided it.
constexpr double kTied = 1e-56;

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

PatchSide patch_side(const AccessibleSurface& surface, const Probe& probe, const ProbeSide& at) {
  const RolledArc& arc = surface.arcs[at.arc];
  const double p = surface.probe_radius, rho = arc.circle_radius;
  const Profile profile = profile_of(arc);
  const Vec3d inwards = -rho * arc.radial[static_cast<std::size_t>(at.end)];
  const Vec3d tangent = cross(arc.axis, arc.radial[static_cast<std::size_t>(at.end)]);
  PatchSide side{};
  side.arc = at.arc;
  side.end = at.end;
  side.spindle = profile.spindle;
  side.gap = kNoIndex;
  side.inward = at.end == ArcEnd::end ? tangent : -1.0 * tangent;
  for (std::size_t k = 0; k < 2; ++k) {
    const std::size_t place = at.end == ArcEnd::end ? k : 1 - k;  // of ball k: from 0 to 1
    const double sign = k == 0 ? -1 : 1;
    side.atom[place] = arc.ball[k];
    side.contact[place] = unit(inwards + (sign * arc.height[k]) * arc.axis);
    side.cusp[place] = (1 / p) * (inwards + (sign * arc.cusp_height) * arc.axis);
    side.angle[place] = sign * profile.end[k] - profile.cusp;
  }
  side.turning = exterior_angle(surface, probe, side.atom[1]);
  return side;
}

bool is_on_circle(const AccessibleSurface& surface, std::uint32_t probe, std::uint32_t edge) {
  const auto sides = surface.sides_of(surface.probes[probe]);
  return std::any_of(sides.begin(), sides.end(),
                     [&](const ProbeSide& s) { return surface.arcs[s.arc].edge == edge; });
}

// The arc that follows on the same circle, across the gap at this end of an arc. Arcs that do not
// count are passed over.
std::uint32_t arc_beyond(const AccessibleSurface& surface, std::span<const std::uint8_t> included,
                         std::uint32_t arc, ArcEnd end) {
  const auto side = static_cast<std::size_t>(end);
  std::uint32_t next = surface.arcs[arc].beyond[side];
  while (next != arc && !surface.counts(surface.arcs[next], included)) {
    next = surface.arcs[next].beyond[side];
  }
  return next;
}

class PatchMaker {
 public:
  PatchMaker(const AccessibleSurface& surface, std::span<const std::uint8_t> included,
             std::uint32_t probe)
      : surface_(surface), included_(included), p_(surface.probe_radius) {
    patch_.probe = probe;
    patch_.sides = patch_sides(surface, surface.probes[probe]);
  }

  ConcavePatch make(const LowProbes& low) && {
    for (PatchSide& side : patch_.sides) {
      if (side.spindle) add_gap_cap(side);
    }
    low.near(patch_.probe, [&](std::uint32_t other) { add_cap(other); });
    patch_.extended = is_intricate();
    if (!patch_.extended) {
      patch_.margin = find_segments(patch_, circles_in_double(patch_));
      patch_.extended = patch_.margin < kDoubtful;
    }
    if (patch_.extended) {
      patch_.margin = find_segments(patch_, circles_in_wide(surface_, patch_));
      patch_.tie = patch_.margin < kTied;
    }
    join_loops(patch_);
    return std::move(patch_);
  }

 private:
  const Probe& probe() const { return surface_.probes[patch_.probe]; }
  std::uint32_t cap_count() const { return static_cast<std::uint32_t>(patch_.caps.size()); }

  // Adds the cap of the probe beyond the gap of a spindle's circle.
  void add_gap_cap(PatchSide& side) {
    const RolledArc& arc = surface_.arcs[side.arc];
    const auto end = static_cast<std::size_t>(side.end);
    const std::uint32_t next = arc_beyond(surface_, included_, side.arc, side.end);
    const std::uint32_t other = surface_.arcs[next].probe[1 - end];
    for (std::uint32_t c = 0; c < cap_count(); ++c) {
      if (patch_.caps[c].probe == other) side.gap = c;
    }
    if (side.gap != kNoIndex) return;
    const double angle =
        next == side.arc
            ? 2 * kPi - arc.angle
            : gap_angle(arc.axis, arc.radial[end], surface_.arcs[next].radial[1 - end], end == 1);
    const GapCap cap = gap_cap(angle, arc.radial[end], side.inward, arc.circle_radius, p_);
    side.gap = cap_count();
    patch_.caps.push_back({cap.axis, cap.cosine, other});
    if (other == patch_.probe) patch_.certified = false;
  }

  void add_cap(std::uint32_t other) {
    for (const PatchCap& cap : patch_.caps) {
      if (cap.probe == other) return;
    }
    for (const PatchSide& side : patch_.sides) {
      if (side.spindle && is_on_circle(surface_, other, surface_.arcs[side.arc].edge)) return;
    }
    const Vec3d apart = surface_.between(probe(), surface_.probes[other]);
    const double distance = norm(apart);
    // The cap of a probe as near as this gets its axis from wide numbers.
    const bool near = distance < kNearProbe * p_;
    const PatchCap cap{near ? Vec3d{0, 0, 1} : (1 / distance) * apart, distance / (2 * p_), other};
    if (near || (cap.cosine < 1 && may_meet_polygon(cap))) patch_.caps.push_back(cap);
  }

  // Whether wide numbers are needed from the start.
  bool is_intricate() const {
    return std::any_of(patch_.caps.begin(), patch_.caps.end(),
                       [](const PatchCap& cap) { return cap.cosine < kNearProbe; }) ||
           std::any_of(patch_.sides.begin(), patch_.sides.end(), [&](const PatchSide& side) {
             return surface_.arcs[side.arc].circle_radius < kNearProbe * p_;
           });
  }

  // Whether the cap may meet the polygon: no side has all of the cap on its outer side.
  bool may_meet_polygon(const PatchCap& cap) const {
    constexpr double kSlack = 1e-6;
    const double sine = circle_radius(cap.cosine);
    return std::none_of(patch_.sides.begin(), patch_.sides.end(), [&](const PatchSide& s) {
      return dot(cap.axis, s.inward) < -sine - kSlack;
    });
  }

  const AccessibleSurface& surface_;
  std::span<const std::uint8_t> included_;
  const double p_;
  ConcavePatch patch_;
};

}  // namespace

std::vector<PatchSide> patch_sides(const AccessibleSurface& surface, const Probe& probe) {
  std::vector<PatchSide> sides;
  for (const ProbeSide& at : surface.sides_of(probe)) {
    sides.push_back(patch_side(surface, probe, at));
  }
  return sides;
}

ConcavePatch whole_patch(const AccessibleSurface& surface, std::uint32_t probe) {
  const Probe& p = surface.probes[probe];
  ConcavePatch patch{probe, patch_sides(surface, p), {}, {}, {}};
  for (std::uint32_t s = 0; s < patch.sides.size(); ++s) {
    const PatchSide& side = patch.sides[s];
    patch.segments.push_back({kNoIndex, s, kNoIndex, 0, side.angle[0] + side.angle[1],
                              side.contact[0], side.contact[1], side.turning});
  }
  const std::uint32_t loops = patch.sides.empty() ? 0 : 1;
  patch.pieces.push_back({p.solid_angle, polygon_vector(patch.sides), loops});
  return patch;
}

namespace {

// The half-space in which cap j does not cover the flat face of cap i. In the plane of cap i, the
// inequality of plane j less that of plane i says the same as that of plane j alone. For the face
// of cap j the difference has the other sign, so both faces are cut along one line, however near
// the two planes are. If the planes are the same, the cap of lower index has the face.
HalfSpace uncovered_side(const std::vector<PatchCap>& caps, std::size_t i, std::size_t j) {
  constexpr double kSame = 1e-15;
  const HalfSpace side{caps[j].axis - caps[i].axis, caps[j].cosine - caps[i].cosine};
  if (norm(side.normal) > kSame || std::abs(side.height) > kSame) return side;
  return {{0, 0, 0}, i < j ? 1.0 : -1.0};
}

}  // namespace

double flat_faces(const ConcavePatch& patch, std::span<const HalfSpace> within) {
  std::vector<HalfSpace> walls(within.begin(), within.end());
  for (const PatchSide& s : patch.sides) walls.push_back({-1.0 * s.inward, 0});
  double sum = 0;
  for (std::size_t c = 0; c < patch.caps.size(); ++c) {
    std::vector<HalfSpace> others = walls;
    for (std::size_t j = 0; j < patch.caps.size(); ++j) {
      if (j != c) others.push_back(uncovered_side(patch.caps, c, j));
    }
    sum += patch.caps[c].cosine * face_area(patch.caps[c].axis, patch.caps[c].cosine, others);
  }
  return sum;
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
  return PatchMaker(surface, included, probe).make(low);
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
