// The crossed grid edges that one brick owns, listed in the order of their vertices, on the CPU.
// The list is made from the node signs, a layer of 64 nodes of equal z at a time: for each axis,
// exclusive ors give a word with a bit per crossed edge, and the set bits are then visited one
// after the other. The vertices of the brick are computed edge by edge from this list.
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

// The grid edge from node (x, y, z) of a brick one step up along the axis, packed into one word so
// that a single store writes it. Coordinates are 0 .. 7.
struct BrickEdge {
  std::uint32_t bits;  // x: bits 0-3, y: 4-7, z: 8-11, axis: 12-13, sign of the lower end: 14

  int x() const { return static_cast<int>(bits & 15u); }
  int y() const { return static_cast<int>(bits >> 4 & 15u); }
  int z() const { return static_cast<int>(bits >> 8 & 15u); }
  int axis() const { return static_cast<int>(bits >> 12 & 3u); }
  bool lower_inside() const { return (bits >> 14 & 1u) != 0; }
  CrossedEdge crossed() const { return crossed_edge(lower_inside(), x(), y(), z(), axis()); }
};

// The crossed edges of a brick, and for each axis the indices of the edges along it. Loops over one
// axis need no branch on the axis.
class BrickEdges {
 public:
  // Replaces the list by the crossed edges of a brick with these node signs.
  void gather(const BrickSigns& signs) {
    Counts counts{};
    for (int z = 0; z < kBrickSide; ++z) counts = gather_layer(signs, z, counts);
    count_ = counts;
  }

  // All crossed edges; edge i carries the i-th vertex of the brick.
  std::span<const BrickEdge> all() const { return {edge_.data(), count_.all}; }
  // Indices into all() of the edges along the axis, in rising order.
  template <int axis>
  std::span<const std::uint16_t> along() const {
    return {along_[axis].data(), count_.along[axis]};
  }

 private:
  static constexpr std::size_t kMost = std::size_t{3} * kBrickNodes;
  struct Counts {
    std::size_t all, along[3];
  };

  // Appends the crossed edges of the layer of nodes at z and returns the new counts. The loop runs
  // over nodes that have at least one crossed edge. All three edges of such a node are written, but
  // the counts advance only for the crossed ones, so that the next edge overwrites one that is not
  // crossed. This avoids a branch, which the processor could not predict.
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
  // One element more than the largest count, as a reserve: an edge that is not crossed is also
  // written, behind the last one that is kept.
  std::array<BrickEdge, kMost + 1> edge_;
  std::array<std::uint16_t, kBrickNodes + 1> along_[3];
};

}  // namespace vdwmesh
