// Node signs of a brick in float32, a layer of nodes at a time. CPU.
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

// Nodes x = 0 .. 7 of rows y = 0 .. 8, then nodes x = 8 of these rows, filled up to whole vectors.
class SignLanes {
 public:
  // False where some node is too near a sphere for float32 to tell; the signs then mean nothing.
  bool signs(const NearBalls& balls, const BrickGeometry& geometry, float spacing,
             BrickSigns& signs);

 private:
  static constexpr int kRows = kBrickReach * kBrickSide;
  static constexpr int kLanes = kRows + 16;
  static constexpr float kFar = 1e38f;
  using Layer = std::array<float, kLanes>;

  void set_nodes(const BrickGeometry& geometry);
  void set_balls(const NearBalls& balls);
  void read_layer(std::uint16_t* row) const;

  float along_z_[kBrickReach];
  Layer x_{}, y_{};              // Å, from node 0
  std::vector<Layer> in_layer_;  // of each ball: (x - cx)^2 + (y - cy)^2, Å²
  Layer least_, closest_;        // Å²: least d^2 - r^2 of a node, its least distance from 0
  alignas(8) std::array<std::uint8_t, kLanes> inside_;
};

inline void SignLanes::set_nodes(const BrickGeometry& geometry) {
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

inline void SignLanes::set_balls(const NearBalls& balls) {
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

// The lowest bits of eight bytes side by side: the product puts byte x's at bit 56 + x.
inline void SignLanes::read_layer(std::uint16_t* row) const {
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

inline bool SignLanes::signs(const NearBalls& balls, const BrickGeometry& geometry, float spacing,
                             BrickSigns& signs) {
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
