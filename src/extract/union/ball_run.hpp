// Balls near one brick after the other along x, from one search for several. CPU.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "extract/bricks/brick_geometry.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

class BallRun {
 public:
  BallRun(const CellListView& list, const GridSpec& grid) : list_(list), grid_(grid) {}

  // Places in the list, rising, of the balls that touch the box of the brick's nodes.
  void find(const BrickGeometry& brick, std::vector<std::uint32_t>& places) {
    const BrickIndex& b = brick.brick;
    const BrickIndex start{b.x / kBricks * kBricks, b.y, b.z};
    if (!(start == start_)) search(start, brick);
    const Vec3d lower = brick.node(0, 0, 0);
    const Vec3d upper = brick.node(kBrickSide, kBrickSide, kBrickSide);
    const std::size_t count = place_.size();
    touches_.resize(count);
    for (std::size_t k = 0; k < count; ++k)
      touches_[k] = square_to_box({x_[k], y_[k], z_[k]}, lower, upper) <= reach2_[k] ? 1 : 0;
    // Kept without a branch to guess.
    places.resize(count + 1);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count; ++k) {
      places[found] = place_[k];
      found += static_cast<std::size_t>(touches_[k]);
    }
    places.resize(found);
  }

 private:
  static constexpr std::int32_t kBricks = 4;  // of one search
  // Covers the rounding of a squared distance against the predicate's.
  static constexpr double kTouchMargin = 1 + 1e-12;

  static double touch_square(const Sphere& ball) {
    return ball.radius * ball.radius * kTouchMargin;
  }

  static double square_to_box(const Vec3d& c, const Vec3d& lower, const Vec3d& upper) {
    // By value: std::max() becomes a branch that cannot be guessed.
    const auto larger = [](double a, double b) { return a > b ? a : b; };
    const double dx = larger(larger(lower.x - c.x, c.x - upper.x), 0.0);
    const double dy = larger(larger(lower.y - c.y, c.y - upper.y), 0.0);
    const double dz = larger(larger(lower.z - c.z, c.z - upper.z), 0.0);
    return dx * dx + dy * dy + dz * dz;
  }

  void search(const BrickIndex& start, const BrickGeometry& brick) {
    start_ = start;
    Vec3d lower = brick.node(0, 0, 0), upper = brick.node(kBrickSide, kBrickSide, kBrickSide);
    lower.x = lattice_coordinate(grid_, 0, lattice_index(start.x, 0));
    upper.x = lattice_coordinate(grid_, 0, lattice_index(start.x + kBricks, 0));
    // Kept without a branch to guess, as in find().
    std::size_t found = 0;
    place_.resize(std::max(place_.capacity(), std::size_t{64}));
    visit_near_box(list_, lower, upper, [&](std::uint32_t place) {
      const Sphere& ball = list_.spheres[place];
      place_[found] = place;
      found += square_to_box(ball.center, lower, upper) <= touch_square(ball) ? 1 : 0;
      if (found == place_.size()) place_.resize(2 * found);
      return false;
    });
    place_.resize(found);
    for (std::vector<double>* values : {&x_, &y_, &z_, &reach2_}) values->resize(found);
    for (std::size_t k = 0; k < found; ++k) {
      const Sphere& ball = list_.spheres[place_[k]];
      x_[k] = ball.center.x;
      y_[k] = ball.center.y;
      z_[k] = ball.center.z;
      reach2_[k] = touch_square(ball);
    }
  }

  const CellListView& list_;
  const GridSpec& grid_;
  BrickIndex start_{-1, -1, -1};
  std::vector<std::uint32_t> place_;
  std::vector<double> x_, y_, z_, reach2_;  // Å, Å²
  std::vector<std::int64_t> touches_;
};

}  // namespace vdwmesh
