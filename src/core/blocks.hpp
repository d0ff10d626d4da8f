// Loops over all cores. Bodies write to places of their own, and what is reduced is counts, maxima
// and minima, so no result depends on how the range was cut.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <cstddef>

#include "core/multiversion.hpp"

namespace vdwmesh {

inline constexpr std::size_t kBlock = 1024;

// The inner loops, in both processor versions.
template <class Body>
VDWMESH_MULTIVERSION void run_block(std::size_t begin, std::size_t end, const Body& body) {
  for (std::size_t i = begin; i != end; ++i) body(i);
}
template <class Total, class Body>
VDWMESH_MULTIVERSION void run_block(std::size_t begin, std::size_t end, const Body& body,
                                    Total& total) {
  for (std::size_t i = begin; i != end; ++i) body(i, total);
}

template <class Body>
void for_all(std::size_t count, const Body& body, std::size_t grain = kBlock) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const auto& range) { run_block(range.begin(), range.end(), body); });
}

// body(i, total) folds item i into a total; join(a, b) must be exact, commutative and associative.
template <class Total, class Body, class Join>
Total reduce_all(std::size_t count, const Total& none, const Body& body, const Join& join) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, kBlock), none,
      [&](const auto& range, Total total) {
        run_block(range.begin(), range.end(), body, total);
        return total;
      },
      join);
}

}  // namespace vdwmesh
