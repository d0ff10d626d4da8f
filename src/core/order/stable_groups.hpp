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

// Sorts items into groups, and keeps their order within each group. visit(i, emit) calls
// emit(item, group) for the items of each index in [0, count); it is called twice, on all cores,
// and must emit the same both times. make_room(n) is called once, with the number of all items, and
// then place(item, position) for each, with its position in the sorted sequence. Returns the first
// position of each group, and the number of items behind the last one. Precondition: groups are
// below `groups`, and there are fewer than 2^32 items.
template <class Visit, class MakeRoom, class Place>
std::vector<std::uint32_t> sort_items_into_groups(std::size_t count, std::size_t groups,
                                                  const Visit& visit, const MakeRoom& make_room,
                                                  const Place& place) {
  constexpr std::size_t kLeastPerBlock = 4096, kMostBlocks = 64;
  const std::size_t per_block = std::max(kLeastPerBlock, block_count(count, kMostBlocks)),
                    blocks = block_count(count, per_block);
  std::vector<std::uint32_t> next(blocks * groups), first(groups + 1);
  for_each_block(count, per_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::uint32_t* const members = &next[block * groups];
    for (std::size_t i = begin; i < end; ++i) {
      visit(i, [&](const auto&, std::size_t group) { ++members[group]; });
    }
  });
  for (std::size_t block = 0; block < blocks; ++block) {
    for (std::size_t group = 0; group < groups; ++group) {
      first[group] += next[block * groups + group];
    }
  }
  std::exclusive_scan(first.begin(), first.end(), first.begin(), std::uint32_t{0});
  make_room(std::size_t{first.back()});
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
    for (std::size_t i = begin; i < end; ++i) {
      visit(i, [&](const auto& item, std::size_t group) { place(item, places[group]++); });
    }
  });
  return first;
}

// The same for the indices [0, count) themselves, by group_of(i): calls place(i, position).
template <class GroupOf, class Place>
std::vector<std::uint32_t> sort_into_groups(std::size_t count, std::size_t groups,
                                            const GroupOf& group_of, const Place& place) {
  return sort_items_into_groups(
      count, groups, [&](std::size_t i, const auto& emit) { emit(i, group_of(i)); },
      [](std::size_t) {}, place);
}

}  // namespace vdwmesh
