// The grid edges of one brick that carry a vertex, in the order of their vertices. CPU.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "extract/bricks/brick.hpp"
#include "extract/bricks/brick_cases.hpp"
#include "extract/bricks/edge_vertex.hpp"

namespace vdwmesh {

// From node (x, y, z) one step up along the axis: one word, so that it is written at once.
struct BrickEdge {
  std::uint32_t bits;

  int x() const { return static_cast<int>(bits & 15u); }
  int y() const { return static_cast<int>(bits >> 4 & 15u); }
  int z() const { return static_cast<int>(bits >> 8 & 15u); }
  int axis() const { return static_cast<int>(bits >> 12 & 3u); }
  bool lower_inside() const { return (bits >> 14 & 1u) != 0; }
  CrossedEdge crossed() const { return crossed_edge(lower_inside(), x(), y(), z(), axis()); }
};

// The edges, and the places of those along each axis among them.
class BrickEdges {
 public:
  void gather(const BrickSigns& signs) {
    Counts counts{};
    for (int z = 0; z < kBrickSide; ++z) counts = gather_layer(signs, z, counts);
    count_ = counts;
  }

  std::span<const BrickEdge> all() const { return {edge_.data(), count_.all}; }
  template <int axis>
  std::span<const std::uint16_t> along() const {
    return {along_[axis].data(), count_.along[axis]};
  }

 private:
  static constexpr std::size_t kMost = std::size_t{3} * kBrickNodes;
  struct Counts {
    std::size_t all, along[3];
  };

  // Written always, kept where the edge is crossed: no branch to guess.
  Counts gather_layer(const BrickSigns& signs, int z, Counts counts) {
    const auto row = [&](int y) { return std::uint32_t{signs.row[z][y]}; };
    const std::uint64_t inside = layer_bits(row);
    const std::uint64_t crossed[3] = {
        layer_bits([&](int y) { return row(y) ^ row(y) >> 1; }),
        layer_bits([&](int y) { return row(y) ^ row(y + 1); }),
        layer_bits([&](int y) { return row(y) ^ signs.row[z + 1][y]; })};
    for (std::uint64_t nodes = crossed[0] | crossed[1] | crossed[2]; nodes != 0;
         nodes &= nodes - 1) {
      const auto i = static_cast<std::uint32_t>(std::countr_zero(nodes));
      const std::uint32_t x = i % kBrickSide, y = i / kBrickSide;
      const std::uint32_t node = x | y << 4 | static_cast<std::uint32_t>(z) << 8 |
                                 static_cast<std::uint32_t>(inside >> i & 1u) << 14;
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        edge_[counts.all] = {node | axis << 12};
        along_[axis][counts.along[axis]] = static_cast<std::uint16_t>(counts.all);
        counts.all += crossed[axis] >> i & 1u;
        counts.along[axis] += crossed[axis] >> i & 1u;
      }
    }
    return counts;
  }

  Counts count_{};
  std::array<BrickEdge, kMost + 1> edge_;
  std::array<std::uint16_t, kBrickNodes + 1> along_[3];
};

}  // namespace vdwmesh
