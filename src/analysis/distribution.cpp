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
// The blocks have a fixed size and their sums are joined in order, so the mean does not depend on
// the number of threads. A selection by rank does not depend on the order of its input.
#include "analysis/distribution.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kValuesPerBlock = 1 << 14;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Sum, minimum and maximum of a set of values.
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

// Summarises one block with four independent accumulators (lanes). In a single accumulator every
// addition would have to wait for the one before it.
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

// Returns the bin of a value: the upper 17 bits of the double, which are the sign bit (0), 11 bits
// of exponent and 5 bits of mantissa, thus 32 bins in an octave. The bit patterns of non-negative
// doubles, as integers, are in the order of the doubles, and so are the bins. The contract of
// distribution_of() excludes values with the sign bit set; they go to the additional bin kBins, so
// that no index is out of range.
constexpr int kLowerBits = 47;
constexpr std::size_t kBins = std::size_t{1} << (63 - kLowerBits);
std::size_t bin_of(double value) {
  return std::min<std::size_t>(std::bit_cast<std::uint64_t>(value) >> kLowerBits, kBins);
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
  explicit OrderStatistics(std::span<const double> values) : values_(values) {
    std::vector<Summary> blocks(block_count(values.size(), kValuesPerBlock));
    tbb::enumerable_thread_specific<std::vector<std::size_t>> counts;
    for_blocks(values, [&](std::size_t b, std::span<const double> block) {
      std::vector<std::size_t>& mine = counts.local();
      mine.resize(kBins + 1);
      for (const double value : block) ++mine[bin_of(value)];
      blocks[b] = summarize_block(block);
    });
    for (const Summary& block : blocks) summary_.add(block);
    // Each thread has counted into a histogram of its own. The first one found becomes counts_, and
    // the others are added to it.
    for (std::vector<std::size_t>& theirs : counts) {
      if (counts_.empty()) {
        counts_ = std::move(theirs);
      } else {
        for (std::size_t bin = 0; bin <= kBins; ++bin) counts_[bin] += theirs[bin];
      }
    }
  }

  const Summary& summary() const { return summary_; }

  // Returns three percentiles: hundredths[i] = 50, for example, asks for the median. Percentile i
  // is the value of rank ceil(hundredths[i] n / 100), where ranks count from 1 and n is the number
  // of values. Precondition: `hundredths` increase, so percentiles in the same bin are neighbours.
  //
  // The values of each bin are gathered once, for the first percentile i in it: bins[i] is the bin,
  // and inside[i] has its values. A later percentile in the same bin has kNoBin, and uses
  // inside[from], where `from` is the index of that first percentile. std::nth_element() changes
  // the order of inside[from], which later selections allow.
  std::array<double, 3> percentiles(const std::array<std::size_t, 3>& hundredths) const {
    std::array<Place, 3> places;
    Bins bins;
    for (std::size_t i = 0; i < bins.size(); ++i) {
      places[i] = find(hundredths[i]);
      const bool again = i > 0 && places[i].bin == places[i - 1].bin;
      bins[i] = again ? kNoBin : places[i].bin;
    }
    std::array<Buffer<double>, 3> inside = gather(bins);
    std::array<double, 3> result;
    for (std::size_t i = 0, from = 0; i < result.size(); ++i) {
      if (bins[i] != kNoBin) from = i;
      const auto place = inside[from].begin() + static_cast<std::ptrdiff_t>(places[i].rank);
      std::nth_element(inside[from].begin(), place, inside[from].end());
      result[i] = *place;
    }
    return result;
  }

 private:
  using Bins = std::array<std::size_t, 3>;
  static constexpr std::size_t kNoBin = kBins + 1;  // bin_of() never returns it

  // Where a value stands: its bin, and its rank among the values in that bin, counted from 0.
  struct Place {
    std::size_t bin = 0, rank = 0;
  };
  // Finds the place of a percentile. Its rank among all values is ceil(hundredths n / 100) - 1,
  // counted from 0. The loop subtracts from it the counts of all bins before the percentile's bin.
  Place find(std::size_t hundredths) const {
    Place place;
    place.rank = (values_.size() * hundredths + 99) / 100 - 1;
    for (; place.rank >= counts_[place.bin]; ++place.bin) place.rank -= counts_[place.bin];
    return place;
  }

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
        const std::size_t bin = bin_of(value);
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
  Summary summary_;
  std::vector<std::size_t> counts_;
};

}  // namespace

Distribution distribution_of(std::span<const double> values) {
  if (values.empty()) return {kNone, kNone, kNone, kNone, kNone, kNone};
  const OrderStatistics ranks(values);
  const auto [p01, median, p99] = ranks.percentiles({1, 50, 99});
  const Summary& all = ranks.summary();
  return {all.min, p01, median, p99, all.max, all.sum.value() / static_cast<double>(values.size())};
}

}  // namespace vdwmesh
