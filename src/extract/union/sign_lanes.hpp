// Node signs of a brick for the union of balls, in float32, on the CPU: a floating-point filter
// before the exact predicate in double. A node is inside if the least value of d² - r² over the
// balls is at most 0. The loops run over the nodes of a layer (nodes of equal z) as vector lanes.
// If at some node the magnitude of the least value is within its possible rounding error, the
// filter gives up, and the caller computes all signs of the brick in double.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "extract/bricks/brick_geometry.hpp"
#include "extract/union/union_lanes.hpp"

namespace vdwmesh {

// Lanes of a layer: nodes x = 0 .. 7 of the rows y = 0 .. 8 at 8 y + x, then the nodes x = 8 of
// these rows at 72 + y, then 7 unused lanes that fill up whole vectors of 8. The unused lanes keep
// x = y = 0, the position of node (0, 0) of the layer, so they are never doubtful unless that node
// is.
class SignFilter {
 public:
  // Computes the signs of all 9 x 9 x 9 nodes. Returns false if some node is too near a sphere for
  // float32 to decide; the signs are meaningless then. If it returns true, all signs are those of
  // inside_ball(). `spacing` is the grid's, Å.
  bool signs(const NearBalls& balls, const BrickGeometry& geometry, float spacing,
             BrickSigns& signs);

 private:
  static constexpr int kRows = kBrickReach * kBrickSide;
  static constexpr int kLanes = kRows + 16;
  static constexpr float kFar = 1e38f;  // Å²; the least d² - r² where there is no ball
  using Layer = std::array<float, kLanes>;

  void set_nodes(const BrickGeometry& geometry);
  void set_balls(const NearBalls& balls);
  void read_layer(std::uint16_t* row) const;

  float along_z_[kBrickReach];   // z of each layer from node 0, Å
  Layer x_{}, y_{};              // x and y of each lane from node 0, Å
  std::vector<Layer> in_layer_;  // [ball]: (x - cx)^2 + (y - cy)^2 at each lane, Å²
  // least_: the least d^2 - r^2 over the balls at each node of the layer. closest_: the least
  // absolute value of least_ over all layers so far. Both in Å².
  Layer least_, closest_;
  alignas(8) std::array<std::uint8_t, kLanes> inside_;  // at each lane of the layer: 1 if inside
};

inline void SignFilter::set_nodes(const BrickGeometry& geometry) {
  const auto offset = [&](int axis, int i) {
    return static_cast<float>(geometry.coordinate[axis][i] - geometry.coordinate[axis][0]);
  };
  for (int y = 0; y < kBrickReach; ++y) {
    for (int x = 0; x < kBrickReach; ++x) {
      const auto lane = static_cast<std::size_t>(x < kBrickSide ? y * kBrickSide + x : kRows + y);
      x_[lane] = offset(0, x);
      y_[lane] = offset(1, y);
    }
  }
  for (int z = 0; z < kBrickReach; ++z) along_z_[z] = offset(2, z);
}

// Sets in_layer_, the part of the squared distances that is the same in all layers. The vector only
// grows, so its later elements may belong to balls of earlier bricks.
inline void SignFilter::set_balls(const NearBalls& balls) {
  if (in_layer_.size() < balls.size()) in_layer_.resize(balls.size());
  for (std::size_t k = 0; k < balls.size(); ++k) {
    const float cx = balls.center[0][k], cy = balls.center[1][k];
    Layer& layer = in_layer_[k];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float dx = x_[i] - cx, dy = y_[i] - cy;
      layer[i] = dx * dx + dy * dy;
    }
  }
}

// Packs the bytes of inside_ into the layer's nine rows of nine bits. The multiplication gathers
// the lowest bits of eight bytes: its factor has the bits 56 - 7 x for x = 0 .. 7, so it moves bit
// 8 x, the sign of byte x, to bit 56 + x. No two of the partial products meet in one bit, so
// nothing is carried. The shift then leaves the highest byte.
inline void SignFilter::read_layer(std::uint16_t* row) const {
  static_assert(std::endian::native == std::endian::little);
  for (int y = 0; y < kBrickReach; ++y) {
    std::uint64_t bytes;
    std::memcpy(&bytes, inside_.data() + std::ptrdiff_t{kBrickSide} * y, sizeof bytes);
    const std::uint64_t bits = bytes * 0x0102040810204080u >> 56;
    const auto last =
        static_cast<std::uint64_t>(inside_[std::size_t{kRows} + static_cast<std::size_t>(y)]);
    row[y] = static_cast<std::uint16_t>(bits | last << kBrickSide);
  }
}

inline bool SignFilter::signs(const NearBalls& balls, const BrickGeometry& geometry, float spacing,
                              BrickSigns& signs) {
  // The squares must stay well below kFar and the largest float. `rounding` is about 2.5e-6 times
  // the largest square; if it is 1e30 or more, or not a number, double decides.
  const float rounding = rounding_of_squares(balls.largest, spacing);
  if (!(rounding < 1e30f)) return false;
  set_nodes(geometry);
  set_balls(balls);
  closest_.fill(kFar);
  for (int z = 0; z < kBrickReach; ++z) {
    least_.fill(kFar);
    for (std::size_t k = 0; k < balls.size(); ++k) {
      const float dz = along_z_[z] - balls.center[2][k];
      const float rest = dz * dz - balls.radius[k] * balls.radius[k];
      // The layer's plane lies outside the ball: d² - r² is at least `rest` at all its nodes, so
      // the ball makes no node inside and none doubtful.
      if (rest > rounding) continue;
      const Layer& layer = in_layer_[k];
      for (std::size_t i = 0; i < kLanes; ++i) {
        const float value = layer[i] + rest;
        least_[i] = value < least_[i] ? value : least_[i];
      }
    }
    for (std::size_t i = 0; i < kLanes; ++i) {
      const float away = std::fabs(least_[i]);
      closest_[i] = away < closest_[i] ? away : closest_[i];
      inside_[i] = least_[i] < 0 ? 1 : 0;
    }
    read_layer(signs.row[z]);
  }
  std::uint32_t doubtful = 0;
  for (std::size_t i = 0; i < kLanes; ++i) doubtful += closest_[i] <= rounding ? 1u : 0u;
  return doubtful == 0;
}

}  // namespace vdwmesh
