#include "analysis/distribution.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>
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

// The bits of a double that is not negative rise with it, so the upper ones are a bin: 32 of them
// in an octave.
constexpr int kLowerBits = 47;
constexpr std::size_t kBins = std::size_t{1} << (63 - kLowerBits);
std::size_t bin_of(double value) {
  return std::min<std::size_t>(std::bit_cast<std::uint64_t>(value) >> kLowerBits, kBins);
}

// Calls body(b, values of block b) on all cores.
template <class Body>
void for_blocks(std::span<const double> values, Body&& body) {
  const std::size_t blocks = (values.size() + kValuesPerBlock - 1) / kValuesPerBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
    const std::size_t begin = b * kValuesPerBlock;
    body(b, values.subspan(begin, std::min(kValuesPerBlock, values.size() - begin)));
  });
}

// Values by rank, in two looks at all of them: how many there are in each bin, then those in the
// bins that matter.
class Ranks {
 public:
  explicit Ranks(std::span<const double> values) : values_(values) {
    std::vector<Summary> blocks((values.size() + kValuesPerBlock - 1) / kValuesPerBlock);
    tbb::enumerable_thread_specific<std::vector<std::size_t>> counts;
    for_blocks(values, [&](std::size_t b, std::span<const double> block) {
      std::vector<std::size_t>& mine = counts.local();
      mine.resize(kBins + 1);
      for (const double value : block) ++mine[bin_of(value)];
      blocks[b] = summarize_block(block);
    });
    for (const Summary& block : blocks) summary_.add(block);
    for (std::vector<std::size_t>& theirs : counts) {
      if (counts_.empty()) {
        counts_ = std::move(theirs);
      } else {
        for (std::size_t bin = 0; bin <= kBins; ++bin) counts_[bin] += theirs[bin];
      }
    }
  }

  const Summary& summary() const { return summary_; }

  // The values of rank ceil(hundredths n / 100), counted from 1.
  std::array<double, 3> percentiles(const std::array<std::size_t, 3>& hundredths) const {
    std::array<Wanted, 3> wanted;
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = find(hundredths[i]);
    using Inside = std::array<std::vector<double>, 3>;
    tbb::enumerable_thread_specific<Inside> inside;
    for_blocks(values_, [&](std::size_t, std::span<const double> block) {
      Inside& mine = inside.local();
      for (const double value : block) {
        const std::size_t bin = bin_of(value);
        for (std::size_t i = 0; i < wanted.size(); ++i)
          if (bin == wanted[i].bin) mine[i].push_back(value);
      }
    });
    std::array<double, 3> result;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      std::vector<double> all;
      for (Inside& theirs : inside) {
        if (all.empty()) {
          all = std::move(theirs[i]);
        } else {
          all.insert(all.end(), theirs[i].begin(), theirs[i].end());
        }
      }
      const auto place = all.begin() + static_cast<std::ptrdiff_t>(wanted[i].rank);
      std::nth_element(all.begin(), place, all.end());
      result[i] = *place;
    }
    return result;
  }

 private:
  // A percentile: its bin, its rank among the values inside.
  struct Wanted {
    std::size_t bin = 0, rank = 0;
  };
  Wanted find(std::size_t hundredths) const {
    Wanted w;
    w.rank = (values_.size() * hundredths + 99) / 100 - 1;
    for (; w.rank >= counts_[w.bin]; ++w.bin) w.rank -= counts_[w.bin];
    return w;
  }

  std::span<const double> values_;
  Summary summary_;
  std::vector<std::size_t> counts_;
};

}  // namespace

Distribution distribution_of(std::span<const double> values) {
  if (values.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone};
  const Ranks ranks(values);
  const auto [p01, median, p99] = ranks.percentiles({1, 50, 99});
  const Summary& all = ranks.summary();
  return {all.min, p01, median, p99, all.max, all.sum.value() / static_cast<double>(values.size())};
}

}  // namespace vdwmesh
