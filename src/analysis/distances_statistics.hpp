// Accumulators for distances whose result does not depend on the number of threads.
//
// Floating-point sums are kept for each block of samples (DistanceSums) and joined in the order of
// the blocks. Counts are integers (DistanceHistogram) and may be joined in any order.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "analysis/distances.hpp"

namespace vdwmesh {

// The sums over one block of samples, added in the order of the samples.
struct DistanceSums {
  double first = 0, second = 0, fourth = 0;  // sums of d, d² and d⁴ (Å, Å², Å⁴)
  double max = 0;                            // largest distance, Å
  std::uint64_t counted = 0;                 // how many distances are in the three sums
  std::uint64_t samples = 0;                 // how many distances are in `max`: counted or more

  // Adds a distance to the sums and to the maximum.
  void add(double distance) {
    const double square = distance * distance;
    first += distance;
    second += square;
    fourth += square * square;
    ++counted;
    add_extreme(distance);
  }
  // Adds a distance to the maximum only.
  void add_extreme(double distance) {
    if (distance > max) max = distance;
    ++samples;
  }
};

// The number of samples in each bin of distances, with 256 bins per octave (a range from x to 2 x).
// It gives percentiles without keeping or sorting the samples.
class DistanceHistogram {
 public:
  DistanceHistogram() : bins_(kBins) {}

  void add(double distance) { ++bins_[bin_of(distance)]; }
  void add(const DistanceHistogram& other);
  // Returns the nearest-rank percentile, rounded to the middle of its bin, Å. `fraction` is in
  // [0, 1]: at least this fraction of the samples lies in the bin or below. NaN without samples.
  double percentile(double fraction) const;

 private:
  // The bins cover 2^-48 … 2^48 Å. The first bin also counts all smaller distances, the last bin
  // all larger ones.
  static constexpr int kOctaves = 96, kPerOctave = 256;
  static constexpr std::size_t kBins = std::size_t{kOctaves} * kPerOctave;
  static std::size_t bin_of(double distance);
  static double middle_of(std::size_t bin);

  std::vector<std::uint64_t> bins_;
};

// Computes the statistics. The sums are joined in the order of the blocks.
DistanceStatistics summarize(const std::vector<DistanceSums>& blocks,
                             const DistanceHistogram& histogram);

}  // namespace vdwmesh
