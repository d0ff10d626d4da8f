// The caps that all other balls of a union cover on one sphere.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "core/lanes/lanes.hpp"
#include "measures/arcs/arc_cap.hpp"
#include "measures/arcs/doubts.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh::arcs {

// Keeps its memory from ball to ball.
class BallCaps {
 public:
  // Finds the caps of the balls that cut the ball at list place `place`. Returns false, and has no
  // caps, if one of the others buries it; of equal balls the one of the lowest id buries the
  // others.
  bool find(const CellListView& list, ListPlace place);

  std::span<const Cap> caps() const { return {caps_.data(), count_}; }
  // The balls that cover the caps, in the order that find() left the caps in.
  std::span<const ListPlace> neighbors() const { return {neighbors_.data(), count_}; }
  // Of the balls that have the cap of this index, the index of the farthest, and of equal balls
  // of the lowest id: all others are hidden there.
  std::uint32_t farthest_of_equal(const CellListView& list, ListPlace place,
                                  std::uint32_t cap) const;
  // A ball that buries this one; valid if find() returned false.
  ListPlace buried_by() const { return buried_by_; }
  // Whether the spheres of this ball and another one touch, or nearly so, from outside or inside.
  // Known if find() returned true.
  bool is_nearly_tangent() const { return is_nearly_tangent_; }

 private:
  // BallLanes spheres of the list, as lanes: their centres from the ball's centre, and their radii.
  struct BallLanes {
    Lanes x, y, z, radius;
  };
  static BallLanes four_of(const CellListView& list, const Sphere& ball, const ListPlace* places);

  void list_candidates(const CellListView& list, const Sphere& ball, ListPlace place);
  bool keep_near(const CellListView& list, const Sphere& ball, ListPlace place);
  bool make_caps(const CellListView& list, const Sphere& ball);
  bool find_singly(const CellListView& list, const Sphere& ball, ListPlace place);

  std::vector<ListPlace> near_;   // candidates, then the balls near this one
  std::vector<double> to_;        // the near balls as four_of() gives them, four by four
  std::vector<double> distance_;  // of the near balls' centres
  std::vector<Cap> caps_;
  std::vector<ListPlace> neighbors_;
  std::size_t near_count_ = 0, count_ = 0;
  ListPlace buried_by_{};
  bool is_nearly_tangent_ = false;
};

VDWMESH_INLINE BallCaps::BallLanes BallCaps::four_of(const CellListView& list, const Sphere& ball,
                                                     const ListPlace* places) {
  static_assert(sizeof(Sphere) == sizeof(Lanes));
  const ByListPlace<Sphere> spheres = list.spheres;
  Lanes x = lanes_at(&spheres[places[0]].center.x), y = lanes_at(&spheres[places[1]].center.x),
        z = lanes_at(&spheres[places[2]].center.x), radius = lanes_at(&spheres[places[3]].center.x);
  transpose(x, y, z, radius);
  return {x - all_lanes(ball.center.x), y - all_lanes(ball.center.y), z - all_lanes(ball.center.z),
          radius};
}

// Fills near_ with the balls of all cells near this one, and behind them with the ball itself up to
// a multiple of four.
VDWMESH_INLINE void BallCaps::list_candidates(const CellListView& list, const Sphere& ball,
                                              ListPlace place) {
  using Places = std::uint32_t __attribute__((vector_size(16)));
  const Vec3d r{ball.radius, ball.radius, ball.radius};
  std::size_t found = 0;
  const auto take_row = [&](ListPlace first_place, ListPlace end_place) {
    const std::uint32_t first = to_index(first_place), end = to_index(end_place);
    const std::size_t most = found + (end - first) + 8;
    if (near_.size() < most) near_.resize(2 * most);
    // Eight at a time, more than most rows have; what is too many is overwritten by the next row.
    ListPlace* next = near_.data() + found;
    Places low{first, first + 1, first + 2, first + 3};
    for (std::uint32_t i = first;;) {
      const Places high = low + 4;
      std::memcpy(next, &low, sizeof low);
      std::memcpy(next + 4, &high, sizeof high);
      i += 8;
      if (i >= end) break;
      next += 8;
      low += 8;
    }
    found += end - first;
    return false;
  };
  visit_rows_near_box(list, ball.center - r, ball.center + r, take_row);
  std::fill_n(&near_[found], 4, place);
  near_count_ = found;
}

