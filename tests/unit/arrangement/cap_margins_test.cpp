// The octree of caps against a look at all of them.
#include "creases/arcs/cap_margins.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "spheres/directions.hpp"
#include "support/ball_families.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;
using testing::random_direction;

CoveredCap cap_of(const Vec3d& axis, double angle) {
  const double cosine = std::cos(angle);
  return {axis, cosine, 2 * std::pow(std::sin(angle), 2) / (1 + std::abs(cosine))};
}

// Caps of one size, of all sizes, around one point, all but the same, or more than half the sphere.
std::vector<CoveredCap> random_caps(Dice& dice) {
  std::vector<CoveredCap> caps;
  const int kind = dice.whole(0, 4), count = dice.whole(65, 600);
  const Vec3d middle = random_direction(dice);
  for (int i = 0; i < count; ++i) {
    const Vec3d axis = random_direction(dice);
    const double large = dice.real(1.4, 3.1), any = std::pow(10, dice.real(-7, 0.2));
    const Vec3d near = middle + 0.02 * axis;
    if (kind == 0) caps.push_back(cap_of(axis, 0.5 / std::sqrt(count)));
    if (kind == 1) caps.push_back(cap_of(axis, any));
    if (kind == 2) caps.push_back(cap_of((1 / norm(near)) * near, dice.real(0, 0.1)));
    if (kind == 3) caps.push_back(cap_of(middle, 0.7 + 1e-9 * i));
    if (kind == 4) caps.push_back(cap_of(axis, i == 0 ? large : any));
  }
  return caps;
}

TEST(CapTree, FindsWhatALookAtAllCapsFinds) {
  Dice dice(274);
  for (int set = 0; set < 200; ++set) {
    const std::vector<CoveredCap> caps = random_caps(dice);
    CapTree<GrowingMemory> tree(caps);
    PatchVector<double> scratch;
    CapMargins<GrowingMemory> margins(caps, dice.real(0, 0.05), scratch);
    tree.build(margins.bounds(), nullptr);
    std::size_t tests = 0;
    for (int i = 0; i < 400; ++i) {
      // Half of the points are near a rim.
      const CoveredCap& cap = caps[static_cast<std::size_t>(dice.whole(0, 1 << 30)) % caps.size()];
      Vec3d u = random_direction(dice);
      if (i % 2 == 0) {
        const Vec3d aside = unit(cross(cap.axis, u));
        const double angle = std::acos(std::clamp(cap.cosine, -1.0, 1.0)) +
                             dice.real(-1, 1) * std::pow(10, dice.real(-12, -1));
        u = std::cos(angle) * cap.axis + std::sin(angle) * aside;
      }
      const auto covers = [&](std::size_t c) { return caps[c].covers(u); };
      const auto is_near = [&](std::size_t c) {
        return !(dot(u, caps[c].axis) <= margins.bounds()[c]);
      };
      bool is_covered = false, is_any_near = false;
      for (std::size_t c = 0; c < caps.size(); ++c) {
        is_covered |= covers(c);
        is_any_near |= is_near(c);
      }
      ASSERT_EQ(tree.holds_for_any(u, covers), is_covered) << set << ' ' << i;
      ASSERT_EQ(!margins.is_clear(u, tree), is_any_near) << set << ' ' << i;
      tests += tree.tests(u);
    }
    EXPECT_LE(tests, 400 * caps.size());
  }
}

}  // namespace
}  // namespace vdwmesh
