// Lists of entries, one list for each row of a table (compressed sparse rows), filled and sorted on
// all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {

// Rows of entries, each row sorted. All cores place the entries of a row in any order; because they
// are sorted then, and entries that compare equal are equal, the result does not depend on that.
template <class Entry>
class SortedRows {
 public:
  // Replaces all rows by `rows` rows with the entries of `items` items: visit(i, add) must call
  // add(row, entry) for each entry of item i. It is called twice for each item, by several threads,
  // and must give the same entries. Linear in rows and entries, but for the small sorts.
  template <class Visit>
  void fill(std::size_t rows, std::size_t items, const Visit& visit) {
    // While entries are placed, first_[r + 1] is the next free place of row r. At the end it is the
    // first place of row r + 1.
    first_.assign(rows + 2, 0);
    for_each_index(items, [&](std::size_t i) {
      visit(i, [&](std::size_t row, const Entry&) { take_one(first_[row + 2]); });
    });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    entries_.resize(first_.back());
    for_each_index(items, [&](std::size_t i) {
      visit(i, [&](std::size_t row, const Entry& entry) {
        entries_[take_one(first_[row + 1])] = entry;
      });
    });
    first_.pop_back();
    for_each_index(rows, [&](std::size_t r) { std::ranges::sort((*this)[r]); });
  }

  // The number of rows.
  std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  std::span<const Entry> operator[](std::size_t row) const {
    return {entries_.data() + first_[row], first_[row + 1] - first_[row]};
  }
  // Entries may be changed.
  std::span<Entry> operator[](std::size_t row) {
    return {entries_.data() + first_[row], first_[row + 1] - first_[row]};
  }
  // All entries, row by row.
  std::span<const Entry> entries() const { return entries_; }

 private:
  static std::size_t take_one(std::size_t& place) {
    return std::atomic_ref(place).fetch_add(1, std::memory_order_relaxed);
  }

  std::vector<std::size_t> first_;
  Buffer<Entry> entries_;
};

}  // namespace vdwmesh
