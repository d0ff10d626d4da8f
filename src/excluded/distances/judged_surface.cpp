// JudgedSurface: makes the concave patches that other probes cut, on all cores, and lists the arcs
// of their creases and the cusps of spindles.
//
// The exposed pieces of one ball may belong to different components. Which piece has a given point
// follows from the arcs around all of them: the point is in the piece that the nearest arc borders,
// because the shortest way to it on the sphere crosses no arc. Arcs are compared by chords, whose
// lengths rise with those of the ways.
#include "excluded/distances/judged_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "spheres/box.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

std::vector<std::uint8_t> components_of(const AccessibleSurface& surface, ExcludedPart part) {
  if (part == ExcludedPart::exterior) return surface.outer_components();
  return std::vector<std::uint8_t>(surface.components.size(), 1);
}

// The direction of the probe at the start of an arc, from the centre of its circle.
Vec3d start_of(const RolledArc& arc) {
  return arc.is_ring() ? any_orthogonal(arc.axis) : arc.radial[0];
}

}  // namespace

std::vector<ProfileAngles> profile_ranges(const RolledArc& arc) {
  const Profile profile = profile_of(arc);
  if (!profile.spindle) return {{profile.end[0], profile.end[1]}};
  return {{profile.end[0], -profile.cusp}, {profile.cusp, profile.end[1]}};
}

CircleArc::CircleArc(const Vec3d& center, const Vec3d& axis, const Vec3d& start, double radius,
                     double sweep)
    : center_(center), axis_(axis), start_(start), radius_(radius), sweep_(sweep) {
  const double half = sweep / 2;
  middle_ = std::cos(half) * start + std::sin(half) * cross(axis, start);
  first_ = at(0);
  last_ = at(sweep);
  // With -2, faces() holds for every direction: on a whole circle, and on a cusp, of radius 0.
  least_cosine_ = is_whole() || radius == 0 ? -2 : std::cos(half);
}

Vec3d CircleArc::at(double angle) const {
  return center_ + radius_ * (std::cos(angle) * start_ + std::sin(angle) * cross(axis_, start_));
}

bool CircleArc::is_whole() const { return sweep_ >= kTurn; }

bool CircleArc::faces(const Vec3d& radial) const {
  return dot(radial, middle_) >= least_cosine_ * norm(radial);
}

// The nearest point of the circle, if it is on the arc; otherwise the nearer end.
double CircleArc::squared_distance(const Vec3d& point) const {
  const Vec3d from = point - center_;
  const double height = dot(from, axis_);
  const Vec3d radial = from - height * axis_;
  if (faces(radial)) {
    const double out = norm(radial) - radius_;
    return height * height + out * out;
  }
  return std::min(squared_norm(point - first_), squared_norm(point - last_));
}

Vec3d CircleArc::nearest_point(const Vec3d& point) const {
  const Vec3d from = point - center_;
  const Vec3d radial = from - dot(from, axis_) * axis_;
  const double length = norm(radial);
  if (!faces(radial)) {
    return squared_norm(point - first_) < squared_norm(point - last_) ? first_ : last_;
  }
  // From the axis all points are equally near.
  return length > 0 ? center_ + (radius_ / length) * radial : center_ + radius_ * middle_;
}

// An arc of less than half a turn is within its sagitta of the chord.
Box CircleArc::box() const {
  if (sweep_ >= kTurn / 2) return vdwmesh::box_of(Sphere{center_, radius_});
  const double sagitta = radius_ * (1 - std::cos(sweep_ / 2));
  Box box = vdwmesh::box_of(Sphere{first_, sagitta});
  include(box, vdwmesh::box_of(Sphere{last_, sagitta}));
  return box;
}

JudgedSurface::JudgedSurface(const SphereSet& atoms, double probe, ExcludedPart part,
                             Monitor* monitor)
    : grown(atoms, probe, monitor),
      unit(std::ldexp(1.0, grown.exponent)),
      included(components_of(grown.surface, part)),
      cut(cut_patches(grown.surface, included, monitor)),
      cut_of(grown.surface.probes.size(), kNoIndex) {
  for (std::uint32_t i = 0; i < cut.size(); ++i) cut_of[cut[i].probe] = i;
  for (const ConcavePatch& patch : cut) add_creases(patch);
  for (const RolledArc& arc : grown.surface.arcs) {
    if (!includes(arc)) continue;
    if (arc.spindle) add_cusps(arc);
    arcs.push_back(in_place(arc));
  }
  for (const Probe& held : grown.surface.probes) {
    if (held.side_count == 0 && included[held.component] != 0) arcs.push_back(place_of(held));
  }
  if (std::ranges::find(included, 0) != included.end()) classify_balls();
}

CircleArc JudgedSurface::in_place(const RolledArc& arc) const {
  return {in_angstrom(arc.center), arc.axis, start_of(arc), unit * arc.circle_radius, arc.angle};
}

CircleArc JudgedSurface::place_of(const Probe& held) const {
  return {in_angstrom(held.center), {0, 0, 1}, {1, 0, 0}, 0, kTurn};
}

