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

  // The value of rank ceil(hundredths n / 100), counted from 1.
  double percentile(std::size_t hundredths) const {
    std::size_t rank = (values_.size() * hundredths + 99) / 100 - 1;
    std::size_t bin = 0;
    for (; rank >= counts_[bin]; ++bin) rank -= counts_[bin];
    std::vector<double> inside;
    inside.reserve(counts_[bin]);
    for (const double value : values_)
      if (std::min(bin_of(value), kBins) == bin) inside.push_back(value);
    const auto place = inside.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(inside.begin(), place, inside.end());
    return *place;
  }

 private:
  std::span<const double> values_;
  std::vector<std::size_t> counts_;
};

}  // namespace

Distribution distribution_of(std::span<const double> values) {
  if (values.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone};
  const Summary all = summarize_all(values);
  const Ranks ranks(values);
  return {all.min,
          ranks.percentile(1),
          ranks.percentile(50),
          ranks.percentile(99),
          all.max,
          all.sum.value() / static_cast<double>(values.size())};
}

}  // namespace vdwmesh
