// Accumulators for distances whose result does not depend on the number of threads.
//
// Floating-point sums are kept for each block of samples (DistanceSums) and joined in the order of
// the blocks. Counts are integers (DistanceHistogram) and may be joined in any order.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/distances.hpp"
#include "core/host_device.hpp"

namespace vdwmesh {

// The sums over one block of samples, added in the order of the samples.
struct DistanceSums {
  double first = 0, second = 0, fourth = 0;  // sums of d, d² and d⁴ (Å, Å², Å⁴)
  double max = 0;                            // largest distance, Å
  std::uint64_t counted = 0;                 // how many distances are in the three sums
  std::uint64_t samples = 0;                 // how many distances are in `max`: counted or more

  // Adds a distance to the sums and to the maximum.
  VDWMESH_HD void add(double distance) {
    const double square = distance * distance;
    first += distance;
    second += square;
    fourth += square * square;
    ++counted;
    add_extreme(distance);
  }
  // Adds a distance to the maximum only.
  VDWMESH_HD void add_extreme(double distance) { add_extremes(1, distance); }
  // Adds `count` distances to the maximum only. `largest` is at least the largest of them, and at
  // most the maximum of all blocks together, which the joined sums then have.
  VDWMESH_HD void add_extremes(std::uint64_t count, double largest) {
    if (largest > max) max = largest;
    samples += count;
  }
};

// Bins of distances, 256 per octave (a range from x to 2 x), for host and device. The bins cover
// 2^-48 … 2^48 Å. The first bin also counts all smaller distances, the last bin all larger ones.
//
// The bin of a distance follows from the bits of the double: its exponent and the leading 8 bits of
// its mantissa form a key, and the bin number is the key less the key of the first bin. Every
// octave thus has 256 bins of equal width.
struct DistanceBins {
  static constexpr int kOctaves = 96, kPerOctave = 256;
  static constexpr std::size_t kCount = std::size_t{kOctaves} * kPerOctave;

  // The bit patterns of doubles >= 0, as integers, have the same order as the doubles. A shift that
  // keeps the exponent and kBinBits of the mantissa therefore gives keys in order of distance. Keys
  // below kFirstKey go to bin 0, and keys beyond the last bin go to the last bin.
  VDWMESH_HD static std::size_t bin_of(double distance) {
    const std::uint64_t key = std::bit_cast<std::uint64_t>(distance) >> (kMantissaBits - kBinBits);
    const std::uint64_t bin = key > kFirstKey ? key - kFirstKey : 0;
    return bin < kCount ? bin : kCount - 1;
  }
  // Returns the middle of a bin, Å. The first bin, which contains all small distances down to 0,
  // has the value 0.
  static double middle_of(std::size_t bin);

 private:
  // A key is the exponent of a double with its first kBinBits mantissa bits. kFirstKey is the key
  // of 2^kFirstExponent Å, where the first bin begins.
  static constexpr int kMantissaBits = 52, kBinBits = 8, kExponentBias = 1023, kFirstExponent = -48;
  static constexpr std::uint64_t kFirstKey =
      static_cast<std::uint64_t>(kExponentBias + kFirstExponent) << kBinBits;
};

// The number of samples in each bin. It gives percentiles without keeping or sorting the samples.
class DistanceHistogram {
 public:
  DistanceHistogram() : bins_(DistanceBins::kCount) {}

  void add(double distance) { ++bins_[DistanceBins::bin_of(distance)]; }
  void add(const DistanceHistogram& other) { add(other.bins_); }
  // Adds the counts of all bins.
  void add(std::span<const std::uint64_t> counts);
  // Returns the nearest-rank percentile, rounded to the middle of its bin, Å. `fraction` is in
  // [0, 1]: at least this fraction of the samples lies in the bin or below. NaN without samples.
  double percentile(double fraction) const;

 private:
  std::vector<std::uint64_t> bins_;
};

// Computes the statistics. The sums are joined in the order of the blocks.
DistanceStatistics summarize(const std::vector<DistanceSums>& blocks,
                             const DistanceHistogram& histogram);

}  // namespace vdwmesh
