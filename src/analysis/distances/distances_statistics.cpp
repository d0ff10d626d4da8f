// Percentiles from the histogram of distances, and the statistics that distances() reports.
// summarize() joins the sums of the blocks, and estimates standard errors from the sums of d² and
// d⁴.
#include "analysis/distances/distances_statistics.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/sum.hpp"

namespace vdwmesh {
namespace {

// Returns the standard error of the mean of n independent values, given their mean and the mean of
// their squares; NaN for n < 2. `variance` is the variance of the sample; n / (n - 1) times it
// estimates the variance of the values, and that divided by n the variance of their mean. Rounding
// may make `variance` negative, which counts as 0.
double standard_error(double mean, double mean_square, double n) {
  const double variance = mean_square - mean * mean;
  if (!(n >= 2)) return std::numeric_limits<double>::quiet_NaN();
  return variance < 0 ? 0 : std::sqrt(variance / (n - 1));
}

}  // namespace

// The key of the bin, followed by zeros, is the bin's smallest double; with the highest of these
// zeros set it is the middle.
double DistanceBins::middle_of(std::size_t bin) {
  if (bin == 0) return 0;
  const std::uint64_t half = std::uint64_t{1} << (kMantissaBits - kBinBits - 1);
  return std::bit_cast<double>(((kFirstKey + bin) << (kMantissaBits - kBinBits)) + half);
}

void DistanceHistogram::add(std::span<const std::uint64_t> counts) {
  for (std::size_t i = 0; i < bins_.size(); ++i) bins_[i] += counts[i];
}

// The rank that belongs to `fraction` is ceil(fraction · total), counted from 1 and at least 1. The
// first bin up to whose end so many values lie contains the value of that rank.
double DistanceHistogram::percentile(double fraction) const {
  std::uint64_t total = 0;
  for (const std::uint64_t count : bins_) total += count;
  if (total == 0) return std::numeric_limits<double>::quiet_NaN();
  const double wanted = std::max(1.0, std::ceil(fraction * static_cast<double>(total)));
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < bins_.size(); ++i) {
    below += bins_[i];
    if (static_cast<double>(below) >= wanted) return DistanceBins::middle_of(i);
  }
  return DistanceBins::middle_of(bins_.size() - 1);
}

DistanceStatistics summarize(const std::vector<DistanceSums>& blocks,
                             const DistanceHistogram& histogram) {
  WideSum first, second, fourth;
  double max = 0;
  std::uint64_t counted = 0, samples = 0;
  for (const DistanceSums& block : blocks) {
    first.add(block.first);
    second.add(block.second);
    fourth.add(block.fourth);
    max = std::max(max, block.max);
    counted += block.counted;
    samples += block.samples;
  }
  const auto n = static_cast<double>(counted);
  const double mean = first.value() / n, square = second.value() / n, rms = std::sqrt(square);
  // `square` is a mean, of d², and its standard error follows from the mean of d⁴. The RMS is the
  // square root of `square`; by first-order error propagation its error is the error of `square`
  // times the derivative 1 / (2 rms).
  const double mean_error = standard_error(mean, square, n);
  const double square_error = standard_error(square, fourth.value() / n, n);
  const double rms_error = square_error > 0 ? square_error / (2 * rms) : square_error;
  // The middle of the bin of the largest distance may exceed that distance; max is then reported.
  // The comparison keeps a percentile that is NaN, which std::min(max, value) would drop.
  const auto percentile = [&](double fraction) {
    const double value = histogram.percentile(fraction);
    return value > max ? max : value;
  };
  return {mean, rms,        percentile(0.50), percentile(0.95), percentile(0.99),
          max,  mean_error, rms_error,        samples};
}

}  // namespace vdwmesh
