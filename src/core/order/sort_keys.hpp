// Sorting of 64-bit keys on all cores, in linear time: a radix sort.
//
// One counting sort by the highest bits that differ (stable_groups.hpp) divides the keys into
// groups that fit the cache. Each group is then sorted from its lowest bits on, digit by digit, by
// counting sorts that keep the order of equal digits. Groups that are still large, as where most
// keys are alike, are divided again.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"
#include "core/order/stable_groups.hpp"

namespace vdwmesh {

// Keys of one group that are sorted digit by digit; more are divided into groups.
inline constexpr std::size_t kMostRadixKeys = std::size_t{1} << 15;

// Sorts by the bits from `low` up to `high`, by digits of 8 bits. `scratch` is as long as `keys`,
// and its contents are lost.
inline void sort_by_digits(std::span<std::uint64_t> keys, std::span<std::uint64_t> scratch, int low,
                           int high) {
  constexpr int kDigit = 8;
  constexpr std::size_t kValues = std::size_t{1} << kDigit;
  std::span<std::uint64_t> from = keys, to = scratch;
  for (int bit = low; bit < high; bit += kDigit) {
    const std::uint64_t mask = (std::uint64_t{1} << std::min(kDigit, high - bit)) - 1;
    std::array<std::uint32_t, kValues> next{};
    for (const std::uint64_t key : from) ++next[key >> bit & mask];
    std::uint32_t before = 0;
    for (std::uint32_t& value : next) before += std::exchange(value, before);
    for (const std::uint64_t key : from) to[next[key >> bit & mask]++] = key;
    std::swap(from, to);
  }
  if (from.data() != keys.data()) std::copy(from.begin(), from.end(), keys.begin());
}

// Sorts the keys. Precondition: keys that agree in all bits from `low` on are in ascending order
// already, as if their lower bits were their indices. Takes the memory of the keys once more.
inline void sort_keys(std::span<std::uint64_t> keys, int low) {
  constexpr int kGroupBits = 11;
  if (keys.size() < 2) return;
  struct Bits {
    std::uint64_t any = 0, all = ~std::uint64_t{0};  // set in any key, set in all
  };
  const Bits bits = join_blocks(
      keys.size(),
      [&](std::size_t first, std::size_t end) {
        Bits of_block;
        for (std::size_t i = first; i < end; ++i) {
          of_block.any |= keys[i];
          of_block.all &= keys[i];
        }
        return of_block;
      },
      [](Bits& total, const Bits& part) {
        total.any |= part.any;
        total.all &= part.all;
      });
  const int high = static_cast<int>(std::bit_width(bits.any & ~bits.all));
  if (high <= low) return;
  Buffer<std::uint64_t> scratch(keys.size());
  if (keys.size() <= kMostRadixKeys) return sort_by_digits(keys, scratch, low, high);
  const int rest = std::max(low, high - kGroupBits);
  const std::size_t groups = std::size_t{1} << (high - rest);
  const std::vector<std::uint32_t> first = sort_into_groups(
      keys.size(), groups, [&](std::size_t i) { return keys[i] >> rest & (groups - 1); },
      [&](std::size_t i, std::uint32_t place) { scratch[place] = keys[i]; });
  for_each_index(keys.size(), [&](std::size_t i) { keys[i] = scratch[i]; });
  std::vector<std::size_t> large;
  for (std::size_t g = 0; g < groups; ++g) {
    if (first[g + 1] - first[g] > kMostRadixKeys) large.push_back(g);
  }
  const auto group_of = [&](std::span<std::uint64_t> all, std::size_t g) {
    return all.subspan(first[g], first[g + 1] - first[g]);
  };
  const auto sort_group = [&](std::size_t g) {
    const std::span<std::uint64_t> group = group_of(keys, g);
    if (group.size() > kMostRadixKeys) return;
    sort_by_digits(group, group_of(scratch, g), low, rest);
  };
  tbb::parallel_for(std::size_t{0}, groups, sort_group);
  scratch = Buffer<std::uint64_t>();  // frees the memory, as {} would not
  for (const std::size_t g : large) sort_keys(group_of(keys, g), low);
}

}  // namespace vdwmesh
