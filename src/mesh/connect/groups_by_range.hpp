// Groups what triangles contribute to ranges of vertices, so that each range can be worked on by
// one thread, with the data of its vertices in the cache of one core.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/large_pages.hpp"
#include "core/order/stable_groups.hpp"

namespace vdwmesh {

// A range of 8192 vertices has about 49,000 half-edges in a closed mesh, and as many corners: three
// edges per vertex, two half-edges each. At 8 to 12 bytes each, the second-level cache of a core
// holds them.
inline constexpr std::size_t kVerticesPerRange = std::size_t{1} << 13;

// The items grouped by range, and in the order of their triangles within a range. `Item` is small
// and trivial. visit_items(t, emit) calls emit(item, range) for the items of triangle t; it is
// called twice for each triangle, on any thread, and must emit the same both times. Preconditions:
// the ranges are below ranges(), and there are fewer than 2^32 items.
template <class Item>
class GroupsByRange {
 public:
  template <class VisitItems>
  GroupsByRange(std::size_t triangles, std::size_t vertex_count, const VisitItems& visit_items)
      : first_(sort_items_into_groups(
            triangles, (vertex_count + kVerticesPerRange - 1) / kVerticesPerRange, visit_items,
            [&](std::size_t items) { resize_untouched(items_, items); },
            [&](const Item& item, std::uint32_t place) { items_[place] = item; })) {}

  std::size_t ranges() const { return first_.size() - 1; }
  // Index of the range's first item in the list of all.
  std::uint32_t first(std::size_t range) const { return first_[range]; }
  std::span<const Item> of(std::size_t range) const {
    return {items_.data() + first(range), first(range + 1) - first(range)};
  }

 private:
  Buffer<Item> items_;                // range by range
  std::vector<std::uint32_t> first_;  // index in items_; the last value is the end
};

}  // namespace vdwmesh
