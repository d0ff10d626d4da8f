// Exact percentiles of many values by a sample, one pass over the values, and a selection, after
// the idea of R. W. Floyd and R. L. Rivest (Comm. ACM 18, 165, 1975).
//
//  1. A sample says between which two values each percentile is to be expected (its bracket).
//  2. One pass over all values, block by block and in parallel, counts those below each bracket,
//     keeps those inside, and computes the sum, the minimum and the maximum.
//  3. The counts say which of the kept values the percentile is, or that it is outside of its
//     bracket. Then step 2 is done again with a bracket that contains everything.
//
// The rank of a value is its index in the sorted sequence of all values. Sums are exact, and a
// selection by rank does not depend on the order of its input. So nothing depends on the sample,
// nor on how the values are divided among threads.
//
// Percentiles of distances are found otherwise (analysis/distances/distances_statistics.hpp): a
// device measures distances too, and counts in bins are all that it has to send.
#include "analysis/distances/distribution.hpp"

#include <algorithm>
#include <cmath>

#include "core/fixed_blocks.hpp"
#include "core/lanes/lane_masks.hpp"
#include "core/lanes/multiversion.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kValuesPerBlock = 1 << 14;

bool is_inside(const Brackets::Bracket& interval, double value) {
  return interval.lower <= value && value <= interval.upper;
}

// Adds one block to all members of a summary but the sum, and copies the values that are in one of
// the intervals to `kept`, which has room for all. Returns their number. Four values are looked at
// together. What is left over at the end is filled up with NaN, of which every comparison is false:
// it is neither counted nor kept. An interval that does not exist is like the first one.
VDWMESH_MULTIVERSION std::size_t survey_block(ValueSummary& summary, const Brackets& brackets,
                                              std::span<const double> values, double* kept) {
  constexpr std::size_t kIntervals = kPercentiles.size();
  Lanes lower[kIntervals], upper[kIntervals];
  LaneBits below[kIntervals];  // minus the number of values, since true is -1 in a lane
  for (std::size_t k = 0; k < kIntervals; ++k) {
    const Brackets::Bracket& interval = brackets.intervals[k < brackets.count ? k : 0];
    lower[k] = all_lanes(interval.lower);
    upper[k] = all_lanes(interval.upper);
    below[k] = all_bits(0);
  }
  Lanes least = all_lanes(summary.min), most = all_lanes(summary.max);
  std::size_t count = 0;
  const auto look_at = [&](const double* four) {
    const Lanes x = lanes_at(four);
    least = x < least ? x : least;
    most = x > most ? x : most;
    LaneBits inside = all_bits(0);
    for (std::size_t k = 0; k < kIntervals; ++k) {
      below[k] += x < lower[k];
      inside |= (x >= lower[k]) & (x <= upper[k]);
    }
    const std::uint32_t in = bits_of(inside);
    if (in == 0) return;
    // Every value is written, and the place moves on behind those to be kept.
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      kept[count] = four[lane];
      count += in >> lane & 1;
    }
  };
  const std::size_t whole = values.size() / kLanes * kLanes;
  for (std::size_t i = 0; i < whole; i += kLanes) look_at(&values[i]);
  if (whole < values.size()) {
    double last[kLanes];
    std::fill(last, last + kLanes, std::numeric_limits<double>::quiet_NaN());
    std::copy(values.begin() + static_cast<std::ptrdiff_t>(whole), values.end(), last);
    look_at(last);
  }
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    summary.min = std::min(summary.min, least[lane]);
    summary.max = std::max(summary.max, most[lane]);
    for (std::size_t k = 0; k < brackets.count; ++k)
      summary.below[k] += static_cast<std::uint64_t>(-below[k][lane]);
  }
  summary.count += values.size();
  return count;
}

// About so many values of a set are looked at to find brackets.
constexpr std::size_t kSampleSize = 1 << 13;

}  // namespace

void add(ValueSummary& sum, const ValueSummary& other) {
  sum.sum.add(other.sum);
  sum.count += other.count;
  sum.min = std::min(sum.min, other.min);
  sum.max = std::max(sum.max, other.max);
  for (std::size_t i = 0; i < sum.below.size(); ++i) sum.below[i] += other.below[i];
}

// In a random sample of n values, the number of values below the p-th percentile of the set has the
// mean p n and the variance p (1 - p) n. The bracket is six standard deviations wide on both sides,
// and a few values more, since the distribution is not normal where p n is small. Intervals that
// overlap are joined.
Brackets brackets_from_sample(std::vector<double> sample) {
  std::erase_if(sample, [](double value) { return std::isnan(value); });
  const auto value_at = [&](double rank) {
    const auto place = sample.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(sample.begin(), place, sample.end());
    return *place;
  };
  const auto size = static_cast<double>(sample.size());
  Brackets result;
  result.count = 0;
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    const double share = static_cast<double>(kPercentiles[i]) / 100;
    const double margin = 6 * std::sqrt(share * (1 - share) * size) + 8;
    const double first = share * size - margin, last = share * size + margin;
    Brackets::Bracket interval;
    if (first >= 0) interval.lower = value_at(first);
    if (last < size) interval.upper = value_at(last);
    if (result.count > 0 && interval.lower <= result.intervals[result.count - 1].upper) {
      result.intervals[result.count - 1].upper = interval.upper;
    } else {
      result.intervals[result.count++] = interval;
    }
    result.of_percentile[i] = result.count - 1;
  }
  return result;
}

void BracketedValues::add(std::span<const double> block) {
  ThreadValues& mine = threads_.local();
  mine.summary.sum.add(block);
  // Values of which the last four are not all kept are written beyond the last kept one.
  mine.kept.resize(std::max(mine.kept.size(), block.size() + kLanes));
  const std::size_t kept = survey_block(mine.summary, brackets_, block, mine.kept.data());
  for (const double value : std::span(mine.kept).first(kept)) {
    std::size_t i = 0;
    while (!is_inside(brackets_.intervals[i], value)) ++i;
    mine.inside[i].push_back(value);
  }
}

ValueSummary BracketedValues::summary() const {
  ValueSummary summary;
  for (const ThreadValues& theirs : threads_) vdwmesh::add(summary, theirs.summary);
  return summary;
}

Buffer<double> BracketedValues::inside(std::size_t i) const {
  Buffer<double> values;
  for (const ThreadValues& theirs : threads_)
    values.insert(values.end(), theirs.inside[i].begin(), theirs.inside[i].end());
  return values;
}

std::optional<Distribution> distribution_of(const BracketedValues& values) {
  const Brackets& brackets = values.brackets();
  std::array<Buffer<double>, kPercentiles.size()> inside;
  for (std::size_t i = 0; i < brackets.count; ++i) inside[i] = values.inside(i);
  const auto value_inside = [&](std::size_t i, std::uint64_t rank) -> std::optional<double> {
    if (rank >= inside[i].size()) return std::nullopt;
    const auto place = inside[i].begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(inside[i].begin(), place, inside[i].end());
    return *place;
  };
  return distribution_of(values.summary(), brackets, value_inside);
}

Distribution distribution_of(std::span<const double> values) {
  std::vector<double> sample;
  const std::size_t step = (values.size() / kSampleSize + 1) | 1;
  for (std::size_t i = 0; i < values.size(); i += step) sample.push_back(values[i]);
  return distribution_by_sample(std::move(sample), [&](BracketedValues& bracketed) {
    for_each_block(values.size(), kValuesPerBlock,
                   [&](std::size_t, std::size_t first, std::size_t last) {
                     bracketed.add(values.subspan(first, last - first));
                   });
  });
}

}  // namespace vdwmesh
