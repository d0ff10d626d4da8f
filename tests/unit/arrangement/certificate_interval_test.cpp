// The parts of certificates: exact sums, intervals of doubles and of more bits, the rounding mode,
// and what becomes of intervals if it is wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "complex/power_predicates.hpp"
#include "core/errors.hpp"
#include "measures/certificate/simplex_terms.hpp"
#include "measures/certificate/upward_rounding.hpp"
#include "measures/certificate/wide_interval.hpp"
#include "measures/exact_sum.hpp"
#include "reference/union_oracle.hpp"

namespace vdwmesh::certificate {
namespace {

using reference::Digits;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLargest = std::numeric_limits<double>::max(), kLeast = 0x1p-1074;

ExactSum sum_of(const std::vector<double>& terms) {
  ExactSum sum;
  for (const double t : terms) sum.add(t);
  return sum;
}

TEST(ExactSum, RoundsOnceInTheDirectionAskedFor) {
  struct Case {
    std::vector<double> terms;
    double down, nearest, up;
  };
  const double next = 1 + 0x1p-52, second = 1 + 0x1p-51;
  const Case cases[] = {{{}, 0, 0, 0},
                        {{1, -1}, 0, 0, 0},
                        {{3, 0.25}, 3.25, 3.25, 3.25},
                        {{1, 0x1p-60}, 1, 1, next},
                        {{-1, -0x1p-60}, -next, -1, -1},
                        {{1, 0x1p-53}, 1, 1, next},               // a tie goes to the even one
                        {{next, 0x1p-53}, next, second, second},  // here upward
                        {{1, 0x1p-53, kLeast}, 1, next, next},
                        {{1, -kLeast}, 1 - 0x1p-53, 1, 1},
                        {{1e300, 1, -1e300}, 1, 1, 1},
                        {{kLeast, kLeast, kLeast}, 3 * kLeast, 3 * kLeast, 3 * kLeast},
                        {{kLargest, -kLeast}, std::nextafter(kLargest, 0), kLargest, kLargest},
                        {{kLargest, kLargest}, kLargest, kInfinity, kInfinity},
                        {{-kLargest, -kLargest}, -kInfinity, -kInfinity, -kLargest}};
  for (const Case& c : cases) {
    const ExactSum sum = sum_of(c.terms);
    EXPECT_EQ(sum.down(), c.down);
    EXPECT_EQ(sum.nearest(), c.nearest);
    EXPECT_EQ(sum.up(), c.up);
  }
}

TEST(ExactSum, DoesNotDependOnOrderOrSplitting) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> exponent(-1000, 900);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  std::vector<double> terms(1000);
  for (double& t : terms) t = std::ldexp(mantissa(random), exponent(random));
  const double expected = sum_of(terms).nearest();
  for (int run = 0; run < 10; ++run) {
    std::shuffle(terms.begin(), terms.end(), random);
    const auto middle = terms.begin() + 100 * run;
    ExactSum first = sum_of({terms.begin(), middle});
    first.add(sum_of({middle, terms.end()}));
    EXPECT_EQ(first.nearest(), expected);
  }
  // What is subtracted again leaves nothing.
  ExactSum sum = sum_of(terms);
  for (const double t : terms) sum.add(-t);
  EXPECT_EQ(sum.down(), 0);
  EXPECT_EQ(sum.up(), 0);
}

// Terms of one size, of all sizes, and with some that cannot be added in chunks.
TEST(ExactSum, ManyTermsAtOnceAreTheSame) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  for (const int range : {0, 30, 200, 1000}) {
    std::uniform_int_distribution<int> exponent(-range, range);
    for (const std::size_t count : {0u, 1u, 17u, 511u, 512u, 513u, 3000u}) {
      std::vector<double> terms(count);
      for (double& t : terms) t = std::ldexp(mantissa(random), exponent(random));
      ExactSum at_once;
      at_once.add(std::span<const double>(terms));
      for (const double t : terms) at_once.add(-t);
      EXPECT_EQ(at_once.down(), 0) << range << " " << count;
      EXPECT_EQ(at_once.up(), 0) << range << " " << count;
    }
  }
  ExactSum equal, small, infinite;
  equal.add(std::span<const double>(std::vector<double>(600, 0.1)));
  equal.add(std::span<const double>(std::vector<double>(600, -0.1)));
  EXPECT_EQ(equal.up(), 0);
  small.add(std::span<const double>(std::vector<double>(100, kLeast)));
  EXPECT_EQ(small.nearest(), 100 * kLeast);
  std::vector<double> terms(100, 1);
  terms[50] = std::nan("");
  infinite.add(std::span<const double>(terms));
  EXPECT_TRUE(std::isnan(infinite.nearest()));
}

