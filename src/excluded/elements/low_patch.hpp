// The concave patch of a low probe with three balls, in double and in memory of fixed size. For the
// library's own use, on the host and on a CUDA device.
//
// A patch is not measured if there is no room for it, if a decision is close, if its boundary does
// not close, or if the shares of its balls do not sum to its solid angle.
#pragma once

#include "excluded/elements/element_shapes.hpp"
#include "excluded/patches/patch_boundary.hpp"

namespace vdwmesh::excluded::elements {

// Low probes, and for each the others that overlap it.
struct LowList {
  const std::uint32_t* corner;  // by low probe
  const std::uint64_t* first;   // size + 1
  const std::uint32_t* other;   // low probes
  std::uint32_t size;
};

// The surface around the patch of corner `self`, as the steps of cut_patch.hpp ask for it.
class CornersAround {
 public:
  VDWMESH_HD CornersAround(const Balls& balls, const ProbeCorner* corners, const Arc* arcs,
                           const ArcShape* shapes, std::uint32_t self)
      : balls_(balls), corners_(corners), arcs_(arcs), shapes_(shapes), self_(self) {}

  VDWMESH_HD double radius() const { return balls_.probe; }
  VDWMESH_HD std::uint32_t self() const { return self_; }
  VDWMESH_HD const ArcShape& arc(std::uint32_t i) const { return shapes_[i]; }
  VDWMESH_HD std::uint32_t next_arc(std::uint32_t i, ArcEnd end) const {
    return end == ArcEnd::end ? arcs_[i].next(i) : arcs_[i].previous(i);
  }
  VDWMESH_HD std::uint32_t probe_at(std::uint32_t i, ArcEnd end) const {
    return arcs_[i].corner[static_cast<int>(end)];
  }
  VDWMESH_HD bool is_on_circle(std::uint32_t probe, std::uint32_t i) const {
    const CornerName& name = corners_[probe].name;
    return touches(name, arcs_[i].ball[0]) && touches(name, arcs_[i].ball[1]);
  }
  VDWMESH_HD Vec3d to(std::uint32_t probe) const {
    const ProbeCorner &a = corners_[self_], &b = corners_[probe];
    return (balls_.grown[b.name.ball[0]].center - balls_.grown[a.name.ball[0]].center) +
           (b.at - a.at);
  }
  // Names for count_creases().
  VDWMESH_HD std::uint32_t ball(std::uint32_t atom) const { return atom; }
  VDWMESH_HD std::uint64_t number(std::uint32_t probe) const {
    return number_of(corners_[probe].name);
  }

 private:
  const Balls& balls_;
  const ProbeCorner* corners_;
  const Arc* arcs_;
  const ArcShape* shapes_;
  std::uint32_t self_;
};

// The number of the point in which the boundary of a patch goes over from circle i to circle j, of
// which one at least is a cap's: the cusp of a side, or a point of three probes.
template <class Lists, class Names>
VDWMESH_HD std::uint64_t number_of_end(const CutPatch<Lists>& patch, std::uint64_t own,
                                       const Names& names, std::uint32_t i, std::uint32_t j) {
  const std::uint32_t caps = patch.cap_count();
  if (i < caps && j < caps) {
    return number_of_point(own, names.number(patch.caps[i].probe),
                           names.number(patch.caps[j].probe), true);
  }
  const PatchSide& side = patch.sides[(i < caps ? j : i) - caps];
  return number_of_cusp(names.ball(side.atom[0]), names.ball(side.atom[1]),
                        names.ball(side.atom[i < caps ? 1 : 0]));
}

// Counts the edges and vertices of a patch in `out`, and the names of its creases. `own` is the
// number of its probe. names.ball(atom) and names.number(probe) are the names of others.
template <class Lists, class Names>
VDWMESH_HD void count_creases(const CutPatch<Lists>& patch, std::uint64_t own, const Names& names,
                              PatchMeasures& out) {
  for (const PatchSide& side : patch.sides) out.sixths -= side.spindle ? 6 : 0;
  for (const PatchSegment& s : patch.segments) {
    if (s.circle >= patch.cap_count()) continue;
    ++out.crease_arcs;
    const bool whole = s.is_whole();
    out.creases +=
        number_of_crease(own, names.number(patch.caps[s.circle].probe),
                         whole ? 0 : number_of_end(patch, own, names, s.before, s.circle),
                         whole ? 0 : number_of_end(patch, own, names, s.circle, s.next));
    if (whole) continue;
    out.sixths -= 3;
    if (s.next < patch.cap_count()) out.sixths += 2;
  }
}

// Divides the patch between its three balls. Returns whether the shares sum to the patch. (Patches
// of more balls are divided in atom_shares.cpp.)
VDWMESH_HD inline bool share_patch(const Balls& balls, const ProbeCorner& corner,
                                   const Polygon& polygon, const CutPatch<BoundedLists>& patch,
                                   PatchMeasures& out) {
  // Far more than rounding, far less than a missing part.
  constexpr double kShareError = 1e-8;
  for (const PatchSegment& s : patch.segments) {
    share_arc(balls, corner, polygon, patch.arc_of(s), out.share);
  }
  for (int i = 0; i < 3; ++i) {
    out.flat[i] = flat_faces(patch, [&](CapFace<BoundedLists>& face) {
      for (int j = 0; j < 3; ++j) {
        if (j != i) face.clip(between_contacts(balls, corner, polygon, j, i), 0);
      }
    });
  }
  const double sum = out.share[0] + out.share[1] + out.share[2];
  return std::abs(sum - out.solid_angle) < kShareError;
}

// Returns whether the patch of a low probe was measured.
VDWMESH_HD inline bool measure_patch(const Balls& balls, const ProbeCorner* corners,
                                     const Arc* arcs, const ArcShape* shapes, const LowList& low,
                                     std::uint32_t index, PatchMeasures& out) {
  const std::uint32_t self = low.corner[index];
  const CornersAround around(balls, corners, arcs, shapes, self);
  const Polygon polygon = corner_polygon(balls, corners[self], arcs, shapes);
  CutPatch<BoundedLists> patch;
  for (const PatchSide& side : polygon.side) patch.sides.push_back(side);
  add_gap_caps(patch, around);
  for (std::uint64_t i = low.first[index]; i < low.first[index + 1]; ++i) {
    add_cap(patch, low.corner[low.other[i]], around);
    if (patch.caps.is_cut_off()) return false;
  }
  if (patch.caps.is_cut_off() || is_intricate(patch, around) || cuts_itself(patch, around)) {
    return false;
  }
  if (!(find_segments(patch, circles_in_double(patch)) >= kDoubtful)) return false;
  if (patch.segments.is_cut_off()) return false;
  int loops = 0, pieces = 0;
  const bool closes = chain_loops(
      patch, [&](const PatchSegment& s) { out.vector = out.vector + segment_vector(patch, s); },
      [&](double solid_angle, bool is_hole) {
        out.solid_angle += solid_angle;
        ++loops;
        pieces += is_hole ? 0 : 1;
      });
  if (!closes || pieces == 0) return false;
  // The Euler characteristic of the faces is 2 for each piece, less 1 for each loop.
  out.sixths = 6 * (2 * pieces - loops);
  count_creases(patch, around.number(self), around, out);
  return share_patch(balls, corners[self], polygon, patch, out);
}

}  // namespace vdwmesh::excluded::elements
