// The filtered exact signs against the same definitions in 64-bit integers, where nothing rounds.
#include "complex/power_predicates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace vdwmesh {
namespace {

using Int = std::int64_t;

struct IntegerBall {
  Int x, y, z, r;
  Sphere sphere(double unit) const {
    return {{unit * static_cast<double>(x), unit * static_cast<double>(y),
             unit * static_cast<double>(z)},
            unit * static_cast<double>(r)};
  }
};

// Relative to ball a: coordinates, and power of the origin plus r_a².
struct Row {
  Int x, y, z, w;
};

Row row(const IntegerBall& a, const IntegerBall& b) {
  const Int x = b.x - a.x, y = b.y - a.y, z = b.z - a.z;
  return {x, y, z, x * x + y * y + z * z - b.r * b.r + a.r * a.r};
}

Int det3(const Row& a, const Row& b, const Row& c) {
  return a.x * (b.y * c.z - b.z * c.y) - a.y * (b.x * c.z - b.z * c.x) +
         a.z * (b.x * c.y - b.y * c.x);
}

Sign sign(Int value) {
  return value < 0 ? Sign::negative : (value > 0 ? Sign::positive : Sign::zero);
}

class Predicates : public ::testing::Test {
 protected:
  IntegerBall ball() {
    std::uniform_int_distribution<Int> place(-4, 4), radius(1, 4);
    return {place(random_), place(random_), place(random_), radius(random_)};
  }
  std::mt19937_64 random_{1};
};

// In units that double holds exactly, near 1 and far from it.
constexpr double kUnits[] = {1, 0x1p-200, 0x1p90};

TEST_F(Predicates, OrientationAndPowerSide) {
  for (int i = 0; i < 20000; ++i) {
    const IntegerBall p = ball(), q = ball(), r = ball(), s = ball(), t = ball();
    const Row a = row(t, p), b = row(t, q), c = row(t, r), d = row(t, s);
    // Laplace along the last column of the determinant of rows (x, y, z, w).
    const Int lifted =
        a.w * det3(b, c, d) - b.w * det3(a, c, d) + c.w * det3(a, b, d) - d.w * det3(a, b, c);
    for (const double u : kUnits) {
      EXPECT_EQ(orientation_sign(p.sphere(u), q.sphere(u), r.sphere(u), s.sphere(u)),
                sign(det3(row(p, q), row(p, r), row(p, s))));
      EXPECT_EQ(power_side(p.sphere(u), q.sphere(u), r.sphere(u), s.sphere(u), t.sphere(u)),
                sign(lifted));
    }
  }
}

TEST_F(Predicates, PowerSideIsPositiveInside) {
  const Sphere p{{0, 0, 0}, 1}, q{{4, 0, 0}, 1}, r{{0, 4, 0}, 1}, s{{0, 0, 4}, 1};
  ASSERT_EQ(orientation_sign(p, q, r, s), Sign::positive);
  EXPECT_EQ(power_side(p, q, r, s, {{1, 1, 1}, 1}), Sign::positive);
  EXPECT_EQ(power_side(p, q, r, s, {{9, 9, 9}, 1}), Sign::negative);
  EXPECT_EQ(power_side(p, q, r, s, {{4, 4, 4}, 1}), Sign::zero);
}

TEST_F(Predicates, EdgesTouchFromOutsideAndInside) {
  for (int i = 0; i < 20000; ++i) {
    const IntegerBall a = ball(), b = ball();
    const Row ab = row(a, b);
    const Int l2 = ab.x * ab.x + ab.y * ab.y + ab.z * ab.z;
    if (l2 == 0) continue;
    // The spheres meet in a circle, a point or not: (|r - s|)² <= l² <= (r + s)².
    const Int outer = l2 - (a.r + b.r) * (a.r + b.r), inner = l2 - (a.r - b.r) * (a.r - b.r);
    const Sign expected = outer > 0 || inner < 0     ? Sign::positive
                          : outer == 0 || inner == 0 ? Sign::zero
                                                     : Sign::negative;
    for (const double u : kUnits) EXPECT_EQ(size_sign(a.sphere(u), b.sphere(u)), expected);
  }
}

// The orthogonal centre of a triangle in the plane z = 0 and of a tetrahedron, from Cramer's rule.
TEST_F(Predicates, SizesAndSidesOfTrianglesAndTetrahedra) {
  for (int i = 0; i < 20000; ++i) {
    const IntegerBall a = ball(), b = ball(), c = ball(), d = ball();
    const Row e = row(a, b), f = row(a, c), g = row(a, d);
    const Int determinant = det3(e, f, g);
    if (determinant != 0) {
      const auto column = [&](int k) {
        Row m[3] = {e, f, g};
        for (Row& v : m) (k == 0 ? v.x : (k == 1 ? v.y : v.z)) = v.w;
        return det3(m[0], m[1], m[2]);
      };
      const Int x = column(0), y = column(1), z = column(2);
      EXPECT_EQ(size_sign(a.sphere(1), b.sphere(1), c.sphere(1), d.sphere(1)),
                sign(x * x + y * y + z * z - 4 * determinant * determinant * a.r * a.r));
    }
    IntegerBall b0 = b, c0 = c;
    b0.z = c0.z = a.z;
    const Row p = row(a, b0), q = row(a, c0);
    const Int area = p.x * q.y - p.y * q.x;
    if (area == 0) continue;
    const Int x = p.w * q.y - p.y * q.w, y = p.x * q.w - p.w * q.x;  // centre times 2 area
    EXPECT_EQ(size_sign(a.sphere(1), b0.sphere(1), c0.sphere(1)),
              sign(x * x + y * y - 4 * area * area * a.r * a.r));
    EXPECT_EQ(side_sign(a.sphere(1), b0.sphere(1), c0.sphere(1), d.sphere(1)),
              sign((g.w * area - g.x * x - g.y * y) * (area > 0 ? 1 : -1)));
  }
}

TEST_F(Predicates, SidesOfVerticesAndEdges) {
  for (int i = 0; i < 20000; ++i) {
    const IntegerBall a = ball(), b = ball(), d = ball();
    const Row ab = row(a, b), ad = row(a, d);
    const Int l2 = ab.x * ab.x + ab.y * ab.y + ab.z * ab.z;
    EXPECT_EQ(side_sign(a.sphere(1), d.sphere(1)), sign(ad.w));
    if (l2 == 0) continue;
    const Int along = ab.x * ad.x + ab.y * ad.y + ab.z * ad.z;
    EXPECT_EQ(side_sign(a.sphere(1), b.sphere(1), d.sphere(1)), sign(ad.w * l2 - ab.w * along));
    EXPECT_EQ(plane_between_centers(a.sphere(1), b.sphere(1)), ab.w > 0 && 2 * l2 - ab.w > 0);
  }
}

// Spheres through the origin whose integer radii are much larger than the distances between their
// centres: by the identity (a² + b² - c² - d²)² + (2bc + 2ad)² + (2bd - 2ac)² = (a² + b² + c² +
// d²)². The value is exactly 0 and cancels from terms of 10^60, so that a bound on its rounding
// that forgets the radii would let the sign of the rounding through.
TEST_F(Predicates, LargeSpheresThroughOnePoint) {
  const auto through_origin = [](Int a, Int b, Int c, Int d) {
    return IntegerBall{a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c),
                       a * a + b * b + c * c + d * d}
        .sphere(1);
  };
  int tetrahedra = 0;
  std::uniform_int_distribution<Int> large(100'000, 100'020), small(-3, 3);
  for (int i = 0; i < 2000; ++i) {
    const auto ball = [&] {
      return through_origin(large(random_), small(random_), small(random_), small(random_));
    };
    const Sphere a = ball(), b = ball(), c = ball(), d = ball();
    if (orientation_sign(a, b, c, d) == Sign::zero) continue;
    ++tetrahedra;
    EXPECT_EQ(size_sign(a, b, c, d), Sign::zero);
  }
  EXPECT_GT(tetrahedra, 1000);
}

// 0.1 + 0.2 and the like: tangency is that of the doubles given, not of rounded squares.
TEST_F(Predicates, RadiiAreSquaredExactly) {
  const double r = 1.7;
  EXPECT_EQ(size_sign({{0, 0, 0}, r}, {{2 * r, 0, 0}, r}), Sign::zero);
  EXPECT_EQ(size_sign({{0, 0, 0}, r}, {{std::nextafter(2 * r, 4.0), 0, 0}, r}), Sign::positive);
  EXPECT_EQ(size_sign({{0, 0, 0}, r}, {{std::nextafter(2 * r, 0.0), 0, 0}, r}), Sign::negative);
}

}  // namespace
}  // namespace vdwmesh