// Keeps those of the candidates that overlap or touch the ball, or nearly so, and have another
// centre. Returns false if other balls than the ball itself have its centre, but for underflow.
// Without branches on what is near: the processor could not foresee them.
VDWMESH_INLINE bool BallCaps::keep_near(const CellListView& list, const Sphere& ball,
                                        ListPlace place) {
  const Lanes own_radius = all_lanes(ball.radius), margin = all_lanes(1 + kTouching),
              least = all_lanes(kLeastSquare);
  ListPlace* const near = near_.data();
  std::size_t found = 0;
  LaneBits concentric{};
  const std::size_t count = near_count_;
  for (std::size_t i = 0; i < count; i += 4) {
    const ListPlace places[4] = {near[i], near[i + 1], near[i + 2], near[i + 3]};
    const BallLanes to = four_of(list, ball, places);
    const Lanes sum = margin * (own_radius + to.radius),
                squared = to.x * to.x + to.y * to.y + to.z * to.z;
    const LaneBits apart = squared >= least, is_near = (squared <= sum * sum) & apart;
    concentric += ~apart;  // -1 for each
    for (std::size_t k = 0; k < 4; ++k) {
      near[found] = places[k];
      found -= static_cast<std::size_t>(is_near[k]);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) near[found + k] = place;
  near_count_ = found;
  const auto padding = static_cast<std::int64_t>((4 - count % 4) % 4);
  return concentric[0] + concentric[1] + concentric[2] + concentric[3] == -1 - padding;
}

// make_cap() for four balls at a time: the same operations in the same order, and so the same bits.
// The ball itself, with which the last four are filled up, has a cosine of NaN and no cap.
VDWMESH_INLINE bool BallCaps::make_caps(const CellListView& list, const Sphere& ball) {
  const std::size_t count = near_count_, fours = (count + 3) / 4;
  const ListPlace* const near = near_.data();
  if (to_.size() < 16 * fours) {
    to_.resize(32 * fours);
    distance_.resize(8 * fours);
    caps_.resize(8 * fours + 4);
    neighbors_.resize(8 * fours + 4);
  }
  double* const to = to_.data();
  double* const distances = distance_.data();
  for (std::size_t i = 0; i < fours; ++i) {
    const BallLanes t = four_of(list, ball, near + 4 * i);
    store_lanes(to + 16 * i, t.x);
    store_lanes(to + 16 * i + 4, t.y);
    store_lanes(to + 16 * i + 8, t.z);
    store_lanes(to + 16 * i + 12, t.radius);
    store_lanes(distances + 4 * i, t.x * t.x + t.y * t.y + t.z * t.z);
  }
  for (std::size_t i = 0; i < 4 * fours; ++i) distances[i] = std::sqrt(distances[i]);
  const Lanes r = all_lanes(ball.radius), one = all_lanes(1), two = all_lanes(2);
  LaneBits buries{}, is_tangent{};
  std::size_t found = 0;
  for (std::size_t i = 0; i < fours; ++i) {
    const BallLanes t{lanes_at(to + 16 * i), lanes_at(to + 16 * i + 4), lanes_at(to + 16 * i + 8),
                      lanes_at(to + 16 * i + 12)};
    const Lanes squared = t.x * t.x + t.y * t.y + t.z * t.z, distance = lanes_at(distances + 4 * i);
    const Lanes sum = r + t.radius, power = squared + (r - t.radius) * sum,
                cosine = power / (two * distance * r), inverse = one / distance,
                size = cosine < 0 ? -cosine : cosine;
    const LaneBits overlaps = squared < sum * sum,
                   cuts = overlaps & (cosine < one) & (cosine > -one);
    const Lanes gap = size < one ? one - size : size - one;
    is_tangent |= (~overlaps) | (gap <= kTouching);
    buries |= overlaps & (cosine <= -one);
    Lanes row0 = inverse * t.x, row1 = inverse * t.y, row2 = inverse * t.z, row3 = cosine;
    transpose(row0, row1, row2, row3);
    store_lanes(&caps_[found].axis.x, row0);
    neighbors_[found] = near[4 * i];
    found -= static_cast<std::size_t>(cuts[0]);
    store_lanes(&caps_[found].axis.x, row1);
    neighbors_[found] = near[4 * i + 1];
    found -= static_cast<std::size_t>(cuts[1]);
    store_lanes(&caps_[found].axis.x, row2);
    neighbors_[found] = near[4 * i + 2];
    found -= static_cast<std::size_t>(cuts[2]);
    store_lanes(&caps_[found].axis.x, row3);
    neighbors_[found] = near[4 * i + 3];
    found -= static_cast<std::size_t>(cuts[3]);
  }
  is_nearly_tangent_ = (is_tangent[0] | is_tangent[1] | is_tangent[2] | is_tangent[3]) != 0;
  count_ = found;
  return (buries[0] | buries[1] | buries[2] | buries[3]) == 0;
}

// Looks at one candidate after another, until one buries the ball.
inline bool BallCaps::find_singly(const CellListView& list, const Sphere& ball, ListPlace place) {
  if (caps_.size() < near_count_) {
    caps_.resize(2 * near_count_);
    neighbors_.resize(2 * near_count_);
  }
  count_ = 0;
  is_nearly_tangent_ = false;
  std::size_t found = 0;
  for (std::size_t i = 0; i < near_count_; ++i) {
    const ListPlace other = near_[i];
    const Sphere& near = list.spheres[other];
    buried_by_ = other;
    if (near.center == ball.center) {
      const bool is_equal = near.radius == ball.radius;
      if (is_equal ? list.id[other] < list.id[place] : near.radius > ball.radius) return false;
      continue;
    }
    const Vec3d to = near.center - ball.center;
    const double sum = (1 + kTouching) * (ball.radius + near.radius);
    if (!(inner(to, to) <= sum * sum)) continue;
    Cap& cap = caps_[found];
    cap.cosine = 1;  // stays, if the ball only touches this one
    const CapKind kind = make_cap(ball, near, cap);
    neighbors_[found] = other;
    found += kind == CapKind::cuts;
    if (kind == CapKind::buries) return false;
    is_nearly_tangent_ |= std::abs(std::abs(cap.cosine) - 1) <= kTouching;
  }
  count_ = found;
  return true;
}

inline bool BallCaps::find(const CellListView& list, ListPlace place) {
  const Sphere& ball = list.spheres[place];
  list_candidates(list, ball, place);
  if (keep_near(list, ball, place) && make_caps(list, ball)) return true;
  list_candidates(list, ball, place);  // keep_near() has left some out
  return find_singly(list, ball, place);
}

inline std::uint32_t BallCaps::farthest_of_equal(const CellListView& list, ListPlace place,
                                                 std::uint32_t cap) const {
  const auto distance_of = [&](std::uint32_t i) {
    const Vec3d to = list.spheres[neighbors_[i]].center - list.spheres[place].center;
    return inner(to, to);
  };
  std::uint32_t best = cap;
  for (std::uint32_t i = 0; i < count_; ++i) {
    if (!same_cap(caps_[i], caps_[cap])) continue;
    const double apart = distance_of(i) - distance_of(best);
    const bool is_lower = list.id[neighbors_[i]] < list.id[neighbors_[best]];
    if (apart > 0 || (apart == 0 && is_lower)) best = i;
  }
  return best;
}

}  // namespace vdwmesh::arcs
