#include "analysis/distribution.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/sum.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kValuesPerBlock = 1 << 14;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Summary {
  WideSum sum;
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void add(const Summary& other) {
    sum.add(other.sum);
    min = std::min(min, other.min);
    max = std::max(max, other.max);
  }
};

// Four sums side by side: each addition waits for the one before it.
Summary summarize_block(std::span<const double> values) {
  std::array<Summary, 4> lanes;
  for (std::size_t i = 0; i < values.size(); ++i) {
    Summary& lane = lanes[i % lanes.size()];
    lane.sum.add(values[i]);
    lane.min = std::min(lane.min, values[i]);
    lane.max = std::max(lane.max, values[i]);
  }
  for (std::size_t l = 1; l < lanes.size(); ++l) lanes[0].add(lanes[l]);
  return lanes[0];
}

Summary summarize_all(std::span<const double> values) {
  std::vector<Summary> blocks((values.size() + kValuesPerBlock - 1) / kValuesPerBlock);
  tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
    const std::size_t begin = b * kValuesPerBlock;
    blocks[b] =
        summarize_block(values.subspan(begin, std::min(kValuesPerBlock, values.size() - begin)));
  });
  Summary all;
  for (const Summary& block : blocks) all.add(block);
  return all;
}

// The bits of a double that is not negative rise with it, so the upper ones are a bin: 32 of them
// in an octave.
constexpr int kLowerBits = 47;
constexpr std::size_t kBins = std::size_t{1} << (63 - kLowerBits);
std::size_t bin_of(double value) { return std::bit_cast<std::uint64_t>(value) >> kLowerBits; }

class Ranks {
 public:
  explicit Ranks(std::span<const double> values) : values_(values), counts_(kBins + 1) {
    for (const double value : values) ++counts_[std::min(bin_of(value), kBins)];
  }

  // The values of rank ceil(hundredths n / 100), counted from 1, from one more look at all values.
  std::array<double, 3> percentiles(const std::array<std::size_t, 3>& hundredths) const {
    std::array<Wanted, 3> wanted;
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = find(hundredths[i]);
    for (const double value : values_) {
      const std::size_t bin = std::min(bin_of(value), kBins);
      for (Wanted& w : wanted)
        if (bin == w.bin) w.inside.push_back(value);
    }
    std::array<double, 3> result;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const auto place = wanted[i].inside.begin() + static_cast<std::ptrdiff_t>(wanted[i].rank);
      std::nth_element(wanted[i].inside.begin(), place, wanted[i].inside.end());
      result[i] = *place;
    }
    return result;
  }

 private:
  // A percentile: its bin, its rank among the values inside.
  struct Wanted {
    std::size_t bin = 0, rank = 0;
    std::vector<double> inside;
  };
  Wanted find(std::size_t hundredths) const {
    Wanted w;
    w.rank = (values_.size() * hundredths + 99) / 100 - 1;
    for (; w.rank >= counts_[w.bin]; ++w.bin) w.rank -= counts_[w.bin];
    w.inside.reserve(counts_[w.bin]);
    return w;
  }

  std::span<const double> values_;
  std::vector<std::size_t> counts_;
};

}  // namespace

Distribution distribution_of(std::span<const double> values) {
  if (values.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone};
  const Summary all = summarize_all(values);
  const auto [p01, median, p99] = Ranks(values).percentiles({1, 50, 99});
  return {all.min, p01, median, p99, all.max, all.sum.value() / static_cast<double>(values.size())};
}

}  // namespace vdwmesh
