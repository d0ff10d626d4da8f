// Finds the balls that touch a brick, on the CPU. Bricks are usually visited in the order of their
// keys, so consecutive bricks often lie side by side along x. Therefore the cell list is searched
// once for a group of four bricks along x, and the result is filtered for each brick of the group.
// Both the search and the filter keep some elements of a list without branching: they write every
// element at the end of the kept ones, and move this end by 1 or 0.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "extract/bricks/brick_geometry.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Keeps the balls near the group of bricks that was searched last. Bricks may come in any order; a
// brick of another group starts a new search.
class BallSearch {
 public:
  BallSearch(const CellListView& list, const GridSpec& grid) : list_(list), grid_(grid) {}

  // Replaces `places` by the list places, rising, of the balls that touch the box of the brick's
  // nodes. Some balls that miss the box by rounding may be among them.
  void find(const BrickGeometry& brick, std::vector<ListPlace>& places) {
    const BrickIndex& b = brick.brick;
    const BrickIndex start{b.x / kBricks * kBricks, b.y, b.z};
    if (!(start == start_)) search(start, brick);
    const Vec3d lower = brick.node(0, 0, 0);
    const Vec3d upper = brick.node(kBrickSide, kBrickSide, kBrickSide);
    const std::size_t count = place_.size();
    touches_.resize(count);
    for (std::size_t k = 0; k < count; ++k)
      touches_[k] = square_to_box({x_[k], y_[k], z_[k]}, lower, upper) <= reach2_[k] ? 1 : 0;
    // Every list place is written at places[found], but `found` advances only for balls that touch
    // the brick. The one extra element is a reserve.
    places.resize(count + 1);
    std::size_t found = 0;
    for (std::size_t k = 0; k < count; ++k) {
      places[found] = place_[k];
      found += static_cast<std::size_t>(touches_[k]);
    }
    places.resize(found);
  }

 private:
  static constexpr std::int32_t kBricks = 4;  // bricks of a group
  // If a ball holds a node, inside_ball() finds a squared distance of at most r² between node and
  // centre. The squared distance from the centre to the box is not larger, except for the rounding
  // of its few operations, some units of 1.1e-16 relative. The factor covers this rounding, so no
  // ball that holds a node is left out.
  static constexpr double kTouchMargin = 1 + 1e-12;

  static double touch_square(const Sphere& ball) {
    return ball.radius * ball.radius * kTouchMargin;
  }

  static double square_to_box(const Vec3d& c, const Vec3d& lower, const Vec3d& upper) {
    // std::max() takes references and is compiled to a branch, which would be mispredicted often.
    const auto larger = [](double a, double b) { return a > b ? a : b; };
    const double dx = larger(larger(lower.x - c.x, c.x - upper.x), 0.0);
    const double dy = larger(larger(lower.y - c.y, c.y - upper.y), 0.0);
    const double dz = larger(larger(lower.z - c.z, c.z - upper.z), 0.0);
    return dx * dx + dy * dy + dz * dz;
  }

  // Finds the balls that touch the box of the group that begins with brick `start`. `brick` is any
  // brick of the group; it has the group's y and z coordinates. place_ doubles whenever it is full,
  // so that place_[found] can always be written. The visitor returns false to go on to the next
  // ball.
  void search(const BrickIndex& start, const BrickGeometry& brick) {
    start_ = start;
    Vec3d lower = brick.node(0, 0, 0), upper = brick.node(kBrickSide, kBrickSide, kBrickSide);
    lower.x = lattice_coordinate(grid_, 0, lattice_index(start.x, 0));
    upper.x = lattice_coordinate(grid_, 0, lattice_index(start.x + kBricks, 0));
    std::size_t found = 0;
    place_.resize(std::max(place_.capacity(), std::size_t{64}));
    visit_near_box(list_, lower, upper, [&](ListPlace place) {
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
  BrickIndex start_{-1, -1, -1};  // first brick of the group; -1: nothing has been searched yet
  // Balls near the group: list place, centre (Å), and squared radius times kTouchMargin (Å²).
  // Separate arrays let the compiler vectorise the filter.
  std::vector<ListPlace> place_;
  std::vector<double> x_, y_, z_, reach2_;
  // 1 if the ball touches the brick, else 0. The elements are as wide as a double, so that the
  // vectorised filter stores them without conversion.
  std::vector<std::int64_t> touches_;
};

}  // namespace vdwmesh