TEST(ExactSum, IsTheSumOfItsTerms) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<int> exponent(-1070, 900);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  for (const double sign : {1.0, -1.0}) {
    for (int count = 0; count < 200; ++count) {
      ExactSum sum = sum_of({sign});
      for (int i = 0; i < count; ++i) sum.add(std::ldexp(mantissa(random), exponent(random)));
      std::vector<double> terms;
      sum.append_terms(terms);
      for (const double t : terms) sum.add(-t);
      EXPECT_EQ(sum.down(), 0);
      EXPECT_EQ(sum.up(), 0);
    }
  }
  std::vector<double> terms;
  sum_of({}).append_terms(terms);
  EXPECT_TRUE(terms.empty());
  sum_of({1, kInfinity}).append_terms(terms);
  EXPECT_TRUE(terms.size() == 1 && std::isnan(terms[0]));
}

TEST(ExactSum, IsNotANumberOnceATermIsNot) {
  EXPECT_TRUE(std::isnan(sum_of({1, kInfinity}).down()));
  EXPECT_TRUE(std::isnan(sum_of({std::nan(""), 1}).up()));
  ExactSum sum = sum_of({1});
  sum.add(sum_of({kInfinity}));
  EXPECT_TRUE(std::isnan(sum.nearest()));
}

TEST(UpwardRounding, IsCheckedAndPutBack) {
  EXPECT_NO_THROW(with_rounding(RoundingMode::upward, [] { require_upward_rounding(); }));
  EXPECT_THROW(require_upward_rounding(), InternalError);
  with_rounding(RoundingMode::upward, [] {
    EXPECT_THROW(with_rounding(RoundingMode::to_nearest, [] { require_upward_rounding(); }),
                 InternalError);
    EXPECT_NO_THROW(require_upward_rounding());
  });
  EXPECT_THROW(with_rounding(RoundingMode::upward, [] { throw InvalidInput("x"); }), InvalidInput);
  EXPECT_EQ(std::fegetround(), FE_TONEAREST);
}

bool contains(const Interval& x, const Digits& value) {
  return x.inf() <= value && value <= x.sup();
}
bool contains(const Interval& x, const Interval& inner) {
  return x.inf() <= inner.inf() && inner.sup() <= x.sup();
}

// Vectors in all directions of the upper half plane, many of them next to the axes, the diagonals
// and the directions between two of the table.
std::vector<std::array<double, 2>> vectors() {
  std::vector<std::array<double, 2>> out{{0, 1}, {0, -1}, {1, 0}, {1, 1}, {1, -1}, {1e-300, -1}};
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (int i = 0; i < 4000; ++i) {
    const double tiny = std::ldexp(coordinate(random), -i % 300);
    const double size = std::ldexp(1.0, i % 37 - 18);
    const double border = (i % 33 - 16 + 0.5) / 16 + (i % 2 == 0 ? tiny : 0);
    out.push_back({size * std::abs(coordinate(random)), size * coordinate(random)});
    out.push_back({std::abs(tiny), coordinate(random)});
    out.push_back({size, size * border});
    if (border > 0) out.push_back({size * border, i % 3 == 0 ? size : -size});
  }
  return out;
}

TEST(Interval, AngleContainsTheAngleAndLittleElse) {
  constexpr double kMostWidth = 0x1p-49;  // rad: four units in the last place of 3.14
  for (const auto& [y, x] : vectors()) {
    Interval a;
    with_rounding(RoundingMode::upward, [&, y = y, x = x] { a = angle(Interval(y), Interval(x)); });
    EXPECT_TRUE(contains(a, atan2(Digits(y), Digits(x)))) << y << " " << x;
    EXPECT_LE(a.sup() - a.inf(), kMostWidth) << y << " " << x;
  }
}

// The four corners of a box of vectors have angles in the interval, and a box around 0 has all.
TEST(Interval, AngleContainsThoseOfABox) {
  for (const auto& [y, x] : vectors()) {
    const double dy = y * 0x1p-40, dx = std::abs(x) * 0x1p-30;
    Interval a;
    with_rounding(RoundingMode::upward,
                  [&, y = y, x = x] { a = angle(Interval(y, y + dy), Interval(x, x + dx)); });
    for (const double v : {y, y + dy}) {
      for (const double u : {x, x + dx}) {
        EXPECT_TRUE(contains(a, atan2(Digits(v), Digits(u)))) << v << " " << u;
      }
    }
  }
  with_rounding(RoundingMode::upward, [] {
    EXPECT_TRUE(contains(angle(Interval(-1, 1), Interval(-1, 1)), Interval(0, 3.1415926535897931)));
    EXPECT_TRUE(contains(angle(Interval(0), Interval(0)), Interval(0, 3.1415926535897931)));
  });
}

// The results for ends u of x and v of y must be in the results for x and y.
void expect_results(const WideInterval& x, const WideInterval& y, double u, double v) {
  const Digits p(u), q(v);
  EXPECT_TRUE(contains(enclosure(x + y), Digits(p + q)));
  EXPECT_TRUE(contains(enclosure(x - y), Digits(p - q)));
  EXPECT_TRUE(contains(enclosure(x * y), Digits(p * q)));
  EXPECT_TRUE(contains(enclosure(square(x)), Digits(p * p)));
  if (v != 0) {
    EXPECT_TRUE(contains(enclosure(x / y), Digits(p / q)));
  }
  if (u < 0) return;
  EXPECT_TRUE(contains(enclosure(root(x)), Digits(sqrt(p))));
  if (u > 0 || v != 0) {
    EXPECT_TRUE(contains(enclosure(angle(x, y)), Digits(atan2(p, q)))) << u << " " << v;
  }
}

