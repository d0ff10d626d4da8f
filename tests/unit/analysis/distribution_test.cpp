// Percentiles against a full sort, the same on any number of threads.
#include "analysis/distances/distribution.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace vdwmesh {
namespace {

void expect_ranks(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  const auto of_rank = [&](std::size_t hundredths) {
    return sorted[(sorted.size() * hundredths + 99) / 100 - 1];
  };
  double mean = 0;
  for (const std::size_t threads : {1u, 3u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Distribution found = distribution_of(values);
    EXPECT_EQ(found.min, sorted.front());
    EXPECT_EQ(found.p01, of_rank(1));
    EXPECT_EQ(found.median, of_rank(50));
    EXPECT_EQ(found.p99, of_rank(99));
    EXPECT_EQ(found.max, sorted.back());
    if (threads > 1) {
      EXPECT_EQ(found.mean, mean);
    }
    mean = found.mean;
  }
}

TEST(Distribution, SpreadValues) {
  std::mt19937_64 random(5);
  for (const std::size_t count : {1u, 2u, 99u, 100u, 101u, 16'384u, 16'385u, 100'000u}) {
    SCOPED_TRACE(count);
    std::vector<double> values(count);
    for (double& value : values)
      value = std::exp(std::uniform_real_distribution<double>(-40, 40)(random));
    expect_ranks(values);
  }
}

// All three percentiles in one bin, two in one, and all values equal.
TEST(Distribution, ValuesClose) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> near_one(1.0, 1.02), near_two(2.0, 2.02);
  std::vector<double> values(50'000);
  for (double& value : values) value = near_one(random);
  expect_ranks(values);
  for (std::size_t i = 0; i < values.size(); i += 3) values[i] = near_two(random);
  expect_ranks(values);
  for (std::size_t i = 0; i < values.size(); i += 2) values[i] = near_two(random);
  expect_ranks(values);
  expect_ranks(std::vector<double>(50'000, 1.5));
  expect_ranks(std::vector<double>(50'000, 0.0));
}

TEST(Distribution, ExtremeValues) {
  std::vector<double> values(20'000, 1.0);
  for (std::size_t i = 0; i < 5000; ++i) {
    values[i] = 5e-324;
    values[19'999 - i] = 1e300;
  }
  expect_ranks(values);
}

// A sample of another set: no percentile is in its bracket, and it is said so. The bracket of
// everything always finds them.
TEST(Distribution, APercentileOutsideOfItsBracket) {
  const std::vector<double> values(1000, 2.0);
  for (const double elsewhere : {1.0, 3.0}) {
    BracketedValues bracketed(brackets_from_sample(std::vector<double>(100'000, elsewhere)));
    bracketed.add(values);
    EXPECT_FALSE(distribution_of(bracketed).has_value());
  }
  BracketedValues all(bracket_of_everything());
  all.add(values);
  EXPECT_EQ(distribution_of(all).value().median, 2);
}

// Values that begin otherwise than they go on, so that the sample of a part would mislead, and a
// period that the sample is in step with.
TEST(Distribution, ValuesInOrder) {
  std::vector<double> values(300'000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i / 1000);
  expect_ranks(values);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i % 19);
  expect_ranks(values);
  std::ranges::reverse(values);
  expect_ranks(values);
}

}  // namespace
}  // namespace vdwmesh
