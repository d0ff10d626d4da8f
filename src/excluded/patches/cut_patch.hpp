// The concave patch of a probe that others cut: its caps, and the boundary that they leave. For the
// library's own use, on the host in any number type and on a CUDA device in double.
//
// The patch is the polygon of great circles through the points of contact with the atoms, one side
// for each arc of the accessible surface that ends at the probe, less the caps that other probes
// cover. Known by construction, and not found by intersecting numbers:
// - a cap meets a side only if the side's saddle is a spindle, and then in the side's cusps;
// - of the caps of probes on the circle of such a side only that of the nearest one beyond the gap
//   in the circle matters, because the bisecting planes of all of them contain the circle's axis.
//
// Steps: add_gap_caps(), then add_cap() for each probe that overlaps; find_segments() cuts the
// circle of each cap by the other caps; chain_loops() joins the segments to loops.
#pragma once

#include "core/no_index.hpp"
#include "excluded/patches/cap_arrangement.hpp"
#include "excluded/patches/patch_sides.hpp"
#include "excluded/patches/share_formulas.hpp"

namespace vdwmesh::excluded {

// What a list of BoundedLists may hold. A patch of a probe with more than three atoms has more
// sides, and is in memory of the host alone.
inline constexpr int kMostSides = 3, kMostCaps = 28, kMostSegments = 80;

// A decision in double is doubtful if its margin is smaller than kDoubtful. A cap's axis is wrong
// by about 1e-15 divided by the distance of the two probes, in units of the probe's radius. If that
// distance is below kNearProbe, or the radius of a side's circle is, double is not enough.
inline constexpr double kDoubtful = 1e-10, kNearProbe = 1e-4;

// Circles are numbered: first the caps, then the sides. A segment of the boundary runs along one
// circle, clockwise about a cap's axis, from the circle before to the next one on the same loop.
// Segments of whole circles have kNoIndex in place of both.
struct PatchSegment {
  std::uint32_t before, circle, next;
  std::uint32_t piece;  // its loop, until the loops are joined to pieces
  double angle;
  Vec3d from, to;
  double turning;  // exterior angle at `to`; 0 on whole circles

  VDWMESH_HD bool is_whole() const { return next == kNoIndex && before == kNoIndex; }
};

template <class Lists>
struct CutPatch {
  typename Lists::template List<PatchSide, kMostSides> sides;
  typename Lists::template List<PatchCap, kMostCaps> caps;
  typename Lists::template List<PatchSegment, kMostSegments> segments;

