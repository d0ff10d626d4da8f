// The flat faces of caps: disks cut by planes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "excluded/patches/cap_arrangement.hpp"
#include "excluded/patches/share_formulas.hpp"

namespace vdwmesh::excluded {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-14;  // of areas of order 1
const Vec3d kUp{0, 0, 1};

// The points w with normal · w <= height.
struct HalfSpace {
  Vec3d normal;
  double height;
};

double face_area(const Vec3d& axis, double cosine, const std::vector<HalfSpace>& within) {
  CapFace<HeapLists> on_heap(axis, cosine);
  CapFace<BoundedLists> in_bounded_lists(axis, cosine);
  for (const HalfSpace& h : within) {
    on_heap.clip(h.normal, h.height);
    in_bounded_lists.clip(h.normal, h.height);
  }
  EXPECT_EQ(on_heap.area(), in_bounded_lists.area());
  return on_heap.area();
}

TEST(CapFace, WholeDisk) { EXPECT_NEAR(face_area(kUp, 0.6, {}), 0.64 * kPi, kRounding); }

TEST(CapFace, SegmentOfADisk) {
  // The disk of radius 0.8 up to x = 0.4: its half angle is 60°.
  const std::vector<HalfSpace> within{{{1, 0, 0}, 0.4}};
  const double segment = 0.64 * (kPi / 3 - std::sin(2 * kPi / 3) / 2);
  EXPECT_NEAR(face_area(kUp, 0.6, within), 0.64 * kPi - segment, kRounding);
}

// Counter-clockwise about z, through more than a quarter of a turn too.
TEST(CapCircle, PointBeyondAnAngle) {
  const auto circle = cap_circle<double>({0, 0, 1}, 0.6);
  for (const double angle : {0.3, 1.4, 1.7, 3.0, 4.0, 5.9}) {
    const auto p = point_beyond<double>(circle, {0.8, 0, 0.6}, angle);
    EXPECT_NEAR(p.x, 0.8 * std::cos(angle), kRounding) << angle;
    EXPECT_NEAR(p.y, 0.8 * std::sin(angle), kRounding) << angle;
    EXPECT_NEAR(p.z, 0.6, kRounding) << angle;
  }
}

// A plane that leans: at height 0.6 it runs along x = 0.2.
TEST(CapFace, LeaningPlane) {
  const std::vector<HalfSpace> leaning{{{1, 0, 1}, 0.8}}, upright{{{1, 0, 0}, 0.2}};
  EXPECT_NEAR(face_area(kUp, 0.6, leaning), face_area(kUp, 0.6, upright), kRounding);
}

// The sectors that planes through the middle cut are a third each, wherever the polygon's corner at
// the middle comes to lie by rounding.
TEST(CapFace, SectorsAroundTheMiddle) {
  for (const double turn : {0.0, 0.1, 0.7, 2.0}) {
    const auto wall = [&](double angle) {
      return HalfSpace{{std::cos(turn + angle), std::sin(turn + angle), 0}, 0};
    };
    const std::vector<HalfSpace> third{wall(0), wall(kPi / 3)};
    EXPECT_NEAR(face_area(kUp, 0.6, third), 0.64 * kPi / 3, kRounding) << turn;
  }
}

TEST(CapFace, NothingIsLeft) {
  const std::vector<HalfSpace> beside{{{1, 0, 0}, -0.9}};
  EXPECT_NEAR(face_area(kUp, 0.6, beside), 0, kRounding);
}

}  // namespace
}  // namespace vdwmesh::excluded
