// What blocks of a loop have sorted by receiver, joined in the order of the blocks: for the ranks
// of a parallel run, each of which gets an array.
#pragma once

#include <cstddef>
#include <vector>

namespace vdwmesh {

// Appends each array of `part` to the array of `total` with the same index: for join_blocks(),
// where blocks divide what they find among receivers.
template <class T>
void append_to_each(std::vector<std::vector<T>>& total, const std::vector<std::vector<T>>& part) {
  for (std::size_t i = 0; i < total.size(); ++i) {
    total[i].insert(total[i].end(), part[i].begin(), part[i].end());
  }
}

}  // namespace vdwmesh
