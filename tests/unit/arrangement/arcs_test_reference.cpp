// Exact area and volume from exposed arcs against independent sources: tabulated unions, and
// slices integrated numerically.
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>

#include "measures/arcs/arcs.hpp"
#include "measures/total_measures.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh {
namespace {

constexpr double kPi = std::numbers::pi;

// Relative, issue 3; the table has twelve digits.
constexpr double kTable = 1e-10;
constexpr double kTableDegenerate = 1e-9;

std::vector<Sphere> read_spheres(const std::filesystem::path& path, double probe) {
  gzFile file = gzopen(path.c_str(), "rb");  // reads plain files as well
  std::vector<Sphere> spheres;
  char line[256];
  while (gzgets(file, line, sizeof line)) {
    std::istringstream fields(line);
    Sphere s;
    fields >> s.center.x >> s.center.y >> s.center.z >> s.radius;
    s.radius += probe;
    spheres.push_back(s);
  }
  gzclose(file);
  return spheres;
}

TEST(ArcsReference, EveryTabulatedUnion) {
  VDWMESH_NEEDS_SHARED("reference/union_of_balls.csv");
  std::ifstream table(testing::shared_path("reference/union_of_balls.csv"));
  std::string line;
  std::getline(table, line);
  int rows = 0;
  for (; std::getline(table, line); ++rows) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::string name;
    std::size_t balls = 0;
    double probe = 0, area = 0, volume = 0;
    fields >> name >> balls >> probe >> area >> volume;
    std::filesystem::path path = testing::shared_path("reference/" + name + ".xyzr");
    if (!exists(path)) path += ".gz";
    const SphereSet spheres(read_spheres(path, probe));
    ASSERT_EQ(spheres.size(), balls) << name;
    const ArcMeasures m = arc_measures(spheres);
    const bool degenerate = name == "cube" || name == "benzene";
    const double tolerance = degenerate ? kTableDegenerate : kTable;
    const SphereMeasures sum = total_measures(m.per_sphere);
    EXPECT_TRUE(std::abs(sum.area - area) <= tolerance * area) << line << ": " << sum.area;
    EXPECT_TRUE(std::abs(sum.volume - volume) <= tolerance * volume) << line << ": " << sum.volume;
    EXPECT_LE(m.suspect.size(), degenerate ? balls : balls / 1000) << line;
  }
  EXPECT_EQ(rows, 50);
}

// Lee & Richards 1971: exposed area by slices, exact within each; volume likewise, each slice a
// union of disks whose area is the integral of (x dy - y dx) / 2 over its exposed arcs.
struct Slices {
  std::vector<double> area;  // per sphere
  double volume = 0;
};

struct Disk {
  double x, y, r;
  std::size_t sphere;
};

// The exposed arcs [from, to] of disk k.
std::vector<std::pair<double, double>> exposed_arcs(const std::vector<Disk>& disks, std::size_t k) {
  std::vector<std::pair<double, double>> covered;
  const Disk& a = disks[k];
  for (std::size_t j = 0; j < disks.size(); ++j) {
    const Disk& b = disks[j];
    const double dx = b.x - a.x, dy = b.y - a.y, d = std::hypot(dx, dy);
    if (j == k || d >= a.r + b.r || d + b.r <= a.r) continue;
    if (d + a.r <= b.r) return {};
    const double middle = std::atan2(dy, dx);
    const double half = std::acos((d * d + a.r * a.r - b.r * b.r) / (2 * d * a.r));
    for (const double turn : {-2 * kPi, 0.0, 2 * kPi}) {
      covered.emplace_back(middle - half + turn, middle + half + turn);
    }
  }
  std::sort(covered.begin(), covered.end());
  std::vector<std::pair<double, double>> exposed;
  double at = -kPi;
  for (const auto& [from, to] : covered) {
    if (from > kPi) break;
    if (from > at) exposed.emplace_back(at, from);
    at = std::max(at, to);
  }
  if (at < kPi) exposed.emplace_back(at, kPi);
  return exposed;
}

