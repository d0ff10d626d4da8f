// SideSampler: patches of spheres from the edges of the dual complex and from the sides of probes,
// saddles from the arcs on which the probe rolls.
#include "interface/side_samples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "analysis/distances/sphere_lattice.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/directions.hpp"

namespace vdwmesh {

using excluded::AccessibleSurface;
using excluded::ProfileAngles;
using excluded::RolledArc;

namespace {

// Rings are narrower than the distance of samples, because their parts in a patch are measured in
// the middle of the ring.
constexpr double kRingsPerSample = 1.5;

constexpr double kInverseGoldenRatio = 0.6180339887498948482;

double fraction(double x) { return x - std::floor(x); }

std::uint64_t count_for(double area, double density) {
  return static_cast<std::uint64_t>(std::max(1.0, std::round(area * density)));
}

// Patches smaller than this, Å², are rounding.
constexpr double kLeastArea = 1e-9;

constexpr std::size_t kTogether = 64;  // patches of a block

std::uint32_t size_of(std::size_t size) { return static_cast<std::uint32_t>(size); }

}  // namespace

// Part of a ring about the axis of a sphere of radius 1.
struct SideSampler::Part {
  double height, radius;
  AngleRange range;
  double area;  // Å²
};

// How one set of samples differs from others.
struct SideSampler::Placement {
  explicit Placement(Random random)
      : turn(random), ring(random.next()), along(random.next()), across(random.next()) {}

