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

Vec3d SharpCurve::at(double angle) const {
  return center + radius * (std::cos(angle) * start + std::sin(angle) * cross(axis, start));
}

bool SharpCurve::is_whole() const { return sweep >= kTurn; }

// The nearest point of the circle, if it is on the arc; otherwise the nearer end.
double squared_distance(const SharpCurve& curve, const Vec3d& point) {
  const Vec3d from = point - curve.center;
  const double height = dot(from, curve.axis);
  const Vec3d radial = from - height * curve.axis;
  double angle = std::atan2(dot(cross(curve.axis, curve.start), radial), dot(curve.start, radial));
  if (angle < 0) angle += kTurn;
  if (angle <= curve.sweep || curve.is_whole() || curve.radius == 0) {
    const double out = norm(radial) - curve.radius;
    return height * height + out * out;
  }
  return std::min(squared_norm(point - curve.at(0)), squared_norm(point - curve.at(curve.sweep)));
}

// An arc of less than half a turn is within its sagitta of the chord.
Box box_of(const SharpCurve& curve) {
  if (curve.sweep >= kTurn / 2) return vdwmesh::box_of(Sphere{curve.center, curve.radius});
  const double sagitta = curve.radius * (1 - std::cos(curve.sweep / 2));
  Box box = vdwmesh::box_of(Sphere{curve.at(0), sagitta});
  include(box, vdwmesh::box_of(Sphere{curve.at(curve.sweep), sagitta}));
  return box;
}

JudgedSurface::JudgedSurface(const SphereSet& atoms, double probe, Monitor* monitor)
    : grown(atoms, probe, monitor),
      unit(std::ldexp(1.0, grown.exponent)),
      cut_of(grown.surface.probes.size(), kNoIndex) {
  make_patches(monitor);
  for (const ConcavePatch& patch : cut) add_creases(patch);
  for (const RolledArc& arc : grown.surface.arcs) {
    if (arc.spindle && !arc.dropped) add_cusps(arc);
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
    curves.push_back({center + (p * cap.cosine) * cap.axis, -1.0 * cap.axis, vdwmesh::unit(radial),
                      p * std::sqrt((1 - cap.cosine) * (1 + cap.cosine)), whole ? kTurn : s.angle});
  }
}

void JudgedSurface::add_cusps(const RolledArc& arc) {
  for (const double side : {-1.0, 1.0}) {
    const Vec3d at = in_angstrom(arc.center + (side * arc.cusp_height) * arc.axis);
    curves.push_back({at, arc.axis, any_orthogonal(arc.axis), 0, kTurn});
  }
}

}  // namespace vdwmesh::excluded
