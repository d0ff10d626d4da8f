// Cubic bins over a box: as wide as wished, or as few as asked for.
#include "core/order/bins.hpp"

#include <gtest/gtest.h>

namespace vdwmesh {
namespace {

double total(const Bins& bins) {
  return static_cast<double>(bins.count[0]) * bins.count[1] * bins.count[2];
}

void expect_covers(const Bins& bins, const Vec3d& extent) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_GE(bins.count[axis], 1);
    EXPECT_GT(bins.width * bins.count[axis], extent[static_cast<int>(axis)]);
  }
}

TEST(Bins, HaveTheWidthWishedWhereTheyAreFewEnough) {
  const Bins bins = cubic_bins({10, 4.5, 0}, 1, 1000);
  EXPECT_EQ(bins.width, 1);
  EXPECT_EQ(bins.count, (std::array<std::int32_t, 3>{11, 5, 1}));
}

TEST(Bins, AreWidenedUntilTheyAreFewEnough) {
  for (const Vec3d& extent : {Vec3d{1000, 1000, 1000}, Vec3d{1e6, 3, 0}, Vec3d{0, 0, 7e5}}) {
    for (const double width : {1.0, 1e-3, 1e-300}) {
      const Bins bins = cubic_bins(extent, width, 4096);
      EXPECT_LE(total(bins), 4096);
      EXPECT_GE(bins.width, width);
      expect_covers(bins, extent);
    }
  }
}

// Whatever is asked for, 32 bits number them.
TEST(Bins, AreNeverMoreThan32BitsNumber) {
  for (const double most : {8.0 * (1u << 28), 8.0 * 4294967295.0, 1e300}) {
    const Bins bins = cubic_bins({2e6, 0, 0}, 1e-4, most);
    EXPECT_LE(total(bins), 2147483647.0);
    EXPECT_GT(total(bins), 2e9);
    expect_covers(bins, {2e6, 0, 0});
  }
}

}  // namespace
}  // namespace vdwmesh
