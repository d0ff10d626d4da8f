// distribution_of(): exact percentiles of many values by a histogram and a selection.
//
//  1. One parallel pass counts the values in bins, 32 for each octave (a range from x to 2 x), and
//     computes the sum, the minimum and the maximum of each block of values.
//  2. The bin that contains each wanted rank follows from a running sum over the bins.
//  3. A second parallel pass copies the values in these bins, at most three, and std::nth_element
//     selects the wanted ranks among them.
//
// The rank of a value is its index in the sorted sequence of all values.
//
// Sums are exact, and a selection by rank does not depend on the order of its input. So nothing
// depends on how the values are divided among threads.
#include "analysis/distribution.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kValuesPerBlock = 1 << 14;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Adds one block. Minimum and maximum have four independent accumulators (lanes): in a single one
// every value would have to wait for the one before it.
void add_block(ValueSummary& summary, std::span<const double> values) {
  std::array<double, 4> min, max;
  min.fill(summary.min), max.fill(summary.max);
  summary.sum.add(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t lane = i % min.size();
    min[lane] = std::min(min[lane], values[i]);
    max[lane] = std::max(max[lane], values[i]);
  }
  summary.min = *std::min_element(min.begin(), min.end());
  summary.max = *std::max_element(max.begin(), max.end());
}

// Calls body(b, values of block b) on all cores.
template <class Body>
void for_blocks(std::span<const double> values, Body&& body) {
  for_each_block(values.size(), kValuesPerBlock,
                 [&](std::size_t b, std::size_t first, std::size_t last) {
                   body(b, values.subspan(first, last - first));
                 });
}

// Finds values by their rank. The constructor makes the first pass over the values, percentiles()
// the second one.
class OrderStatistics {
 public:
  explicit OrderStatistics(std::span<const double> values)
      : values_(values), summary_(summarize_values(values, counts_)) {}

  const ValueSummary& summary() const { return summary_; }

  // Returns three percentiles: hundredths[i] = 50, for example, asks for the median. Percentile i
  // is the value of rank ceil(hundredths[i] n / 100), where ranks count from 1 and n is the number
  // of values. Precondition: `hundredths` increase, so percentiles in the same bin are neighbours.
  //
  // The values of each bin are gathered once, for the first percentile i in it: bins[i] is the bin,
  // and inside[i] has its values. A later percentile in the same bin has kNoBin, and uses
  // inside[from], where `from` is the index of that first percentile. std::nth_element() changes
  // the order of inside[from], which later selections allow.
  std::array<double, 3> percentiles(const std::array<std::uint64_t, 3>& hundredths) const {
    std::array<ValuePlace, 3> places;
    Bins bins;
    for (std::size_t i = 0; i < bins.size(); ++i) {
      places[i] = place_of_percentile(counts_, values_.size(), hundredths[i]);
      const bool again = i > 0 && places[i].bin == places[i - 1].bin;
      bins[i] = again ? kNoBin : places[i].bin;
    }
    std::array<Buffer<double>, 3> inside = gather(bins);
    std::array<double, 3> result;
    for (std::size_t i = 0, from = 0; i < result.size(); ++i) {
      if (bins[i] != kNoBin) from = i;
      const auto place = inside[from].begin() + static_cast<std::ptrdiff_t>(places[i].place);
      std::nth_element(inside[from].begin(), place, inside[from].end());
      result[i] = *place;
    }
    return result;
  }

 private:
  using Bins = std::array<std::size_t, 3>;
  static constexpr std::size_t kNoBin = kValueBins + 1;  // bin_of_value() never returns it

  // Returns the values in each of the bins, in any order; no values for kNoBin. Every thread
  // collects the values of one block in `mine`, then reserves a part of the result by an atomic
  // addition and copies them there.
  std::array<Buffer<double>, 3> gather(const Bins& bins) const {
    std::array<Buffer<double>, 3> inside;
    std::array<std::atomic<std::size_t>, 3> next{};
    for (std::size_t i = 0; i < bins.size(); ++i)
      if (bins[i] != kNoBin) inside[i].resize(counts_[bins[i]]);
    tbb::enumerable_thread_specific<std::array<std::vector<double>, 3>> found;
    for_blocks(values_, [&](std::size_t, std::span<const double> block) {
      std::array<std::vector<double>, 3>& mine = found.local();
      for (const double value : block) {
        const std::size_t bin = bin_of_value(value);
        for (std::size_t i = 0; i < bins.size(); ++i)
          if (bin == bins[i]) mine[i].push_back(value);
      }
      for (std::size_t i = 0; i < bins.size(); ++i) {
        const std::size_t place = next[i].fetch_add(mine[i].size());
        std::copy(mine[i].begin(), mine[i].end(), inside[i].data() + place);
        mine[i].clear();
      }
    });
    return inside;
  }

  std::span<const double> values_;
  std::vector<std::uint64_t> counts_;
  ValueSummary summary_;
};

}  // namespace

void add(ValueSummary& sum, const ValueSummary& other) {
  sum.sum.add(other.sum);
  sum.min = std::min(sum.min, other.min);
  sum.max = std::max(sum.max, other.max);
}

// Each thread has a summary and a histogram of its own. The first histogram found becomes the
// counts, and the others are added to it.
ValueSummary summarize_values(std::span<const double> values, std::vector<std::uint64_t>& counts) {
  struct Own {
    ValueSummary summary;
    std::vector<std::uint64_t> counts = std::vector<std::uint64_t>(kValueBins + 1);
  };
  tbb::enumerable_thread_specific<Own> threads;
  for_blocks(values, [&](std::size_t, std::span<const double> block) {
    Own& mine = threads.local();
    for (const double value : block) ++mine.counts[bin_of_value(value)];
    add_block(mine.summary, block);
  });
  ValueSummary summary;
  counts.clear();
  for (Own& theirs : threads) {
    add(summary, theirs.summary);
    if (counts.empty()) {
      counts = std::move(theirs.counts);
    } else {
      for (std::size_t bin = 0; bin <= kValueBins; ++bin) counts[bin] += theirs.counts[bin];
    }
  }
  counts.resize(kValueBins + 1);  // if there are no values
  return summary;
}

// The rank of the percentile among all values is ceil(hundredths n / 100) - 1, counted from 0. The
// loop subtracts from it the counts of all bins before the percentile's bin.
ValuePlace place_of_percentile(const std::vector<std::uint64_t>& counts, std::uint64_t values,
                               std::uint64_t hundredths) {
  ValuePlace place{0, (values * hundredths + 99) / 100 - 1};
  for (; place.place >= counts[place.bin]; ++place.bin) place.place -= counts[place.bin];
  return place;
}

Distribution distribution_of(std::span<const double> values) {
  if (values.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone};
  const OrderStatistics ranks(values);
  const auto [p01, median, p99] = ranks.percentiles(kPercentiles);
  const ValueSummary& all = ranks.summary();
  return {all.min, p01,     median,
          p99,     all.max, all.sum.nearest() / static_cast<double>(values.size())};
}

}  // namespace vdwmesh
