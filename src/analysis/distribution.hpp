// Minimum, maximum, mean and percentiles of many values, without sorting them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "arrangement/exact_sum.hpp"

namespace vdwmesh {

// Returns the distribution of the values. A percentile is an element of the set: the p-th
// percentile of n values is the value of rank ceil(p n / 100), counted from 1. The mean is computed
// from an exact sum. So nothing depends on the order of the values or on the number of threads.
// Without values all members are NaN. Precondition: the values are at or above 0 and have no sign
// bit, so -0.0 is not allowed.
Distribution distribution_of(std::span<const double> values);

// ---- The steps of distribution_of(), for who has the values in parts ----

// The percentiles of a Distribution.
inline constexpr std::array<std::uint64_t, 3> kPercentiles{1, 50, 99};

// Values are counted in bins, 32 for each octave (a range from x to 2 x). The bin of a value are
// the upper 17 bits of the double: the sign bit (0), 11 bits of exponent and 5 bits of mantissa.
// The bit patterns of non-negative doubles, as integers, are in the order of the doubles, and so
// are the bins. Values with the sign bit set, which the contract excludes, go to the additional bin
// kValueBins, so that no index is out of range.
inline constexpr int kBitsInBin = 47;
inline constexpr std::size_t kValueBins = std::size_t{1} << (63 - kBitsInBin);
inline std::size_t bin_of_value(double value) {
  const std::uint64_t bin = std::bit_cast<std::uint64_t>(value) >> kBitsInBin;
  return bin < kValueBins ? static_cast<std::size_t>(bin) : kValueBins;
}

// What parts of a set of values add up to.
struct ValueSummary {
  ExactSum sum;
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
};
void add(ValueSummary& sum, const ValueSummary& other);

// Counts the values in kValueBins + 1 bins, and returns their summary. On all cores.
ValueSummary summarize_values(std::span<const double> values, std::vector<std::uint64_t>& counts);

// Where the percentile of `hundredths` stands: in which bin, and at which place among the sorted
// values of the bin, counted from 0. Precondition: there are values.
struct ValuePlace {
  std::size_t bin;
  std::uint64_t place;
};
ValuePlace place_of_percentile(const std::vector<std::uint64_t>& counts, std::uint64_t values,
                               std::uint64_t hundredths);

}  // namespace vdwmesh
