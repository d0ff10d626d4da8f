// SurfaceSamples: on spheres of atoms and probes those points of a lattice that lie in the patch,
// and on saddles points at even steps of area.
//
// A concave patch is sampled as the patch of a ball is (JudgedSurface::covers_of()).
#include "excluded/distances/surface_samples.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/distances/distances_samples.hpp"

namespace vdwmesh::excluded {
namespace {

// The area of a saddle between two profile angles, divided by its turn and by the probe's radius.
double area_between(double rho, double p, double from, double to) {
  return rho * (to - from) - p * (std::sin(to) - std::sin(from));
}

// The profile angle up to which a range has this share of its area: bisection to about 1e-12 rad,
// which is far below what a sample's place has to be.
double profile_at(double rho, double p, const ProfileAngles& range, double share) {
  const double wanted = share * area_between(rho, p, range.from, range.to);
  double below = range.from, above = range.to;
  for (int step = 0; step < 42; ++step) {
    const double middle = 0.5 * (below + above);
    (area_between(rho, p, range.from, middle) < wanted ? below : above) = middle;
  }
  return 0.5 * (below + above);
}

}  // namespace

std::size_t SurfaceSamples::element_count() const {
  const AccessibleSurface& s = surface_.grown.surface;
  return contacts_.size() + s.arcs.size() + s.probes.size() + surface_.curves.size();
}

void SurfaceSamples::add(std::size_t element, std::vector<Vec3d>& inside,
                         std::vector<Vec3d>& border, const std::function<void()>& take) const {
  const Sink sink{inside, border, take};
  const AccessibleSurface& s = surface_.grown.surface;
  const Random random(seed_, element);
  if (element < contacts_.size()) return add_contact(contacts_[element], random, sink);
  element -= contacts_.size();
  if (element < s.arcs.size()) return add_saddle(s.arcs[element], random, sink);
  element -= s.arcs.size();
  if (element < s.probes.size()) {
    return add_concave(static_cast<std::uint32_t>(element), random, sink);
  }
  add_curve(surface_.curves[element - s.probes.size()], sink);
}

// Seen from the centre, the contact patch of an atom is where the exposed part of the grown ball
// is.
void SurfaceSamples::add_contact(const Patch& grown, Random random, const Sink& sink) const {
  Patch patch = grown;
  patch.ball.radius -= probe_;
  const double growth = grown.ball.radius / patch.ball.radius;
  const auto is_included = [&](const Vec3d& point) {
    const Vec3d probe = grown.ball.center + growth * (point - grown.ball.center);
    return surface_.includes_point(sphere_of_[grown.place], probe);
  };
  sample_patch(patch, density_, random, [&](const Vec3d& point) {
    if (is_included(point)) sink.add_inside(point);
  });
  for (std::uint32_t i = 0; i < patch.corner_count; ++i) {
    const Vec3d corner = patch.ball.center + patch.ball.radius * patch.corners[i].position;
    if (is_included(corner)) sink.add_border(corner);
  }
}

// The points rise by equal steps of area across the saddle, while multiples of the golden ratio
// spread them along it.
void SurfaceSamples::add_saddle(const RolledArc& arc, Random random, const Sink& sink) const {
  if (!surface_.includes(arc)) return;
  constexpr double kInverseGoldenRatio = 0.6180339887498948482;
  const double p = surface_.grown.surface.probe_radius, rho = arc.circle_radius;
  for (const ProfileAngles& range : profile_ranges(arc)) {
    if (!(range.from < range.to)) continue;
    const double area =
        surface_.unit * surface_.unit * arc.angle * p * area_between(rho, p, range.from, range.to);
    const auto count = static_cast<std::uint64_t>(std::max(area, 0.0) * density_ + random.next());
    const double shift = random.next();
    for (std::uint64_t i = 0; i < count; ++i) {
      const double along = shift + static_cast<double>(i) * kInverseGoldenRatio;
      const double across = (static_cast<double>(i) + random.next()) / static_cast<double>(count);
      const double turn = arc.angle * (along - std::floor(along));
      sink.add_inside(surface_.on_saddle(arc, turn, profile_at(rho, p, range, across)));
    }
    for (const double turn : {0.0, 0.5 * arc.angle, arc.angle}) {
      for (const double profile : {range.from, 0.5 * (range.from + range.to), range.to}) {
        sink.add_border(surface_.on_saddle(arc, turn, profile));
      }
    }
  }
}

void SurfaceSamples::add_concave(std::uint32_t probe, Random random, const Sink& sink) const {
  const AccessibleSurface& s = surface_.grown.surface;
  if (surface_.included[s.probes[probe].component] == 0) return;
  const std::vector<PatchSide> sides = surface_.sides_of(probe);
  const std::vector<Cover> covers = surface_.covers_of(probe);
  const Patch patch{{surface_.in_angstrom(s.probes[probe].center), probe_},
                    kNoPlace,
                    0,
                    static_cast<std::uint32_t>(covers.size()),
                    0,
                    covers.data(),
                    nullptr};
  sample_patch(patch, density_, random, [&](const Vec3d& point) { sink.add_inside(point); });
  Vec3d middle{0, 0, 0};
  for (const PatchSide& side : sides) middle = middle + side.contact[0];
  if (!(squared_norm(middle) > 0) || !is_exposed(patch, unit(middle))) return;
  sink.add_border(patch.ball.center + probe_ * unit(middle));
}

// √density points per Å, and the ends.
void SurfaceSamples::add_curve(const CircleArc& curve, const Sink& sink) const {
  const double length = curve.radius() * curve.sweep();
  const auto steps = static_cast<std::uint64_t>(std::ceil(length * std::sqrt(density_)));
  for (std::uint64_t i = 0; i < steps; ++i) {
    sink.add_border(curve.at(curve.sweep() * static_cast<double>(i) / static_cast<double>(steps)));
  }
  sink.add_border(curve.at(curve.sweep()));
}

}  // namespace vdwmesh::excluded
