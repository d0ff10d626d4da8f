// The search for intersecting triangles at vertices of very many, against a test of all pairs.
#include "analysis/crossings/hub_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "cgal_pairs.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

using testing::CgalPairs;
using testing::Dice;

template <class Coordinate>
Vec3d three_of(const Coordinate& coordinate) {
  const double x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}

// A star of n triangles; hub 0, at a place that rounding does not spare.
struct Star {
  std::string name;
  Vec3d (*rim)(int i, int n, Dice&);  // of 2 n points; triangle i has those of 2 i and 2 i + 1
};
std::ostream& operator<<(std::ostream& out, const Star& star) { return out << star.name; }

Vec3d on_circle(double turn, double height) {
  const double phi = 2 * std::numbers::pi * turn;
  return {3 * std::cos(phi), 3 * std::sin(phi), height};
}
const Vec3d kOblique[] = {{0.6, 0.64, 0.48}, {-0.8, 0.48, 0.36}};

const Star kStars[] = {
    {"cone", [](int i, int n, Dice&) { return on_circle(double(i / 2 + i % 2) / n, -1); }},
    {"flat_fan",
     [](int i, int n, Dice&) {
       const Vec3d p = on_circle(0.9 * (i / 2 + i % 2) / n, 0);
       return p.x * kOblique[0] + p.y * kOblique[1];
     }},
    // Forth and back, so that every layer lies upon the others.
    {"folded_fan",
     [](int i, int, Dice&) {
       const int step = (i / 2 + i % 2) % 40;
       return on_circle(0.02 * std::min(step, 40 - step), 0);
     }},
    {"crossing_spokes",
     [](int i, int n, Dice& dice) { return on_circle((i / 2 + dice.real(0, 4)) / n, -1); }},
    {"wide_spokes", [](int, int, Dice& d) { return three_of([&] { return d.real(-1, 1); }); }},
    {"beam",  // all directions within 1e-9
     [](int i, int n, Dice& dice) {
       return Vec3d{1e9, 0, 0} + on_circle((i / 2 + dice.real(0, 2)) / n, 0);
     }},
    {"at_the_hub",  // vertices of their own at the place of the hub
     [](int i, int n, Dice&) {
       return i % 14 == 0 ? Vec3d{0, 0, 0} : on_circle(double(i / 2 + i % 2) / n, -1);
     }},
};

class PairsOfStars : public ::testing::TestWithParam<Star> {};

// Beside the star a slab of triangles without its hub, of which many pass through it, a smaller
// star inside of it, and a triangle through the hub.
TEST_P(PairsOfStars, AreThoseOfCgal) {
  constexpr int kSpokes = 420;
  Dice dice(11);
  IndexedMesh mesh;
  const auto add = [&](const Vec3d& a, const Vec3d& b, const Vec3d& c, std::uint32_t hub) {
    const auto next = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
    mesh.triangles.push_back({hub == kNoIndex ? next : hub, next + 1, next + 2});
  };
  const Vec3d place{0.1, -1.0 / 3, 0.7}, other = place + Vec3d{0.3, 0.2, -0.4};
  mesh.positions = {place, other};
  const auto rim = [&](int i) { return GetParam().rim(i, kSpokes, dice); };
  for (int t = 0; t < kSpokes; ++t) add(place, place + rim(2 * t), place + rim(2 * t + 1), 0);
  for (int t = 0; t < kSpokes; ++t) {
    const Vec3d a = rim(2 * t), b = rim(2 * t + 1);
    add(other, other + 0.4 * a, other + 0.4 * b, 1);
  }
  for (int t = 0; t < 60; ++t) {
    const Vec3d p = place + three_of([&] { return dice.real(-2, 2); });
    const auto near = [&] { return p + three_of([&] { return dice.real(-0.5, 0.5); }); };
    add(near(), near(), near(), kNoIndex);
  }
  add(place + Vec3d{1, 0, 0}, place + Vec3d{-1, 1, 0}, place + Vec3d{-1, -1, 0}, kNoIndex);
  const Buffer<std::uint32_t> hubs = hubs_of_triangles(mesh);
  ASSERT_EQ(std::ranges::count(hubs, 0u), kSpokes);
  ASSERT_EQ(std::ranges::count(hubs, 1u), kSpokes);
  EXPECT_EQ(intersecting_pairs(mesh), CgalPairs(mesh).all());
  // Huge, so that products overflow; tiny, so that they vanish; and with subnormal coordinates.
  for (const double scale : {0x1p990, 0x1p-700, 0x1p-1060}) {
    IndexedMesh scaled = mesh;
    for (Vec3d& p : scaled.positions) p = scale * p;
    EXPECT_EQ(intersecting_pairs(scaled), CgalPairs(scaled).all()) << scale;
  }
}

// Differences from the hub overflow, so that no direction is known.
TEST(PairsAtHubs, BeyondAllDoubles) {
  constexpr double kFar = 1.2e308;
  constexpr int kSpokes = 400;
  Dice dice(5);
  IndexedMesh mesh;
  mesh.positions = {{-kFar, -kFar, -kFar}};
  const auto part = [&] { return kFar * dice.real(0.5, 1); };
  for (std::uint32_t t = 0; t < kSpokes; ++t) {
    mesh.positions.insert(mesh.positions.end(), {three_of(part), three_of(part)});
    mesh.triangles.push_back({0, 2 * t + 1, 2 * t + 2});
  }
  ASSERT_EQ(std::ranges::count(hubs_of_triangles(mesh), 0u), kSpokes);
  EXPECT_EQ(intersecting_pairs(mesh), CgalPairs(mesh).all());
}

INSTANTIATE_TEST_SUITE_P(Kinds, PairsOfStars, ::testing::ValuesIn(kStars),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace vdwmesh
