// NearEight: what NearLanes (analysis/distances/box_tree_view.hpp) says of a node, computed for all
// eight boxes at once by the host's vector instructions.
//
// Every lane does the float operations of BoxSides::squared_distance() in their order, so the
// distances are the same bits.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

#include "analysis/distances/box_tree_view.hpp"
#include "core/lanes/lane_masks.hpp"

namespace vdwmesh {

struct NearEight {
  std::uint32_t near;
  float distance[BoxNode::kWidth];  // squared and scaled

  VDWMESH_INLINE NearEight(const BoxNode& node, const BoxQuery& query, float bound) {
    const BoxSides sides(node, query);
    Floats sum{};
    for (int axis = 0; axis < 3; ++axis) {
      const Floats step = Floats{} + sides.step[axis];
      const Floats a = sides.below[axis] + step * floats_of(node.lower[axis]);
      const Floats b = sides.above[axis] - step * floats_of(node.upper[axis]);
      const Floats larger = a > b ? a : b;
      const Floats outside = larger > Floats{} ? larger : Floats{};
      sum += outside * outside;
    }
    std::memcpy(distance, &sum, sizeof sum);
    near = bits_of_eight(sum < Floats{} + bound) & ((1u << node.count) - 1);
  }

 private:
  using Floats = float __attribute__((vector_size(BoxNode::kWidth * sizeof(float))));
  using Bytes = std::uint8_t __attribute__((vector_size(16)));
  using Words = std::uint16_t __attribute__((vector_size(16)));
  using Numbers = std::int32_t __attribute__((vector_size(16)));

  // Widens each byte by zeros behind it. Compilers take a conversion of eight bytes apart instead.
  static VDWMESH_INLINE Floats floats_of(const std::uint8_t (&sides)[BoxNode::kWidth]) {
    static_assert(std::endian::native == std::endian::little);
    std::uint64_t all;
    std::memcpy(&all, sides, sizeof all);
    using Halves = std::uint64_t __attribute__((vector_size(16)));
    const Words words = std::bit_cast<Words>(
        __builtin_shufflevector(std::bit_cast<Bytes>(Halves{all, 0}), Bytes{}, 0, 16, 1, 17, 2, 18,
                                3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
    const auto low =
        std::bit_cast<Numbers>(__builtin_shufflevector(words, Words{}, 0, 8, 1, 9, 2, 10, 3, 11));
    const auto high =
        std::bit_cast<Numbers>(__builtin_shufflevector(words, Words{}, 4, 12, 5, 13, 6, 14, 7, 15));
    return __builtin_convertvector(__builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7),
                                   Floats);
  }
};

}  // namespace vdwmesh
