// Arrays that blocks of a loop, or the ranks of a parallel run, have made each for itself, joined
// in the order of the blocks or ranks.
#pragma once

#include <cstddef>
#include <vector>

namespace vdwmesh {

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

}  // namespace vdwmesh
