// Lock-free union-find: any number of threads may call join() and find() at the same time.
//
// The algorithm follows the wait-free union-find of R. J. Anderson and H. Woll (STOC 1991), with
// path halving. Every set is a tree: parent_[i], the parent of element i, is at most i, and a root
// is its own parent. join() links the larger of two roots to the smaller one by compare-and-swap,
// so the root of a set is its smallest member as soon as all joins have ended. The sets and their
// representatives therefore do not depend on the order in which threads join. Relaxed atomics
// suffice because the parents are the only data that threads exchange.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "core/buffer.hpp"
#include "core/errors.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {

// A partition of {0, …, count - 1}, at first into sets of one element. The representative of a set
// is its smallest member.
class DisjointSets {
 public:
  // Throws LimitExceeded for more than 2^32 - 1 elements: the loops over them count in 32 bits.
  explicit DisjointSets(std::size_t count) {
    if (count > std::numeric_limits<std::uint32_t>::max())
      throw LimitExceeded("sets of more than 2^32 - 1 elements cannot be joined");
    resize_untouched(parent_, count);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  // Returns the representative of the set of i. If other threads join at the same time, the result
  // is an element that was the representative at some moment during the call.
  std::uint32_t find(std::uint32_t i) {
    for (;;) {
      const std::uint32_t above = parent(i), next = parent(above);
      if (next == above) return above;
      // Path halving: the grandparent `next` becomes the parent of i. Another thread may have
      // stored a more distant ancestor in the meantime; overwriting it is harmless, because `next`
      // is an ancestor of i too.
      place(i).store(next, std::memory_order_relaxed);
      i = next;
    }
  }

  // Unites the sets of a and b. Elements with one parent are united already, as most are.
  void join(std::uint32_t a, std::uint32_t b) {
    if (parent(a) == parent(b)) return;
    for (a = find(a), b = find(b); a != b; a = find(a), b = find(b)) {
      if (a < b) std::swap(a, b);
      // Here a is the larger root. The exchange fails if another thread has linked a to another
      // root since find(); both roots are then looked up again.
      std::uint32_t root = a;
      if (place(a).compare_exchange_strong(root, b, std::memory_order_relaxed)) return;
    }
  }

  // Returns the number of sets. Precondition of this function and of number_sets(): no other thread
  // calls join() or find() at the same time.
  std::size_t count() const {
    std::size_t roots = 0;
    for (std::uint32_t i = 0; i < parent_.size(); ++i) roots += parent_[i] == i;
    return roots;
  }

  // Writes the number of the set of every element i into number[i] and returns the number of sets.
  // Sets are numbered from 0 in the order of their smallest members. The parents' memory becomes
  // the array of numbers, so this object is empty afterwards.
  std::uint32_t number_sets(Buffer<std::uint32_t>& number) && {
    std::uint32_t sets = 0;
    // parent_[i] < i unless i is a root. When the loop comes to i, the element parent_[p] of its
    // parent p has therefore been overwritten by the number of the set of p, which is the set of i.
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
