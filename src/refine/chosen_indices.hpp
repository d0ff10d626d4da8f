// Lists that several threads make together, in no particular order.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/buffer.hpp"

namespace vdwmesh {

// A list of numbers to which several threads append at the same time.
class SharedList {
 public:
  void append(std::size_t number) { parts_.local().push_back(number); }
  // All numbers that were appended since clear(). No thread may append meanwhile.
  const std::vector<std::size_t>& all() {
    for (std::vector<std::size_t>& part : parts_) {
      all_.insert(all_.end(), part.begin(), part.end());
      part.clear();
    }
    return all_;
  }
  void clear() {
    all();
    all_.clear();
  }

 private:
  tbb::enumerable_thread_specific<std::vector<std::size_t>> parts_;
  std::vector<std::size_t> all_;
};

// Indices that threads choose, each of them listed once however often it is chosen.
class ChosenIndices {
 public:
  // Of the indices below `count`, none is chosen at first.
  explicit ChosenIndices(std::size_t count) : is_chosen_(count, 0) {}

  // No thread may choose meanwhile.
  bool operator[](std::size_t i) const { return is_chosen_[i] != 0; }
  // Chooses an index, and returns whether it had not been chosen before.
  bool choose(std::size_t i) {
    const std::atomic_ref chosen(is_chosen_[i]);
    if (chosen.load(std::memory_order_relaxed) != 0) return false;
    if (chosen.exchange(1, std::memory_order_relaxed) != 0) return false;
    list_.append(i);
    return true;
  }
  // All that were chosen. No thread may choose meanwhile.
  const std::vector<std::size_t>& list() { return list_.all(); }
  void clear() {
    for (const std::size_t i : list()) is_chosen_[i] = 0;
    list_.clear();
  }

 private:
  Buffer<std::uint8_t> is_chosen_;
  SharedList list_;
};

}  // namespace vdwmesh
