// Hilbert's curve: it visits the cells of a cube at the origin first, each once, and goes from each
// to a neighbour.
#include "core/order/hilbert.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <vector>

namespace vdwmesh {
namespace {

using Cell = std::array<int, 3>;

TEST(HilbertKey, NumbersTheCellsOfACubeFromNeighbourToNeighbour) {
  constexpr int kSide = 8;
  std::vector<Cell> by_key(kSide * kSide * kSide, Cell{-1, -1, -1});
  for (int x = 0; x < kSide; ++x) {
    for (int y = 0; y < kSide; ++y) {
      for (int z = 0; z < kSide; ++z) {
        const std::uint64_t key =
            hilbert_key(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y),
                        static_cast<std::uint32_t>(z));
        ASSERT_LT(key, by_key.size());
        ASSERT_EQ(by_key[key][0], -1) << "two cells have key " << key;
        by_key[key] = {x, y, z};
      }
    }
  }
  for (std::size_t k = 1; k < by_key.size(); ++k) {
    int steps = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      steps += std::abs(by_key[k][axis] - by_key[k - 1][axis]);
    }
    EXPECT_EQ(steps, 1) << "from key " << k - 1;
  }
}

// The curve begins at the origin and ends in a corner of the cube beside it.
TEST(HilbertKey, HasAllBitsOfTheLargestCells) {
  constexpr std::uint32_t last = (1u << kHilbertBits) - 1;
  EXPECT_EQ(hilbert_key(0, 0, 0), 0u);
  const std::uint64_t end = (std::uint64_t{1} << (3 * kHilbertBits)) - 1;
  EXPECT_EQ(hilbert_key(last, 0, 0), end);
  EXPECT_LT(hilbert_key(last, last, last), end);
}

}  // namespace
}  // namespace vdwmesh
