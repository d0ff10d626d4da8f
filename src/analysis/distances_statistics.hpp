// Statistics of distances that come out the same however the work was cut.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "analysis/distances.hpp"

namespace vdwmesh {

// What one block of samples adds up to, in the order of its samples.
struct DistanceSums {
  double first = 0, second = 0, fourth = 0;  // sums of d, d², d⁴
  double max = 0;                            // Å
  std::uint64_t counted = 0;                 // of which these are the sums
  std::uint64_t samples = 0;                 // those for the maximum alone as well

  void add(double distance) {
    const double square = distance * distance;
    first += distance;
    second += square;
    fourth += square * square;
    ++counted;
    add_extreme(distance);
  }
  // Counts for the maximum alone.
  void add_extreme(double distance) {
    if (distance > max) max = distance;
    ++samples;
  }
};

// How many samples by distance, in bins of 1/256 octave.
class DistanceHistogram {
 public:
  DistanceHistogram() : bins_(kBins) {}

  void add(double distance) { ++bins_[bin_of(distance)]; }
  void add(const DistanceHistogram& other);
  // The middle of the bin that holds the percentile: least value with at least that fraction of
  // the samples at or below it. NaN without samples.
  double percentile(double fraction) const;

 private:
  // 2^-48 … 2^48 Å; the first bin takes all that is smaller, the last all that is larger.
  static constexpr int kOctaves = 96, kPerOctave = 256;
  static constexpr std::size_t kBins = std::size_t{kOctaves} * kPerOctave;
  static std::size_t bin_of(double distance);
  static double middle_of(std::size_t bin);

  std::vector<std::uint64_t> bins_;
};

// Joins the blocks in their order.
DistanceStatistics summarize(const std::vector<DistanceSums>& blocks,
                             const DistanceHistogram& histogram);

}  // namespace vdwmesh
