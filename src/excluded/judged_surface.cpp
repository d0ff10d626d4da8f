// JudgedSurface: makes the concave patches that other probes cut, on all cores, and lists the arcs
// of their creases and the cusps of spindles.
#include "excluded/judged_surface.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "arrangement/directions.hpp"
#include "surface/box.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

}  // namespace

CircleArc::CircleArc(const Vec3d& center, const Vec3d& axis, const Vec3d& start, double radius,
                     double sweep)
    : center_(center), axis_(axis), start_(start), radius_(radius), sweep_(sweep) {
  const double half = sweep / 2;
  middle_ = std::cos(half) * start + std::sin(half) * cross(axis, start);
  first_ = at(0);
  last_ = at(sweep);
  // All directions belong to a whole circle, and to a point.
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

JudgedSurface::JudgedSurface(const SphereSet& atoms, double probe, Monitor* monitor)
    : grown(atoms, probe, monitor),
      unit(std::ldexp(1.0, grown.exponent)),
      cut_of(grown.surface.probes.size(), kNoIndex) {
  make_patches(monitor);
  for (const ConcavePatch& patch : cut) add_creases(patch);
  for (const RolledArc& arc : grown.surface.arcs) {
    if (arc.dropped) continue;
    if (arc.spindle) add_cusps(arc);
    const Vec3d start = arc.is_ring() ? any_orthogonal(arc.axis) : arc.radial[0];
    arcs.emplace_back(in_angstrom(arc.center), arc.axis, start, unit * arc.circle_radius,
                      arc.angle);
  }
}

void JudgedSurface::make_patches(Monitor* monitor) {
  const std::vector<std::uint8_t> all(grown.surface.components.size(), 1);
  const LowProbes low(grown.surface, all);
  cut.resize(low.list().size());
  tbb::parallel_for(std::size_t{0}, cut.size(), [&](std::size_t i) {
    advance(monitor, 0);
    cut[i] = concave_patch(grown.surface, low, all, low.list()[i]);
  });
  for (std::uint32_t i = 0; i < cut.size(); ++i) cut_of[cut[i].probe] = i;
}

bool JudgedSurface::has_certified_patch(std::uint32_t probe) const {
  return cut_of[probe] != kNoIndex && cut[cut_of[probe]].certified;
}

// Both probes of a crease have it; that of lower number adds it. If one of the two patches is not
// certified, either adds it, because the other may lack it. A segment runs clockwise about the axis
// of its cap.
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
