// Sorting into groups on all cores, in linear time: a counting sort in blocks.
//
// Each block of the indices counts its members of every group. A prefix sum over the counts, group
// by group and within a group block by block, says where the members of each block go. So the
// indices of a group stay in ascending order, whatever the number of threads.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/fixed_blocks.hpp"

namespace vdwmesh {

// A number of groups for so many indices: few enough for the counts to be small beside the indices
// and to stay in the cache, and enough for all cores to work on groups. A power of two.
inline std::size_t usual_groups(std::size_t count) {
  constexpr std::size_t kIndicesPerGroup = 16, kMostGroups = 2048;
  return std::clamp(std::bit_floor(count / kIndicesPerGroup), std::size_t{1}, kMostGroups);
}

// Sorts the indices [0, count) by group_of(i), which is below `groups`, and keeps their order
// within each group: calls place(i, position) for each, with the position in the sorted sequence.
// Both are called on all cores. Returns the first position of each group, and `count` behind the
// last one. Precondition: count is below 2^32.
template <class GroupOf, class Place>
std::vector<std::uint32_t> sort_into_groups(std::size_t count, std::size_t groups,
                                            const GroupOf& group_of, const Place& place) {
  constexpr std::size_t kLeastPerBlock = 4096, kMostBlocks = 64;
  const std::size_t per_block = std::max(kLeastPerBlock, block_count(count, kMostBlocks)),
                    blocks = block_count(count, per_block);
  std::vector<std::uint32_t> next(blocks * groups), first(groups + 1);
  for_each_block(count, per_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::uint32_t* const members = &next[block * groups];
    for (std::size_t i = begin; i < end; ++i) ++members[group_of(i)];
  });
  for (std::size_t block = 0; block < blocks; ++block) {
    for (std::size_t group = 0; group < groups; ++group) {
      first[group] += next[block * groups + group];
    }
  }
  std::exclusive_scan(first.begin(), first.end(), first.begin(), std::uint32_t{0});
  std::vector<std::uint32_t> position(first.begin(), first.end() - 1);
  for (std::size_t block = 0; block < blocks; ++block) {
    for (std::size_t group = 0; group < groups; ++group) {
      const std::uint32_t members = next[block * groups + group];
      next[block * groups + group] = position[group];
      position[group] += members;
    }
  }
  for_each_block(count, per_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::uint32_t* const places = &next[block * groups];
    for (std::size_t i = begin; i < end; ++i) place(i, places[group_of(i)]++);
  });
  return first;
}

}  // namespace vdwmesh