// With 53 bits, the least that there may be, the conversion to doubles hides no rounding.
class WideIntervalBits : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Bits, WideIntervalBits, ::testing::Values(53, 200));

TEST_P(WideIntervalBits, ContainsResultsOfAllSigns) {
  std::vector<Interval> intervals;
  for (const double low : {-3.0, -0.1, 0.0, 0.1, 7.0}) {
    for (const double high : {-3.0, -0.1, 0.0, 0.1, 7.0}) {
      if (low <= high) intervals.emplace_back(low, high);
    }
  }
  const Precision precision(GetParam());
  for (const Interval& x : intervals) {
    for (const Interval& y : intervals) {
      for (const double u : {x.inf(), x.sup()}) {
        for (const double v : {y.inf(), y.sup()}) expect_results(x, y, u, v);
      }
    }
    const bool has_zero = x.inf() <= 0 && x.sup() >= 0;
    EXPECT_EQ(enclosure(square(WideInterval(x))).inf() == 0, has_zero);
  }
}

TEST(WideInterval, MoreBitsAreNarrower) {
  double last = 1;
  for (const int bits : {64, 128, 256}) {
    const Precision precision(bits);
    const WideInterval third = WideInterval(1.0) / WideInterval(3.0);
    const double rest = width(enclosure(third * WideInterval(3.0) - WideInterval(1.0)));
    EXPECT_LT(rest, last * 0x1p-50);
    last = rest;
  }
}

// Random simplices of balls that have a point in common, with coefficients that are numbers, so
// that only rounding makes their terms wide. The terms of doubles must contain those of 256 bits.
struct Misses {
  int simplices = 0, edges = 0, triangles = 0, cells = 0;
};

bool contains(const MeasureTerms& x, const MeasureTerms& inner) {
  return contains(x.area, inner.area) && contains(x.volume, inner.volume);
}

template <class Evaluate>
auto in_mode(RoundingMode mode, Evaluate evaluate) {
  decltype(evaluate()) out;
  with_rounding(mode, [&] { out = evaluate(); });
  return out;
}

Misses misses_of(RoundingMode mode) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> coordinate(-0.4, 0.4), radius(0.7, 0.99);
  const Precision precision(256);
  constexpr Role kRole{true, true};
  const EdgeTerms coefficients{{0.7, 0.3}, {-0.6, -0.2}, 0.9, true};
  const Interval chord(0.4);
  Misses misses;
  for (int i = 0; i < 1500; ++i) {
    std::array<Sphere, 4> b;
    for (Sphere& s : b) {
      const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
      s = {{x, y, z}, radius(random)};
    }
    if (orientation_sign(b[0], b[1], b[2], b[3]) == Sign::negative) std::swap(b[2], b[3]);
    // Bounds within() hold for simplices of the dual complex only.
    if (size_sign(b[0], b[1], b[2], b[3]) == Sign::positive) continue;
    ++misses.simplices;
    const auto edge = [&]<class T>(const T&) {
      return edge_terms<T>({b[0], b[1]}, {kRole, kRole}, true);
    };
    const TriangleInput f{{b[0], b[1], b[2]},
                          {kRole, kRole, kRole},
                          {&coefficients, &coefficients, &coefficients},
                          2};
    const CellInput c{
        b,
        {kRole, kRole, kRole, kRole},
        {&coefficients, &coefficients, &coefficients, &coefficients, &coefficients, &coefficients},
        {&chord, &chord, &chord, &chord}};
    const EdgeTerms e = in_mode(mode, [&] { return edge(Interval()); }), ew = edge(WideInterval());
    misses.edges += !(contains(e.free_angle, ew.free_angle) && contains(e.height, ew.height));
    misses.triangles +=
        !contains(in_mode(mode, [&] { return triangle_terms<Interval>(f).corners; }),
                  triangle_terms<WideInterval>(f).corners);
    misses.cells += !contains(in_mode(mode, [&] { return cell_terms<Interval>(c); }),
                              cell_terms<WideInterval>(c));
  }
  return misses;
}

TEST(SimplexTerms, DoublesContainMoreBits) {
  const Misses misses = misses_of(RoundingMode::upward);
  EXPECT_GE(misses.simplices, 500);
  EXPECT_EQ(misses.edges, 0);
  EXPECT_EQ(misses.triangles, 0);
  EXPECT_EQ(misses.cells, 0);
}

// The test above would notice a processor that rounds to nearest.
TEST(SimplexTerms, WrongRoundingIsNoticed) {
  const Misses misses = misses_of(RoundingMode::to_nearest);
  EXPECT_GE(misses.edges, misses.simplices / 2);
  EXPECT_GE(misses.triangles, misses.simplices / 20);
  EXPECT_GE(misses.cells, misses.simplices / 10);
  RecordProperty("simplices", misses.simplices);
  RecordProperty("edges", misses.edges);
  RecordProperty("triangles", misses.triangles);
  RecordProperty("cells", misses.cells);
}

}  // namespace
}  // namespace vdwmesh::certificate
