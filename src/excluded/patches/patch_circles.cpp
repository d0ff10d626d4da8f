// circles_in_wide(): a probe's centre is a corner of three grown balls, computed in wide numbers.
// The circle of a cap is in the plane that bisects the balls of the two probes.
#include "excluded/patches/patch_circles.hpp"

#include <cmath>

namespace vdwmesh::excluded {
namespace {

// Squared radii of probes differ by up to this fraction of themselves: enough to show in wide
// numbers, and so little that even for probes as near as the root of `kGrowth` the plane between
// them hardly moves.
constexpr double kTieBreak = 1e-50;
// Probes nearer than this are in one place.
constexpr double kSamePlace = 1e-30;

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

class WidePatch {
 public:
  WidePatch(const AccessibleSurface& surface, ConcavePatch& patch)
      : surface_(surface),
        patch_(patch),
        p_(surface.probe_radius),
        center_(wide_corner(surface, surface.probes[patch.probe].corner)) {}

  PatchCircles<WideFloat> circles() {
    PatchCircles<WideFloat> out;
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

}  // namespace

template <>
WideFloat root_of(const WideFloat& x) {
  const double rounded = to_double(x);
  if (!std::isnormal(rounded) || rounded < 0) return sqrt(x);
  // 53 digits of the inverse root become 105, then 209. The last step doubles those of the root.
  WideFloat inverse = 1 / std::sqrt(rounded);
  for (int step = 0; step < 2; ++step) inverse += inverse * (1 - x * inverse * inverse) / 2;
  const WideFloat root = x * inverse;
  return root + inverse * (x - root * root) / 2;
}

PatchCircles<double> circles_in_double(const ConcavePatch& patch) {
  PatchCircles<double> out;
  for (const PatchCap& cap : patch.caps) {
    out.caps.push_back(cap_circle(vector_in<double>(cap.axis), cap.cosine));
  }
  for (const PatchSide& side : patch.sides) {
    out.sides.push_back({vector_in<double>(side.inward),
                         {vector_in<double>(side.cusp[0]), vector_in<double>(side.cusp[1])}});
  }
  return out;
}

PatchCircles<WideFloat> circles_in_wide(const AccessibleSurface& surface, ConcavePatch& patch) {
  return WidePatch(surface, patch).circles();
}

}  // namespace vdwmesh::excluded
