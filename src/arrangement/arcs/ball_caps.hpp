// The caps that all other balls of a union cover on one sphere.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "arrangement/arcs/arc_cap.hpp"
#include "arrangement/arcs/doubts.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh::arcs {

// Keeps its memory from ball to ball.
class BallCaps {
 public:
  // Finds the caps of the balls that cut the ball at list place `place`. Returns false, and has no
  // caps, if one of the others buries it; of equal balls the one of the lowest id buries the
  // others.
  bool find(const CellListView& list, std::uint32_t place);

  std::span<const Cap> caps() const { return {caps_.data(), count_}; }
  // The list places of the balls that cover the caps, in the order that find() left the caps in.
  std::span<const std::uint32_t> neighbors() const { return {neighbors_.data(), count_}; }
  // The list place of a ball that buries this one; valid if find() returned false.
  std::uint32_t buried_by() const { return buried_by_; }
  // Whether the spheres of this ball and another one touch, or nearly so, from outside or inside.
  // Known if find() returned true.
  bool is_nearly_tangent() const { return is_nearly_tangent_; }

 private:
  void find_near(const CellListView& list, const Sphere& ball);

  std::vector<std::uint32_t> near_;  // list places of all balls that overlap or touch this one
  std::vector<Cap> caps_;
  std::vector<std::uint32_t> neighbors_;
  std::size_t near_count_ = 0, count_ = 0;
  std::uint32_t buried_by_ = 0;
  bool is_nearly_tangent_ = false;
};

// Without branches on what is near: the processor could not foresee them.
inline void BallCaps::find_near(const CellListView& list, const Sphere& ball) {
  const Vec3d r{ball.radius, ball.radius, ball.radius};
  std::size_t found = 0;
  const auto take_row = [&](std::uint32_t first, std::uint32_t end) {
    if (near_.size() < found + (end - first)) near_.resize(2 * (found + (end - first)));
    std::uint32_t* const near = near_.data();
    for (std::uint32_t place = first; place < end; ++place) {
      const Sphere& other = list.spheres[place];
      const Vec3d to = other.center - ball.center;
      const double sum = (1 + kTouching) * (ball.radius + other.radius);
      near[found] = place;
      found += inner(to, to) <= sum * sum;
    }
    return false;
  };
  visit_rows_near_box(list, ball.center - r, ball.center + r, take_row);
  near_count_ = found;
}

inline bool BallCaps::find(const CellListView& list, std::uint32_t place) {
  const Sphere& ball = list.spheres[place];
  find_near(list, ball);
  if (caps_.size() < near_count_) {
    caps_.resize(2 * near_count_);
    neighbors_.resize(2 * near_count_);
  }
  count_ = 0;
  is_nearly_tangent_ = false;
  std::size_t found = 0;
  for (std::size_t i = 0; i < near_count_; ++i) {
    const std::uint32_t other = near_[i];
    const Sphere& near = list.spheres[other];
    buried_by_ = other;
    if (near.center == ball.center) {
      const bool is_equal = near.radius == ball.radius;
      if (is_equal ? list.id[other] < list.id[place] : near.radius > ball.radius) return false;
      continue;
    }
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

}  // namespace vdwmesh::arcs
