// distribution_together(): the ranks add up their sums and the numbers of values below each
// bracket. These say which of the values inside of a bracket the percentile is. Its bits are found
// a few at a time, from the highest on: the ranks count their values by these bits, and keep the
// values that agree with the percentile so far. So no values are sent.
#include "distributed/together/distribution_together.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace vdwmesh {
namespace {

constexpr int kBitsAtATime = 12;

// The value of rank `rank`, from 0, among those of all ranks, sorted. `values` are those of this
// rank. Precondition: no value has a sign bit, so that the values are in the order of their bits.
// Collective.
double value_of_rank(const Ranks& ranks, Buffer<double> values, std::uint64_t rank) {
  constexpr int kBits = 63;
  std::uint64_t found = 0;
  for (int left = kBits; left > 0;) {
    const int taken = std::min(left, kBitsAtATime);
    left -= taken;
    const auto digit_of = [=](double value) {
      return std::bit_cast<std::uint64_t>(value) >> left & ((std::uint64_t{1} << taken) - 1);
    };
    std::vector<std::uint64_t> counts(std::size_t{1} << taken);
    for (const double value : values) ++counts[digit_of(value)];
    ranks.add_up(counts);
    std::uint64_t digit = 0;
    for (; rank >= counts[digit]; ++digit) rank -= counts[digit];
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

Brackets brackets_together(const Ranks& ranks, const std::vector<double>& sample) {
  std::vector<double> all = ranks.collect(std::span<const double>(sample));
  Brackets brackets;
  ranks.together([&] {
    if (ranks.is_first()) brackets = brackets_from_sample(std::move(all));
  });
  return ranks.shared(brackets);
}

std::optional<Distribution> distribution_together(const Ranks& ranks,
                                                  const BracketedValues& values) {
  ValueSummary mine;
  ranks.together([&] { mine = values.summary(); });
  const ValueSummary all = sum_together(ranks, mine);
  const auto value_inside = [&](std::size_t i, std::uint64_t rank) -> std::optional<double> {
    Buffer<double> inside;
    ranks.together([&] { inside = values.inside(i); });
    if (rank >= ranks.sum(std::uint64_t{inside.size()})) return std::nullopt;
    return value_of_rank(ranks, std::move(inside), rank);
  };
  return distribution_of(all, values.brackets(), value_inside);
}

}  // namespace vdwmesh
