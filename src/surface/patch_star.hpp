// A divided triangle with its four children as a piece of the fans of its corners.
//
// The fan of a vertex u of the mesh that was divided is made of the divided triangles around it,
// called patches. It is a disc: consecutive patches share the edge from u and its midpoint. Its
// border has the other halves of edges: of each patch the two halves of the edge that does not end
// in u. If the four children are divided as well, the fan consists of 16 triangles a patch, and its
// border of four quarters of that edge.
#pragma once

#include <initializer_list>

#include "surface/fan_lanes.hpp"
#include "surface/star_fans.hpp"

namespace vdwmesh {

VDWMESH_INLINE StarFans::Judgement judgement_of(std::uint32_t holds, const LaneBits& crosses) {
  return {static_cast<std::uint8_t>(holds), static_cast<std::uint8_t>(bits_of(crosses))};
}

// Judges all three corners of a patch at once, one in each lane. `corner` and `middle` are the
// positions of the corners and of the midpoints, `direction` the directions of the corners' fans.
VDWMESH_INLINE StarFans::Judgement judge_patch(const LanePoint& corner, const LanePoint& middle,
                                               const LanePoint& direction) {
  FanLanes fan(corner, direction);
  const PlaneLanes next = fan.image(of_next(corner)), previous = fan.image(of_previous(corner)),
                   to_next = fan.image(middle), across = fan.image(of_next(middle)),
                   to_previous = fan.image(of_previous(middle));
  Lanes least = cross_of(to_next, to_previous);
  for (const Lanes& other : {area_of(next, across, to_next), area_of(previous, to_previous, across),
                             area_of(to_next, across, to_previous), cross_of(next, across),
                             cross_of(across, previous)}) {
    least = other < least ? other : least;
  }
  const LaneBits crosses = FanLanes::crosses(next, across) | FanLanes::crosses(across, previous);
  return judgement_of(fan.holds(least), crosses);
}

// The places of the vertices of a patch whose children are divided, by kind and corner: the corners
// C_k, the midpoints M_k of the edges C_k C_k+1, and the midpoints A_k of C_k M_k, B_k of M_k C_k+1
// and I_k of M_k M_k+1.
struct TwiceDivided {
  LanePoint corner, middle, first, second, inner;
};

// The same for a patch whose children are divided. The quarters of an edge might cross the axis
// twice; then it is not judged.
VDWMESH_INLINE StarFans::Judgement judge_twice_divided(const TwiceDivided& at,
                                                       const LanePoint& direction) {
  FanLanes fan(at.corner, direction);
  const auto images = [&](const LanePoint& p, PlaneLanes(&image)[3]) {
    image[0] = fan.image(p);
    image[1] = fan.image(of_next(p));
    image[2] = fan.image(of_previous(p));
  };
  // Element j belongs to the j-th corner from the lane's own corner on.
  PlaneLanes c[3], m[3], a[3], b[3], i[3];
  images(at.corner, c);
  images(at.middle, m);
  images(at.first, a);
  images(at.second, b);
  images(at.inner, i);
  Lanes least = area_of(i[0], i[1], i[2]);
  const auto add = [&](const Lanes& other) { least = other < least ? other : least; };
  for (int j = 0; j < 3; ++j) {
    const int before = j == 0 ? 2 : j - 1;
    add(area_of(c[j], a[j], b[before]));
    add(area_of(m[j], i[before], a[j]));
    add(area_of(m[before], b[before], i[before]));
    add(area_of(a[j], i[before], b[before]));
    add(area_of(m[j], i[j], i[before]));
  }
  const PlaneLanes border[5] = {c[1], a[1], m[1], b[1], c[2]};
  LaneBits once = all_bits(0), twice = all_bits(0);
  for (int k = 0; k < 4; ++k) {
    add(cross_of(border[k], border[k + 1]));
    const LaneBits crosses = FanLanes::crosses(border[k], border[k + 1]);
    twice |= once & crosses;
    once |= crosses;
  }
  return judgement_of(fan.holds(least) & ~bits_of(twice), once);
}

}  // namespace vdwmesh
