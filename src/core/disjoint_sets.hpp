// Union-find, by path halving; join() and find() by any number of threads at once.
//
// Each link goes from a root to a smaller one and is made by compare-and-swap (Anderson and Woll
// 1991), so the sets and their representatives do not depend on who comes first.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/buffer.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {

// Disjoint sets; the representative of a set is its smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) {
    resize_untouched(parent_, count);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  // While others join, a member that was the representative at some time during the call.
  std::uint32_t find(std::uint32_t i) {
    for (;;) {
      const std::uint32_t above = parent(i), next = parent(above);
      if (next == above) return above;
      place(i).store(next, std::memory_order_relaxed);  // above i, even if others know it higher up
      i = next;
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    for (a = find(a), b = find(b); a != b; a = find(a), b = find(b)) {
      if (a < b) std::swap(a, b);
      std::uint32_t root = a;
      if (place(a).compare_exchange_strong(root, b, std::memory_order_relaxed)) return;
    }
  }

  // Not while others join, nor number_sets().
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
  std::atomic_ref<std::uint32_t> place(std::uint32_t i) {
    return std::atomic_ref<std::uint32_t>(parent_[i]);
  }
  std::uint32_t parent(std::uint32_t i) { return place(i).load(std::memory_order_relaxed); }

  Buffer<std::uint32_t> parent_;
};

}  // namespace vdwmesh