void JudgedSurface::classify_balls() {
  const AccessibleSurface& s = grown.surface;
  std::vector<std::array<bool, 2>> has(grown.triangulation.balls.size(), {false, false});
  for (const ContactPiece& piece : s.contacts) has[piece.ball][included[piece.component]] = true;
  std::size_t spheres = 0;
  for (const SphereId id : grown.triangulation.ids)
    spheres = std::max<std::size_t>(spheres, id + 1);
  pieces_.assign(spheres, Pieces::none_included);
  for (std::size_t ball = 0; ball < has.size(); ++ball) {
    if (!has[ball][1]) continue;
    pieces_[grown.triangulation.ids[ball]] =
        has[ball][0] ? Pieces::some_included : Pieces::all_included;
  }
  const auto add_border = [&](std::uint32_t ball, const CircleArc& arc, bool is_included) {
    const SphereId id = grown.triangulation.ids[ball];
    if (pieces_[id] == Pieces::some_included) borders_[id].push_back({arc, is_included});
  };
  for (const RolledArc& arc : s.arcs) {
    if (arc.dropped) continue;
    for (const std::uint32_t ball : arc.ball) add_border(ball, in_place(arc), includes(arc));
  }
  for (const Probe& held : s.probes) {
    if (held.side_count > 0) continue;
    for (const CornerIndex c : s.corners_of(held)) {
      for (const std::uint32_t ball : s.triangle_of(c).vertices) {
        add_border(ball, place_of(held), included[held.component] != 0);
      }
    }
  }
}

bool JudgedSurface::includes_point(SphereId sphere, const Vec3d& point) const {
  if (includes_all()) return true;
  if (sphere >= pieces_.size() || pieces_[sphere] == Pieces::none_included) return false;
  const auto borders = borders_.find(sphere);
  if (borders == borders_.end()) return true;
  double nearest = std::numeric_limits<double>::infinity();
  bool is_included = true;
  for (const Border& border : borders->second) {
    const double squared = border.arc.squared_distance(point);
    if (!(squared < nearest)) continue;
    nearest = squared;
    is_included = border.included;
  }
  return is_included;
}

// The way to an exposed point of an included piece crosses an arc of that piece, if it begins
// outside of the piece.
bool JudgedSurface::may_include(SphereId sphere, const Vec3d& point, double reach) const {
  if (includes_point(sphere, point)) return true;
  const auto borders = borders_.find(sphere);
  return borders != borders_.end() &&
         std::ranges::any_of(borders->second, [&](const Border& border) {
           return border.included && border.arc.squared_distance(point) <= reach * reach;
         });
}

std::vector<PatchSide> JudgedSurface::sides_of(std::uint32_t probe) const {
  return cut_of[probe] != kNoIndex ? cut[cut_of[probe]].sides
                                   : patch_sides(grown.surface, grown.surface.probes[probe]);
}

// Probes are in no cell list.
std::vector<Cover> JudgedSurface::covers_of(std::uint32_t probe) const {
  std::vector<Cover> covers;
  for (const PatchSide& side : sides_of(probe)) {
    covers.push_back({{-1.0 * side.inward, 0}, kNoPlace});
  }
  if (cut_of[probe] == kNoIndex) return covers;
  for (const PatchCap& cap : cut[cut_of[probe]].caps) {
    covers.push_back({{cap.axis, cap.cosine}, kNoPlace});
  }
  return covers;
}

Vec3d JudgedSurface::on_saddle(const RolledArc& arc, double turn, double profile) const {
  const double p = grown.surface.probe_radius;
  const Vec3d start = start_of(arc);
  const Vec3d radial = std::cos(turn) * start + std::sin(turn) * cross(arc.axis, start);
  return in_angstrom(arc.center + (arc.circle_radius - p * std::cos(profile)) * radial +
                     (p * std::sin(profile)) * arc.axis);
}

bool JudgedSurface::has_certified_patch(std::uint32_t probe) const {
  return cut_of[probe] != kNoIndex && cut[cut_of[probe]].certified;
}

// Both probes of a crease have it; the one of lower number adds it. If one of the two patches is
// not certified, both add it, because one may lack it; a curve that is there twice does no harm.
// Segments of a patch's sides are no creases. A segment runs clockwise about the axis of its cap.
void JudgedSurface::add_creases(const ConcavePatch& patch) {
  const double p = unit * grown.surface.probe_radius;
  for (const PatchSegment& s : patch.segments) {
    if (s.circle >= patch.caps.size()) continue;
    const PatchCap& cap = patch.caps[s.circle];
    if (cap.probe < patch.probe && patch.certified && has_certified_patch(cap.probe)) continue;
    const Vec3d center = in_angstrom(grown.surface.probes[patch.probe].center);
    const Vec3d radial = s.from - dot(s.from, cap.axis) * cap.axis;
    if (!(squared_norm(radial) > 0)) continue;
    const bool whole = s.next == kNoIndex;
    curves.emplace_back(center + (p * cap.cosine) * cap.axis, -1.0 * cap.axis,
                        vdwmesh::unit(radial), p * std::sqrt((1 - cap.cosine) * (1 + cap.cosine)),
                        whole ? kTurn : s.angle);
  }
}

void JudgedSurface::add_cusps(const RolledArc& arc) {
  for (const double side : {-1.0, 1.0}) {
    const Vec3d at = in_angstrom(arc.center + (side * arc.cusp_height) * arc.axis);
    curves.emplace_back(at, arc.axis, any_orthogonal(arc.axis), 0, kTurn);
  }
}

}  // namespace vdwmesh::excluded
