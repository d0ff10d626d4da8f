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
#include "analysis/distribution.hpp"

#include <algorithm>
#include <cmath>

#include "core/fixed_blocks.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kValuesPerBlock = 1 << 14;

bool is_inside(const Brackets::Interval& interval, double value) {
  return interval.lower <= value && value <= interval.upper;
}

// Adds one block to all members of a summary but the sum. Minimum and maximum have four independent
// accumulators (lanes): in a single one every value would have to wait for the one before it.
VDWMESH_MULTIVERSION void survey_block(ValueSummary& summary, const Brackets& brackets,
                                       std::span<const double> values) {
  std::array<double, 4> min, max;
  min.fill(summary.min), max.fill(summary.max);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t lane = i % min.size();
    min[lane] = std::min(min[lane], values[i]);
    max[lane] = std::max(max[lane], values[i]);
  }
  summary.min = *std::min_element(min.begin(), min.end());
  summary.max = *std::max_element(max.begin(), max.end());
  summary.count += values.size();
  for (std::size_t i = 0; i < brackets.count; ++i) {
    const double lower = brackets.intervals[i].lower;
    std::uint64_t below = 0;
    for (const double value : values) below += value < lower;
    summary.below[i] += below;
  }
}

// Copies the values that are in one of the intervals to `kept`, which has room for all, and returns
// their number. Every value is written, and the place moves on behind those to be kept, so that no
// branch depends on a value. An interval that does not exist is like the first one.
VDWMESH_MULTIVERSION std::size_t keep_inside(const Brackets& brackets,
                                             std::span<const double> values, double* kept) {
  std::array<Brackets::Interval, kPercentiles.size()> intervals;
  for (std::size_t i = 0; i < intervals.size(); ++i)
    intervals[i] = brackets.intervals[i < brackets.count ? i : 0];
  std::size_t count = 0;
  for (const double value : values) {
    kept[count] = value;
    bool in = false;
    for (const Brackets::Interval& interval : intervals)
      in |= (interval.lower <= value) & (value <= interval.upper);
    count += in;
  }
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
    Brackets::Interval interval;
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
  OfThread& mine = threads_.local();
  mine.summary.sum.add(block);
  survey_block(mine.summary, brackets_, block);
  mine.kept.resize(std::max(mine.kept.size(), block.size()));
  const std::size_t kept = keep_inside(brackets_, block, mine.kept.data());
  for (const double value : std::span(mine.kept).first(kept)) {
    std::size_t i = 0;
    while (!is_inside(brackets_.intervals[i], value)) ++i;
    mine.inside[i].push_back(value);
  }
}

ValueSummary BracketedValues::summary() const {
  ValueSummary summary;
  for (const OfThread& theirs : threads_) vdwmesh::add(summary, theirs.summary);
  return summary;
}

Buffer<double> BracketedValues::inside(std::size_t i) const {
  Buffer<double> values;
  for (const OfThread& theirs : threads_)
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
