// Lists of numbers, one list for each row of a table (compressed sparse rows).
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace vdwmesh {

class RowLists {
 public:
  // Replaces all lists by those of `count` rows. for_each(visit) must call visit(row, entry) for
  // every entry. It is called twice and must give the same entries in the same order: in the first
  // run they are counted, in the second they are placed.
  template <class ForEach>
  void fill(std::size_t count, const ForEach& for_each) {
    // While entries are placed, first_[r + 1] is the next free place of row r. At the end it is the
    // first place of row r + 1.
    first_.assign(count + 2, 0);
    for_each([&](std::uint32_t row, std::uint32_t) { ++first_[row + 2]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    entries_.resize(first_.back());
    for_each([&](std::uint32_t row, std::uint32_t entry) { entries_[first_[row + 1]++] = entry; });
    first_.pop_back();
  }

  std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t row) const {
    return {entries_.data() + first_[row], first_[row + 1] - first_[row]};
  }

 private:
  std::vector<std::uint32_t> first_, entries_;
};

}  // namespace vdwmesh
