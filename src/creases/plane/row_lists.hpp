// Lists of numbers, one list for each row of a table (compressed sparse rows).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/host_device.hpp"
#include "creases/patch/patch_memory.hpp"

namespace vdwmesh {

template <class Memory>
class RowListsOf {
 public:
  // Replaces all lists by those of `count` rows. for_each(visit) must call visit(row, entry) for
  // every entry. It is called twice and must give the same entries in the same order: in the first
  // run they are counted, in the second they are placed.
  template <class ForEach>
  VDWMESH_HD void fill(std::size_t count, const ForEach& for_each) {
    // While entries are placed, first_[r + 1] is the next free place of row r. At the end it is the
    // first place of row r + 1.
    first_.assign(count + 2, 0);
    for_each([&](std::uint32_t row, std::uint32_t) { ++first_[row + 2]; });
    for (std::size_t r = 0; r <= count; ++r) first_[r + 1] += first_[r];
    entries_.resize(first_.back());
    for_each([&](std::uint32_t row, std::uint32_t entry) { entries_[first_[row + 1]++] = entry; });
    first_.pop_back();
  }

  VDWMESH_HD std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  VDWMESH_HD std::span<const std::uint32_t> operator[](std::size_t row) const {
    return {entries_.data() + first_[row], first_[row + 1] - first_[row]};
  }

  // Calls visit(array) for the arrays of rows and of entries.
  template <class VisitRows, class VisitEntries>
  VDWMESH_HD void visit_arrays(const VisitRows& visit_rows, const VisitEntries& visit_entries) {
    visit_rows(first_);
    visit_entries(entries_);
  }

 private:
  typename Memory::template Array<std::uint32_t> first_, entries_;
};

using RowLists = RowListsOf<GrowingMemory>;

}  // namespace vdwmesh
