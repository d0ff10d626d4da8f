// Groups what triangles contribute to ranges of vertices, so that each range can be worked on by
// one thread, with the data of its vertices in the cache of one core.
//
// It is a parallel counting sort in two passes over blocks of triangles. The first pass counts the
// items of each block and range. An exclusive prefix sum over (range, block) turns the counts into
// positions in the sorted list. The second pass writes each item to its position. The blocks depend
// on the number of triangles alone and the positions on the counts alone, so the result does not
// depend on the number of threads.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/buffer.hpp"
#include "core/large_pages.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// A range of 8192 vertices has about 49,000 half-edges in a closed mesh, and as many corners: three
// edges per vertex, two half-edges each. At 8 to 12 bytes each, the second-level cache of a core
// holds them.
inline constexpr std::size_t kVerticesPerRange = std::size_t{1} << 13;

// An array of counters, one per range. The counter of the range used last is kept outside of the
// array, in value_: neighbouring triangles mostly fall into the same range, and a value in a
// register counts faster than one that goes through memory each time.
class RangeCounters {
 public:
  explicit RangeCounters(std::vector<std::uint32_t> values)
      : values_(std::move(values)), value_(values_.empty() ? 0 : values_[0]) {}

  // Adds one to the counter of a range and returns its value before that.
  std::uint32_t take(std::size_t range) {
    if (range != range_) {
      values_[range_] = value_;
      range_ = range;
      value_ = values_[range];
    }
    return value_++;
  }
  std::uint32_t operator[](std::size_t range) const {
    return range == range_ ? value_ : values_[range];
  }

 private:
  std::vector<std::uint32_t> values_;  // by range; the value for range_ is out of date
  std::size_t range_ = 0;              // the range used last
  std::uint32_t value_;                // counter of range_
};

// The items grouped by range, and in the order of their triangles within a range. `Item` is small
// and trivial. visit_items(t, emit) calls emit(item, range) for the items of triangle t; it is
// called twice for each triangle, on any thread, and must emit the same both times. Preconditions:
// the ranges are below ranges(), and there are fewer than 2^32 items.
template <class Item>
class GroupsByRange {
 public:
  template <class VisitItems>
  GroupsByRange(std::size_t triangles, std::size_t vertex_count, const VisitItems& visit_items)
      : ranges_((vertex_count + kVerticesPerRange - 1) / kVerticesPerRange),
        first_of_range_(ranges_ + 1, 0) {
    const std::size_t per_block = std::max(kTrianglesPerBlock, triangles / kMostBlocks + 1),
                      blocks = (triangles + per_block - 1) / per_block;
    // [range][block]: the number of items, later the position of the first of them.
    std::vector<std::uint32_t> count_or_position(ranges_ * blocks, 0);
    const auto for_blocks = [&](const auto& body) {
      tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) {
        body(b, [&](const auto& emit) {
          const std::size_t end = std::min((b + 1) * per_block, triangles);
          for (std::size_t t = b * per_block; t < end; ++t) visit_items(t, emit);
        });
      });
    };
    for_blocks([&](std::size_t b, const auto& visit_block) {
      RangeCounters counts(std::vector<std::uint32_t>(ranges_, 0));
      visit_block([&](Item, std::size_t range) { counts.take(range); });
      for (std::size_t r = 0; r < ranges_; ++r) count_or_position[r * blocks + b] = counts[r];
    });
    // The prefix sum. exchange() replaces a count by the sum before it and returns the count.
    std::uint32_t sum = 0;
    for (std::size_t r = 0; r < ranges_; ++r) {
      first_of_range_[r] = sum;
      for (std::size_t b = 0; b < blocks; ++b)
        sum += std::exchange(count_or_position[r * blocks + b], sum);
    }
    first_of_range_[ranges_] = sum;
    resize_untouched(items_, sum);
    for_blocks([&](std::size_t b, const auto& visit_block) {
      // For each range, the position in the sorted list of the block's next item.
      std::vector<std::uint32_t> positions(ranges_);
      for (std::size_t r = 0; r < ranges_; ++r) positions[r] = count_or_position[r * blocks + b];
      RangeCounters next(std::move(positions));
      visit_block([&](Item item, std::size_t range) { items_[next.take(range)] = item; });
    });
  }

  std::size_t ranges() const { return ranges_; }
  // Index of the range's first item in the list of all.
  std::uint32_t first(std::size_t range) const { return first_of_range_[range]; }
  std::span<const Item> of(std::size_t range) const {
    return {items_.data() + first(range), first(range + 1) - first(range)};
  }

 private:
  // Triangles of a block, unless that makes more than kMostBlocks blocks: then blocks are larger.
  // The limit bounds the table of counters, which has one counter per range and block.
  static constexpr std::size_t kTrianglesPerBlock = std::size_t{1} << 16;
  static constexpr std::size_t kMostBlocks = 256;

  std::size_t ranges_;
  std::vector<std::uint32_t> first_of_range_;  // index in items_; the last value is the end
  Buffer<Item> items_;                         // the sorted list
};

}  // namespace vdwmesh
