// Vertices of a mesh of more than 2^32, which triangles name by 32 bits.
#include "distributed/surface_piece.hpp"

#include <gtest/gtest.h>

namespace vdwmesh {
namespace {

constexpr std::uint64_t kNames = std::uint64_t{1} << 32;

// From the lowest vertex that a piece names to the highest one that it can tell from it.
TEST(SurfacePiece, NumbersFollowFromNames) {
  SurfacePiece piece;
  for (const std::uint64_t lowest : {std::uint64_t{0}, std::uint64_t{7}, kNames - 1, kNames,
                                     3 * kNames - 5, 3 * kNames + kNames / 2}) {
    piece.lowest_named = lowest;
    for (const std::uint64_t above :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{6}, kNames / 2, kNames - 1}) {
      const std::uint64_t number = lowest + above;
      EXPECT_EQ(piece.number_of(static_cast<std::uint32_t>(number % kNames)), number);
    }
  }
}

}  // namespace
}  // namespace vdwmesh
