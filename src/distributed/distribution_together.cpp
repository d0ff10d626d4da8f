// distribution_together(): the ranks add up their sums and histograms. The histogram says in which
// bin each percentile is, which gives the upper bits of the value. Its lower bits are found a few
// at a time, from the highest on: the ranks count their values by these bits, and keep the values
// that agree with the percentile so far. So no values are sent.
#include "distributed/distribution_together.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <vector>

namespace vdwmesh {
namespace {

constexpr int kBitsAtATime = 12;

// The value that stands at `place` among those of all ranks that are in a bin, sorted. `values` are
// those of this rank. Collective.
double value_at(const Ranks& ranks, std::vector<double> values, const ValuePlace& place) {
  std::uint64_t found = place.bin, before = place.place;
  for (int left = kBitsInBin; left > 0;) {
    const int taken = std::min(left, kBitsAtATime);
    left -= taken;
    const auto digit_of = [=](double value) {
      return std::bit_cast<std::uint64_t>(value) >> left & ((std::uint64_t{1} << taken) - 1);
    };
    std::vector<std::uint64_t> counts(std::size_t{1} << taken);
    for (const double value : values) ++counts[digit_of(value)];
    ranks.add_up(counts);
    std::uint64_t digit = 0;
    for (; before >= counts[digit]; ++digit) before -= counts[digit];
    std::erase_if(values, [&](double value) { return digit_of(value) != digit; });
    found = found << taken | digit;
  }
  return std::bit_cast<double>(found);
}

// The sum of the summaries of all ranks, on all of them. Collective.
ValueSummary sum_together(const Ranks& ranks, const ValueSummary& mine) {
  const std::vector<ValueSummary> each = ranks.collect(std::span<const ValueSummary>(&mine, 1));
  ValueSummary all;
  for (const ValueSummary& theirs : each) add(all, theirs);
  return ranks.shared(all);
}

}  // namespace

Distribution distribution_together(const Ranks& ranks, std::span<const double> values) {
  const std::uint64_t count = ranks.sum(std::uint64_t{values.size()});
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (count == 0) return {kNone, kNone, kNone, kNone, kNone, kNone};
  std::vector<std::uint64_t> counts;
  ValueSummary mine;
  ranks.together([&] { mine = summarize_values(values, counts); });
  ranks.add_up(counts);
  const ValueSummary all = sum_together(ranks, mine);
  std::array<double, kPercentiles.size()> percentiles;
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    const ValuePlace place = place_of_percentile(counts, count, kPercentiles[i]);
    std::vector<double> inside;
    ranks.together([&] {
      std::ranges::copy_if(values, std::back_inserter(inside),
                           [&](double value) { return bin_of_value(value) == place.bin; });
    });
    percentiles[i] = value_at(ranks, std::move(inside), place);
  }
  const auto& [p01, median, p99] = percentiles;
  return {all.min, p01, median, p99, all.max, all.sum.nearest() / static_cast<double>(count)};
}

}  // namespace vdwmesh