  RandomRotation turn;
  double ring, along, across;  // shifts, of 1
};

SideSampler::SideSampler(const SphereSet& own, const CellListView& others, const AxesSource& axes,
                         double probe, double rim, Monitor* monitor)
    : grown_(excluded::grown_by(own, probe)),
      surface_(own, probe, ExcludedPart::complete, monitor),
      others_(others),
      axes_(axes),
      probe_(probe),
      rim_(rim),
      neighbors_(surface_.grown.triangulation.balls.size()) {
  const AccessibleSurface& s = surface_.grown.surface;
  for (const DualEdge& edge : s.complex().edges) {
    neighbors_[edge.vertices[0]].push_back(edge.vertices[1]);
    neighbors_[edge.vertices[1]].push_back(edge.vertices[0]);
  }
  const std::size_t balls = neighbors_.size();
  const auto add_sphere = [&](std::size_t i, std::vector<SpherePatch>& found) {
    i < balls ? add_contact(size_of(i), found) : add_concave(size_of(i - balls), found);
  };
  spheres_ = collect<SpherePatch>(balls + s.probes.size(), add_sphere, monitor, kTogether);
  const auto add_tube = [&](std::size_t i, std::vector<Saddle>& found) {
    add_saddle(s.arcs[i], found);
  };
  saddles_ = collect<Saddle>(s.arcs.size(), add_tube, monitor, kTogether);
  const std::size_t spheres = spheres_.size();
  const auto add_points = [&](std::size_t i, std::vector<Vec3d>& found) {
    i < spheres ? add_border(spheres_[i], found) : add_border(saddles_[i - spheres], found);
  };
  border_ = collect<Vec3d>(spheres + saddles_.size(), add_points, monitor, kTogether);
}

// A buried point is within a probe's diameter of a grown atom of the other side, less its radius.
bool SideSampler::is_near(const Vec3d& place, double reach) const {
  const Vec3d wide{reach, reach, reach};
  return visit_near_box(others_, place - wide, place + wide, [&](ListPlace i) {
    const double sum = reach + others_.spheres[i].radius;
    return squared_norm(others_.spheres[i].center - place) < sum * sum;
  });
}

void SideSampler::add_contact(std::uint32_t ball, std::vector<SpherePatch>& found) const {
  const std::vector<SphereId>& ids = surface_.grown.triangulation.ids;
  const Sphere& own = grown_[ids[ball]];
  if (surface_.grown.complex.exposed[ball] == 0 || !is_near(own.center, own.radius + rim_)) return;
  SpherePatch patch{.sphere = {own.center, own.radius - probe_},
                    .outward = 1,
                    .axes = axes_.at(own.center),
                    .covers = {},
                    .others = {},
                    .all_buried = false};
  arcs::Cap cap{};
  for (const std::uint32_t neighbor : neighbors_[ball])
    if (arcs::make_cap(own, grown_[ids[neighbor]], cap) == arcs::CapKind::cuts)
      patch.covers.push_back(cap);
  const Vec3d wide{own.radius, own.radius, own.radius};
  visit_near_box(others_, own.center - wide, own.center + wide, [&](ListPlace i) {
    const arcs::CapKind kind = arcs::make_cap(own, others_.spheres[i], cap);
    if (kind == arcs::CapKind::cuts) patch.others.push_back(cap);
    patch.all_buried = patch.all_buried || kind == arcs::CapKind::buries;
    return patch.all_buried;
  });
  found.push_back(std::move(patch));
}

void SideSampler::add_concave(std::uint32_t probe, std::vector<SpherePatch>& found) const {
  const excluded::Probe& at = surface_.grown.surface.probes[probe];
  const Vec3d center = surface_.in_angstrom(at.center);
  if (!is_near(center, 2 * probe_ + rim_)) return;
  SpherePatch patch{.sphere = {center, probe_},
                    .outward = -1,
                    .axes = axes_.at(center),
                    .covers = {},
                    .others = {},
                    .all_buried = is_near(center, 0)};
  for (const Cover& cover : surface_.covers_of(probe)) patch.covers.push_back(cover.cap);
  found.push_back(std::move(patch));
}

// Turns begin at the arc's first end, or where an axis says on a whole circle.
void SideSampler::add_saddle(const RolledArc& arc, std::vector<Saddle>& found) const {
  const Vec3d center = surface_.in_angstrom(arc.center);
  const double rho = surface_.unit * arc.circle_radius;
  if (!surface_.includes(arc) || !is_near(center, rho + 2 * probe_ + rim_)) return;
  const TurningAxes axes = axes_.at(center);
  const Vec3d first = arc.is_ring() ? axes.across(arc.axis) : arc.radial[0];
  const Vec3d second = cross(arc.axis, first);
  const double middle = arc.is_ring() ? 0 : arc.angle / 2;
  const Vec3d onwards = std::cos(middle) * second - std::sin(middle) * first;
  Saddle saddle{.center = center,
                .axis = arc.axis,
                .first = first,
                .second = second,
                .circle_radius = rho,
                .angle = arc.angle,
                .profile = excluded::profile_ranges(arc),
                .turns_back = axes.opposes(onwards),
                .falls = axes.opposes(arc.axis),
                .buried = {}};
  const Vec3d wide{rho, rho, rho};
  visit_near_box(others_, center - wide, center + wide, [&](ListPlace i) {
    const Vec3d to = others_.spheres[i].center - center;
    const double radius = others_.spheres[i].radius;
    const double least = 0.5 * (rho * rho + squared_norm(to) - radius * radius);
    saddle.buried.add(tilted_cap(first, second, arc.axis, to, least), 0, rho);
    return false;
  });
  saddle.buried.join();
  found.push_back(std::move(saddle));
}

Vec3d SideSampler::on_tube(const Saddle& saddle, double turn, double profile) const {
  const Vec3d radial = std::cos(turn) * saddle.first + std::sin(turn) * saddle.second;
  return saddle.center + (saddle.circle_radius - probe_ * std::cos(profile)) * radial +
         (probe_ * std::sin(profile)) * saddle.axis;
}

SurfacePlace SideSampler::nearest_on(std::uint32_t patch, const Vec3d& place) const {
  if (patch < spheres_.size()) {
    const auto& [center, radius] = spheres_[patch].sphere;
    const Vec3d outward = unit(place - center);
    return {center + radius * outward, spheres_[patch].outward * outward};
  }
  const Saddle& saddle = saddles_[patch - spheres_.size()];
  const Vec3d from = place - saddle.center;
  const Vec3d radial = unit(from - dot(from, saddle.axis) * saddle.axis);
  const Vec3d center = saddle.center + saddle.circle_radius * radial;
  const Vec3d inward = unit(place - center);
  return {center + probe_ * inward, -1.0 * inward};
}

bool SideSampler::holds(std::uint32_t patch, const Vec3d& point) const {
  constexpr double kSlack = 1e-9;
  if (patch < spheres_.size()) {
    const SpherePatch& part = spheres_[patch];
    const Vec3d out = (1 / part.sphere.radius) * (point - part.sphere.center);
    return std::ranges::none_of(part.covers, [&](const arcs::Cap& cap) {
      return arcs::inner(cap.axis, out) > cap.cosine + kSlack;
    });
  }
  const Saddle& saddle = saddles_[patch - spheres_.size()];
  const Vec3d from = point - saddle.center;
  const double x = arcs::inner(from, saddle.first), y = arcs::inner(from, saddle.second);
  const double turn = std::atan2(y, x),
               whole = turn < -kSlack ? turn + CoveredAngles::kWhole : turn;
  if (whole > saddle.angle + kSlack) return false;
  const double profile =
      std::atan2(arcs::inner(from, saddle.axis), saddle.circle_radius - std::sqrt(x * x + y * y));
  return std::ranges::any_of(saddle.profile, [&](const ProfileAngles& range) {
    return profile >= range.from - kSlack && profile <= range.to + kSlack;
  });
}

// On the circle of each cap of the other side, what no other cap covers. The points are in the
// middle of equal steps, so that they do not say where the circle begins.
void SideSampler::add_border(const SpherePatch& patch, std::vector<Vec3d>& border) const {
  if (patch.all_buried || patch.others.empty()) return;
  CoveredAngles cover;
  for (const arcs::Cap& cap : patch.others) {
    const double radius = std::sqrt((1 - cap.cosine) * (1 + cap.cosine));
    const Vec3d first = patch.axes.across(cap.axis), second = cross(cap.axis, first);
    cover.clear();
    for (const auto* caps : {&patch.covers, &patch.others}) {
      for (const arcs::Cap& other : *caps) {
        if (&other == &cap) continue;
        cover.add(tilted_cap(first, second, cap.axis, other.axis, other.cosine), cap.cosine,
                  radius);
      }
    }
    cover.join();
    cover.each_part({0, CoveredAngles::kWhole}, [&](const AngleRange& part, bool is_covered) {
      if (is_covered) return;
      const double length = (part.to - part.from) * radius * patch.sphere.radius;
      const double count = std::ceil(length / kBorderStep);
      for (double k = 0; k < count; ++k) {
        const double at = part.from + (k + 0.5) / count * (part.to - part.from);
        const Vec3d out =
            cap.cosine * cap.axis + radius * (std::cos(at) * first + std::sin(at) * second);
        border.push_back(patch.sphere.center + patch.sphere.radius * out);
      }
    });
  }
}

void SideSampler::add_border(const Saddle& saddle, std::vector<Vec3d>& border) const {
  saddle.buried.each_part({0, saddle.angle}, [&](const AngleRange& part, bool is_covered) {
    if (!is_covered) return;
    for (const double turn : {part.from, part.to}) {
      if (turn <= 0 || turn >= saddle.angle) continue;
      for (const auto& [from, to] : saddle.profile) {
        const double count = std::ceil(std::max(0.0, to - from) * probe_ / kBorderStep);
        for (double k = 0; k < count; ++k)
          border.push_back(on_tube(saddle, turn, from + (k + 0.5) / count * (to - from)));
      }
    }
  });
}

std::vector<PatchSample> SideSampler::samples(double density, std::uint64_t seed) const {
  const Placement placement(Random(seed, 0));
  const std::size_t spheres = spheres_.size();
  const auto add = [&](std::size_t i, std::vector<PatchSample>& found) {
    i < spheres ? sample_sphere(size_of(i), density, placement, found)
                : sample_saddle(size_of(i), density, placement, found);
  };
  return collect<PatchSample>(spheres + saddles_.size(), add, nullptr, kTogether);
}

// The parts of rings that are in a patch, open ones and buried ones. The rings are of equal width,
// and the first one ends at a random angle.
std::array<std::vector<SideSampler::Part>, 2> SideSampler::parts_of(
    const SpherePatch& patch, const std::array<Vec3d, 3>& axes, double density,
    double shift) const {
  const double r = patch.sphere.radius;
  const auto tilted = [&](const std::vector<arcs::Cap>& caps) {
    std::vector<TiltedCap> seen;
    for (const arcs::Cap& cap : caps)
      seen.push_back(tilted_cap(axes[0], axes[1], axes[2], cap.axis, cap.cosine));
    return seen;
  };
  const std::vector<TiltedCap> covers = tilted(patch.covers), others = tilted(patch.others);
  std::array<std::vector<Part>, 2> parts;
  CoveredAngles cover, buried;
  const double rings = std::ceil(std::numbers::pi * r * std::sqrt(density) * kRingsPerSample);
  double upper = 1;
  for (double k = 0; k <= rings; ++k) {
    const double angle = std::min(k + shift, rings) / rings * std::numbers::pi;
    const double lower = std::cos(angle), height = 0.5 * (upper + lower), wide = upper - lower;
    const double radius = std::sqrt((1 - height) * (1 + height));
    upper = lower;
    cover.set(covers, height, radius);
    buried.set(others, height, radius);
    const auto add = [&](const AngleRange& range, bool is_buried) {
      parts[is_buried].push_back({height, radius, range, r * r * wide * (range.to - range.from)});
    };
    cover.each_part({0, CoveredAngles::kWhole}, [&](const AngleRange& part, bool is_covered) {
      if (is_covered) return;
      patch.all_buried ? add(part, true) : buried.each_part(part, add);
    });
  }
  return parts;
}

// Points follow each other along the parts at equal steps of area.
void SideSampler::sample_sphere(std::uint32_t number, double density, const Placement& placement,
                                std::vector<PatchSample>& found) const {
  const SpherePatch& patch = spheres_[number];
  const std::array<Vec3d, 3> axes{patch.axes.in_space(placement.turn({1, 0, 0})),
                                  patch.axes.in_space(placement.turn({0, 1, 0})),
                                  patch.axes.in_space(placement.turn({0, 0, 1}))};
  const auto parts = parts_of(patch, axes, density, placement.ring);
  for (const bool is_buried : {false, true}) {
    double area = 0;
    for (const Part& part : parts[is_buried]) area += part.area;
    if (!(area > kLeastArea)) continue;
    const double step = area / static_cast<double>(count_for(area, density));
    double next = placement.along * step;  // from where the part begins
    for (const auto& [height, radius, range, part_area] : parts[is_buried]) {
      for (; next < part_area; next += step) {
        const double at = range.from + next / part_area * (range.to - range.from);
        const Vec3d out =
            height * axes[2] + radius * (std::cos(at) * axes[0] + std::sin(at) * axes[1]);
        found.push_back({.point = patch.sphere.center + patch.sphere.radius * out,
                         .normal = patch.outward * out,
                         .weight = step,
                         .patch = number,
                         .is_buried = is_buried});
      }
      next -= part_area;
    }
  }
}

// Samples rise by equal steps across the saddle, while multiples of the golden ratio spread them
// along it. Each has the area of its step.
void SideSampler::sample_saddle(std::uint32_t number, double density, const Placement& placement,
                                std::vector<PatchSample>& found) const {
  const Saddle& saddle = saddles_[number - spheres_.size()];
  const double p = probe_, rho = saddle.circle_radius;
  for (const ProfileAngles& range : saddle.profile) {
    if (!(range.from < range.to)) continue;
    const auto area_to = [&](double profile) {
      return p * (rho * (profile - range.from) - p * (std::sin(profile) - std::sin(range.from)));
    };
    saddle.buried.each_part({0, saddle.angle}, [&](const AngleRange& part, bool is_buried) {
      const double angle = part.to - part.from, area = angle * area_to(range.to);
      if (!(area > kLeastArea)) return;
      const std::uint64_t count = count_for(area, density);
      const double wide = (range.to - range.from) / static_cast<double>(count);
      const double sign = saddle.falls ? -1 : 1, begin = saddle.falls ? range.to : range.from;
      for (std::uint64_t i = 0; i < count; ++i) {
        const double k = static_cast<double>(i);
        const double along = fraction(placement.along + k * kInverseGoldenRatio) * angle;
        const double turn = saddle.turns_back ? part.to - along : part.from + along;
        const double profile = begin + sign * (k + placement.across) * wide;
        const double lower = begin + sign * k * wide, upper = begin + sign * (k + 1) * wide;
        const Vec3d radial = std::cos(turn) * saddle.first + std::sin(turn) * saddle.second;
        found.push_back({.point = on_tube(saddle, turn, profile),
                         .normal = std::cos(profile) * radial - std::sin(profile) * saddle.axis,
                         .weight = angle * std::abs(area_to(upper) - area_to(lower)),
                         .patch = number,
                         .is_buried = is_buried});
      }
    });
  }
}

}  // namespace vdwmesh
