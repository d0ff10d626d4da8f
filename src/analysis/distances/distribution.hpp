// Minimum, maximum, mean and percentiles of many values, without sorting them and, where they are
// made block by block, without keeping them.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/buffer.hpp"
#include "measures/exact_sum.hpp"

namespace vdwmesh {

// Returns the distribution of the values. A percentile is an element of the set: the p-th
// percentile of n values is the value of rank ceil(p n / 100), counted from 1. The mean is computed
// from an exact sum. So nothing depends on the order of the values or on the number of threads.
// Without values all members are NaN. Precondition: the values are at or above 0 and have no sign
// bit, so -0.0 is not allowed.
Distribution distribution_of(std::span<const double> values);

// ---- The steps of distribution_of(), for who makes the values in blocks ----

// The percentiles of a Distribution.
inline constexpr std::array<std::uint64_t, 3> kPercentiles{1, 50, 99};

// Intervals in which the percentiles of a set are expected. Only values inside of them are kept.
// The intervals do not overlap and increase; there are one to three of them.
struct Brackets {
  struct Bracket {
    double lower = 0, upper = std::numeric_limits<double>::infinity();  // both inside
  };
  std::array<Bracket, kPercentiles.size()> intervals;
  std::size_t count = 1;
  std::array<std::size_t, kPercentiles.size()> of_percentile{};  // the interval of each
};

// One interval for all values, so that every value is kept and no percentile can be missed.
inline Brackets bracket_of_everything() { return {}; }
inline bool is_everything(const Brackets& brackets) {
  const auto& [lower, upper] = brackets.intervals[0];
  return brackets.count == 1 && lower == 0 && upper == std::numeric_limits<double>::infinity();
}

// Brackets from a sample of the set, in any order. The more it is like a random sample, the
// likelier the brackets contain the percentiles; a sample of 10,000 values leaves about a tenth of
// the set inside. Values that are NaN are left out.
Brackets brackets_from_sample(std::vector<double> sample);

// What parts of a set of values add up to.
struct ValueSummary {
  ExactSum sum;
  std::uint64_t count = 0;
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
  std::array<std::uint64_t, kPercentiles.size()> below{};  // values below each interval
};
void add(ValueSummary& sum, const ValueSummary& other);

// The rank of a percentile among `values` values, counted from 0. Precondition: there are values.
constexpr std::uint64_t rank_of_percentile(std::uint64_t values, std::uint64_t hundredths) {
  return (values * hundredths + 99) / 100 - 1;
}

// Takes values in blocks, from any number of threads, and keeps those inside of the brackets.
class BracketedValues {
 public:
  explicit BracketedValues(const Brackets& brackets) : brackets_(brackets) {}

  void add(std::span<const double> block);

  // The three functions below want that all blocks were added.
  const Brackets& brackets() const { return brackets_; }
  ValueSummary summary() const;
  // The values inside of interval i, in any order.
  Buffer<double> inside(std::size_t i) const;

 private:
  struct ThreadValues {
    ValueSummary summary;
    std::array<std::vector<double>, kPercentiles.size()> inside;
    std::vector<double> kept;  // those of the present block that are in some interval
  };

  Brackets brackets_;
  tbb::enumerable_thread_specific<ThreadValues> threads_;
};

// The distribution of a set whose parts add up to `all`. value_inside(i, rank) is the value of that
// rank among those inside of interval i, if there are so many. Nothing, or NaN, as below.
template <class ValueInside>
std::optional<Distribution> distribution_of(const ValueSummary& all, const Brackets& brackets,
                                            const ValueInside& value_inside) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (all.count == 0) return Distribution{kNone, kNone, kNone, kNone, kNone, kNone};
  std::array<double, kPercentiles.size()> percentiles;
  for (std::size_t p = 0; p < percentiles.size(); ++p) {
    const std::size_t i = brackets.of_percentile[p];
    const std::uint64_t rank = rank_of_percentile(all.count, kPercentiles[p]);
    std::optional<double> value;
    if (rank >= all.below[i]) value = value_inside(i, rank - all.below[i]);
    if (!value && !is_everything(brackets)) return std::nullopt;
    percentiles[p] = value.value_or(kNone);
  }
  const auto [p01, median, p99] = percentiles;
  return Distribution{all.min, p01,     median,
                      p99,     all.max, all.sum.nearest() / static_cast<double>(all.count)};
}

// The distribution of all values that were added. Nothing if a percentile is outside of its
// bracket: then the values have to be made again, for bracket_of_everything(). With that bracket
// there always is a result; percentiles are NaN where values that are NaN hide them.
std::optional<Distribution> distribution_of(const BracketedValues& values);

// The distribution of the values that add_all(values) adds to the BracketedValues that it gets: at
// first with brackets from the sample, and once more, for everything, if a percentile was missed.
template <class AddAll>
Distribution distribution_by_sample(std::vector<double> sample, const AddAll& add_all) {
  const auto with = [&](const Brackets& brackets) {
    BracketedValues values(brackets);
    add_all(values);
    return distribution_of(values);
  };
  const std::optional<Distribution> found = with(brackets_from_sample(std::move(sample)));
  return found ? *found : with(bracket_of_everything()).value();
}

}  // namespace vdwmesh
