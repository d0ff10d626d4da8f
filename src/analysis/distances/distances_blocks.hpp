// Collects the distances of many blocks of samples that several threads measure at the same time.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <span>
#include <vector>

#include "analysis/distances/distances_statistics.hpp"
#include "core/vec3.hpp"

namespace vdwmesh {

// Sums for each block, which are joined in the order of the blocks, and a histogram for each
// thread, whose integer counts can be added in any order. The result is therefore the same bit for
// bit for any number of threads. largest() is the largest distance that a thread has told of by
// raise(), at most that of all blocks. The maximum of a single block may be that of another block;
// only the maximum of all blocks is a result.
class BlockStatistics {
 public:
  explicit BlockStatistics(std::size_t blocks) : blocks_(blocks) {}
  DistanceSums& block(std::size_t i) { return blocks_[i]; }
  // The histogram of the calling thread.
  DistanceHistogram& histogram() { return histograms_.local(); }
  double largest() const { return largest_.load(std::memory_order_relaxed); }
  void raise(double distance) {
    double old = largest();
    while (old < distance &&
           !largest_.compare_exchange_weak(old, distance, std::memory_order_relaxed)) {
    }
  }
  // Adds points to the maximum alone. largest_of(least) returns the larger of `least` and their
  // largest distance, so it need not measure points that are surely nearer than `least`. What is
  // the largest so far depends on the other threads, and so does the block's maximum.
  template <class LargestOf>
  void add_extremes(std::size_t block, std::size_t count, const LargestOf& largest_of) {
    const double found = largest_of(largest());
    blocks_[block].add_extremes(count, found);
    raise(found);
  }
  // Adds samples of a surface: those inside of patches to all statistics, those on borders to the
  // maximum alone.
  template <class Finder>
  void add_samples(std::size_t block, std::span<const Vec3d> inside, std::span<const Vec3d> border,
                   const Finder& finder) {
    std::vector<double> found(inside.size());
    finder.find(inside, found.data());
    for (const double distance : found) {
      blocks_[block].add(distance);
      histogram().add(distance);
    }
    raise(blocks_[block].max);
    add_extremes(block, border.size(),
                 [&](double least) { return finder.largest_distance(border, least); });
  }
  DistanceStatistics result() const {
    DistanceHistogram all;
    for (const DistanceHistogram& h : histograms_) all.add(h);
    return summarize(blocks_, all);
  }

 private:
  std::vector<DistanceSums> blocks_;
  std::atomic<double> largest_{0};
  tbb::enumerable_thread_specific<DistanceHistogram> histograms_;
};

}  // namespace vdwmesh