Slices integrate_slices(const std::vector<Sphere>& spheres, int count) {
  double lower = 1e300, upper = -1e300;
  for (const Sphere& s : spheres) {
    lower = std::min(lower, s.center.z - s.radius);
    upper = std::max(upper, s.center.z + s.radius);
  }
  const double step = (upper - lower) / count;
  Slices sums{std::vector<double>(spheres.size()), 0};
  for (int slice = 0; slice < count; ++slice) {
    const double z = lower + (slice + 0.5) * step;
    std::vector<Disk> disks;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const Sphere& s = spheres[i];
      const double squared = s.radius * s.radius - (z - s.center.z) * (z - s.center.z);
      if (squared > 0) disks.push_back({s.center.x, s.center.y, std::sqrt(squared), i});
    }
    for (std::size_t k = 0; k < disks.size(); ++k) {
      const Disk& d = disks[k];
      for (const auto& [from, to] : exposed_arcs(disks, k)) {
        sums.area[d.sphere] += spheres[d.sphere].radius * (to - from) * step;
        const double along =
            d.x * (std::sin(to) - std::sin(from)) - d.y * (std::cos(to) - std::cos(from));
        sums.volume += 0.5 * d.r * (d.r * (to - from) + along) * step;
      }
    }
  }
  return sums;
}

// Midpoint rule: at each pole a circle appears at once, which costs up to half a step of it; an arc
// that opens at some other height does so like a square root, which costs (step / r)^1.5 of the
// circle. The smallest radius here is 1, the largest `radius`, the number of such places < 30.
double slice_tolerance(double step, double radius) {
  return 2 * kPi * (radius * step + 30 * std::pow(step, 1.5));
}

void expect_slices_agree(const std::vector<Sphere>& spheres, double height) {
  const int count = 20000;
  const double tolerance = slice_tolerance(height / count, 1.8);
  const Slices slices = integrate_slices(spheres, count);
  const ArcMeasures m = arc_measures(SphereSet(spheres));
  EXPECT_TRUE(m.suspect.empty());
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    EXPECT_TRUE(std::abs(m.per_sphere[i].area - slices.area[i]) <= tolerance)
        << "sphere " << i << ": " << m.per_sphere[i].area << ", by slices " << slices.area[i];
  }
  const double volume = total_measures(m.per_sphere).volume;
  EXPECT_TRUE(std::abs(volume - slices.volume) <= tolerance)
      << volume << ", by slices " << slices.volume;
}

TEST(ArcsReference, ThreeMutuallyOverlappingBalls) {
  expect_slices_agree({{{0, 0, 0}, 1.5}, {{1.2, 0.1, 0.3}, 1.3}, {{0.4, 1.1, -0.2}, 1.7}}, 4);
}

TEST(ArcsReference, RandomClusters) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(0, 3.5), radius(1, 1.8);
  for (int set = 0; set < 5; ++set) {
    std::vector<Sphere> spheres(14);
    for (Sphere& s : spheres) {
      s = {{place(random), place(random), place(random)}, radius(random)};
    }
    expect_slices_agree(spheres, 7.1);
  }
}

TEST(ArcsReference, SmallBallsOnAGiant) {
  std::vector<Sphere> spheres{{{0, 0, 0}, 6}};
  std::mt19937_64 random(8);
  std::normal_distribution<double> direction;
  for (int i = 0; i < 60; ++i) {
    Vec3d u{direction(random), direction(random), direction(random)};
    u = (6.2 / norm(u)) * u;
    spheres.push_back({u, 1});
  }
  const Slices slices = integrate_slices(spheres, 20000);
  const ArcMeasures m = arc_measures(SphereSet(spheres));
  const double tolerance = 6 * slice_tolerance(14.4 / 20000, 6);
  EXPECT_TRUE(std::abs(m.per_sphere[0].area - slices.area[0]) <= tolerance)
      << m.per_sphere[0].area << ", by slices " << slices.area[0];
  const double volume = total_measures(m.per_sphere).volume;
  EXPECT_TRUE(std::abs(volume - slices.volume) <= tolerance)
      << volume << ", by slices " << slices.volume;
}

}  // namespace
}  // namespace vdwmesh
