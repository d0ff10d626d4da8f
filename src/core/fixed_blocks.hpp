// Parallel loops over blocks of fixed size, and loops that need one processor version only.
//
// for_each_block() divides a range in the same way whatever the number of threads, unlike for_all()
// in core/blocks.hpp. The code here is compiled for one processor version, as the file around it.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/monitor.hpp"

namespace vdwmesh {

// Calls body(i) for every i in [0, count) on all cores, in no particular order.
template <class Body>
void for_each_index(std::size_t count, const Body& body) {
  // A block has to be worth more than its scheduling, but arrays of some thousand elements are for
  // all cores, too.
  constexpr std::size_t kGrain = 512;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kGrain), [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
  });
}

// The usual number of indices in a block: enough work to be worth its scheduling, little enough for
// its results to stay in the cache.
inline constexpr std::size_t kIndicesPerBlock = std::size_t{1} << 14;

// Where part number `part` of so many items begins, if they are divided into `parts` runs of about
// equal numbers. A part ends where the next one begins. Precondition: the product of the first two
// fits 64 bits.
constexpr std::uint64_t begin_of_part(std::uint64_t count, std::uint64_t part,
                                      std::uint64_t parts) {
  return count * part / parts;
}

// The number of blocks of so many indices, of which the last may be shorter.
constexpr std::size_t block_count(std::size_t count, std::size_t per_block) {
  return (count + per_block - 1) / per_block;
}

// Calls body(block, first, last) for the blocks of [0, count) on all cores, and reports each block
// as a step of progress. This division depends on nothing but the numbers given, so sums of
// floating-point numbers may be kept block by block and added in the order of the blocks.
template <class Body>
void for_each_block(std::size_t count, std::size_t per_block, const Body& body,
                    Monitor* monitor = nullptr) {
  tbb::parallel_for(std::size_t{0}, block_count(count, per_block), [&](std::size_t block) {
    body(block, block * per_block, std::min(count, (block + 1) * per_block));
    advance(monitor, 1);
  });
}

// Calls make(first, end) for the blocks of [0, count) on all cores, and joins the parts that it
// returns in the order of the blocks: join(total, part) changes the total, at first the first part.
// Precondition: count is above 0.
template <class Make, class Join>
auto join_blocks(std::size_t count, const Make& make, const Join& join) {
  using Part = std::invoke_result_t<const Make&, std::size_t, std::size_t>;
  std::vector<Part> parts(block_count(count, kIndicesPerBlock));
  for_each_block(count, kIndicesPerBlock,
                 [&](std::size_t block, std::size_t first, std::size_t end) {
                   parts[block] = make(first, end);
                 });
  for (std::size_t block = 1; block < parts.size(); ++block) join(parts[0], parts[block]);
  return std::move(parts[0]);
}

// Numbers the indices in [0, count) for which is_counted(i), from 0 and in their order, on all
// cores: calls number(i, n), n being the number of i. Returns how many there are. Each block counts
// its own, an exclusive prefix sum gives the first number of each block, and each block numbers its
// own.
template <class IsCounted, class Number>
std::uint32_t number_all(std::size_t count, const IsCounted& is_counted, const Number& number) {
  constexpr std::size_t per_block = kIndicesPerBlock;
  std::vector<std::uint32_t> first(block_count(count, per_block) + 1);
  for_each_block(count, per_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::uint32_t counted = 0;
    for (std::size_t i = begin; i < end; ++i) counted += is_counted(i);
    first[block] = counted;
  });
  std::exclusive_scan(first.begin(), first.end(), first.begin(), std::uint32_t{0});
  for_each_block(count, per_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    std::uint32_t next = first[block];
    for (std::size_t i = begin; i < end; ++i) {
      if (is_counted(i)) number(i, next++);
    }
  });
  return first.back();
}

// Calls add(i, make(i)) for every i in [0, count), in this order on one thread, for sums that
// depend on their order. All cores make the items, a batch at a time, so that they are still in the
// cache when they are added.
template <class Make, class Add>
void make_and_add(std::size_t count, const Make& make, const Add& add) {
  constexpr std::size_t kBatch = kIndicesPerBlock, kGrain = 256;
  std::vector<std::invoke_result_t<const Make&, std::size_t>> items(std::min(count, kBatch));
  for (std::size_t first = 0; first < count; first += kBatch) {
    const std::size_t end = std::min(count, first + kBatch);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, end, kGrain), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) items[i - first] = make(i);
    });
    for (std::size_t i = first; i < end; ++i) add(i, items[i - first]);
  }
}

// The arrays one behind the other.
template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& arrays) {
  std::vector<T> all;
  std::size_t size = 0;
  for (const std::vector<T>& array : arrays) size += array.size();
  all.reserve(size);
  for (const std::vector<T>& array : arrays) all.insert(all.end(), array.begin(), array.end());
  return all;
}

// Appends each array of `part` to the array of `total` with the same index: for join_blocks(),
// where blocks divide what they find among receivers.
template <class T>
void append_to_each(std::vector<std::vector<T>>& total, const std::vector<std::vector<T>>& part) {
  for (std::size_t i = 0; i < total.size(); ++i) {
    total[i].insert(total[i].end(), part[i].begin(), part[i].end());
  }
}

// Calls add(i, found) for every i in [0, count) on all cores, which may append to `found`. Returns
// everything found in the order of the indices. The monitor is asked whether to stop, once a block.
// Blocks are small, so that some thousand indices are for all cores; nothing depends on them.
template <class Item, class Add>
std::vector<Item> collect(std::size_t count, const Add& add, Monitor* monitor = nullptr,
                          std::size_t per_block = 2048) {
  std::vector<std::vector<Item>> parts(block_count(count, per_block));
  for_each_block(count, per_block, [&](std::size_t block, std::size_t begin, std::size_t end) {
    advance(monitor, 0);
    for (std::size_t i = begin; i < end; ++i) add(i, parts[block]);
  });
  return joined(parts);
}

}  // namespace vdwmesh