  VDWMESH_HD std::uint32_t cap_count() const { return static_cast<std::uint32_t>(caps.size()); }
  VDWMESH_HD Vec3d axis_of(std::uint32_t circle) const {
    return circle < cap_count() ? caps[circle].axis : -1.0 * sides[circle - cap_count()].inward;
  }
  VDWMESH_HD double cosine_of(std::uint32_t circle) const {
    return circle < cap_count() ? caps[circle].cosine : 0;
  }
  VDWMESH_HD SphereArc arc_of(const PatchSegment& s) const {
    if (s.circle < cap_count()) return {axis_of(s.circle), cosine_of(s.circle), s.from, -s.angle};
    return {sides[s.circle - cap_count()].inward, 0, s.from, s.angle};
  }
};

// Adds the caps of the probes beyond the gaps of spindles. `probes` tells of the surface around the
// patch: radius(), self(), arc(i), the shape of an arc; next_arc(i, end), the arc that follows on
// its circle; probe_at(i, end); is_on_circle(probe, i), whether a probe is on the circle of an arc;
// to(probe), the vector from the patch's probe to it.
template <class Lists, class Probes>
VDWMESH_HD void add_gap_caps(CutPatch<Lists>& patch, const Probes& probes) {
  for (PatchSide& side : patch.sides) {
    if (!side.spindle) continue;
    const auto end = static_cast<std::size_t>(side.end);
    const ArcEnd opposite = side.end == ArcEnd::end ? ArcEnd::start : ArcEnd::end;
    const ArcShape& arc = probes.arc(side.arc);
    const std::uint32_t next = probes.next_arc(side.arc, side.end);
    const std::uint32_t other = probes.probe_at(next, opposite);
    for (std::uint32_t c = 0; c < patch.cap_count(); ++c) {
      if (patch.caps[c].probe == other) side.gap = c;
    }
    if (side.gap != kNoIndex) continue;
    const double angle = next == side.arc ? 2 * std::numbers::pi - arc.angle
                                          : gap_angle(arc.axis, arc.radial[end],
                                                      probes.arc(next).radial[1 - end], end == 1);
    side.gap = patch.cap_count();
    patch.caps.push_back(
        gap_cap(angle, arc.radial[end], side.inward, arc.circle_radius, probes.radius(), other));
  }
}

// Adds the cap of a probe that overlaps the patch's own one, if it may meet the polygon: no side
// has all of the cap on its outer side. Precondition: the caps beyond gaps are there. The cap of a
// probe that is near has no axis yet.
template <class Lists, class Probes>
VDWMESH_HD void add_cap(CutPatch<Lists>& patch, std::uint32_t other, const Probes& probes) {
  for (const PatchCap& cap : patch.caps) {
    if (cap.probe == other) return;
  }
  for (const PatchSide& side : patch.sides) {
    if (side.spindle && probes.is_on_circle(other, side.arc)) return;
  }
  const double p = probes.radius();
  const Vec3d apart = probes.to(other);
  const double distance = norm(apart), cosine = distance / (2 * p);
  if (distance < kNearProbe * p) {
    patch.caps.push_back({{0, 0, 1}, cosine, other});
    return;
  }
  if (!(cosine < 1)) return;
  const Vec3d axis = (1 / distance) * apart;
  constexpr double kSlack = 1e-6;
  const double sine = circle_radius(cosine);
  for (const PatchSide& side : patch.sides) {
    if (dot(axis, side.inward) < -sine - kSlack) return;
  }
  patch.caps.push_back({axis, cosine, other});
}

// Whether double is not enough from the start.
template <class Lists, class Probes>
VDWMESH_HD bool is_intricate(const CutPatch<Lists>& patch, const Probes& probes) {
  for (const PatchCap& cap : patch.caps) {
    if (cap.cosine < kNearProbe) return true;
  }
  for (const PatchSide& side : patch.sides) {
    if (probes.arc(side.arc).circle_radius < kNearProbe * probes.radius()) return true;
  }
  return false;
}

// Whether a patch has a cap of its own probe. Then its boundary does not close.
template <class Lists, class Probes>
VDWMESH_HD bool cuts_itself(const CutPatch<Lists>& patch, const Probes& probes) {
  for (const PatchCap& cap : patch.caps) {
    if (cap.probe == probes.self()) return true;
  }
  return false;
}

// Sum over the caps of cosine × area of the cap's flat face, in the cone of the probe over its
// patch and in further half-spaces, which clip_others(face) clips: three times the volume of the
// cones over the faces.
//
// In the plane of cap i, the inequality of plane j less that of plane i says the same as that of
// plane j alone. For the face of cap j the difference has the other sign, so both faces are cut
// along one line, however near the two planes are. If the planes are the same, the cap of lower
// index has the face.
template <class Lists, class ClipOthers>
VDWMESH_HD double flat_faces(const CutPatch<Lists>& patch, const ClipOthers& clip_others) {
  constexpr double kSame = 1e-15;
  double sum = 0;
  const std::uint32_t count = patch.cap_count();
  for (std::uint32_t c = 0; c < count; ++c) {
    const PatchCap& cap = patch.caps[c];
    CapFace<Lists> face(cap.axis, cap.cosine);
    clip_others(face);
    for (const PatchSide& side : patch.sides) face.clip(-1.0 * side.inward, 0);
    for (std::uint32_t j = 0; j < count && !face.is_empty(); ++j) {
      if (j == c) continue;
      const Vec3d normal = patch.caps[j].axis - cap.axis;
      const double height = patch.caps[j].cosine - cap.cosine;
      if (std::abs(height) > kSame || norm(normal) > kSame) {
        face.clip(normal, height);
      } else {
        face.clip({0, 0, 0}, c < j ? 1.0 : -1.0);
      }
    }
    sum += cap.cosine * face.area();
  }
  return sum;
}

template <class T>
struct SideCircle {
  Vector<T> inward;               // as PatchSide
  std::array<Vector<T>, 2> cusp;  // of a spindle
};

// The circles of a patch in any number type, in the order of its caps and sides.
template <class T, class Lists>
struct PatchCircles {
  typename Lists::template List<CapCircle<T>, kMostCaps> caps;
  typename Lists::template List<SideCircle<T>, kMostSides> sides;
};

template <class Lists>
VDWMESH_HD PatchCircles<double, Lists> circles_in_double(const CutPatch<Lists>& patch) {
  PatchCircles<double, Lists> out;
  for (const PatchCap& cap : patch.caps) {
    out.caps.push_back(cap_circle(vector_in<double>(cap.axis), cap.cosine));
  }
  for (const PatchSide& side : patch.sides) {
    out.sides.push_back({vector_in<double>(side.inward),
                         {vector_in<double>(side.cusp[0]), vector_in<double>(side.cusp[1])}});
  }
  return out;
}

}  // namespace vdwmesh::excluded
