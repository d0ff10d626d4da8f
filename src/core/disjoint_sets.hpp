// Union-find, by path halving.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/buffer.hpp"

namespace vdwmesh {

// Disjoint sets; the representative of a set is its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

  std::size_t count() const {
    std::size_t roots = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) roots += parent_[i] == i;
    return roots;
  }

  // Sets numbered from 0 by their smallest member, in place of the structure itself.
  std::uint32_t number_sets(Buffer<std::uint32_t>& number) && {
    std::uint32_t sets = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i)
      parent_[i] = parent_[i] == i ? sets++ : parent_[parent_[i]];
    number = std::move(parent_);
    return sets;
  }

 private:
  Buffer<std::uint32_t> parent_;
};

}  // namespace vdwmesh
