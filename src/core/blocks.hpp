// Parallel loops over index ranges, with oneTBB.
//
// oneTBB divides the range [0, count) into blocks while it runs, and differently every time. The
// results do not depend on this division under two rules: a body of for_all() writes only to
// elements that belong to its index, and reduce_all() joins only values whose join is exact, such
// as counts, maxima and minima. Sums of floating-point numbers do not follow the second rule.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/lanes/multiversion.hpp"

namespace vdwmesh {

// Indices: oneTBB divides no block of at most this size further.
inline constexpr std::size_t kBlock = 1024;

// The sequential loop over one block. It is compiled for two processor versions (multiversion.hpp),
// and the body is inlined into both. It is static because GCC 14 ends with an internal error
// otherwise.
template <class Body>
VDWMESH_MULTIVERSION static void run_block(std::size_t begin, std::size_t end, const Body& body) {
  for (std::size_t i = begin; i != end; ++i) body(i);
}
template <class Total, class Body>
VDWMESH_MULTIVERSION static void run_block(std::size_t begin, std::size_t end, const Body& body,
                                           Total& total) {
  for (std::size_t i = begin; i != end; ++i) body(i, total);
}

// Calls body(i) for every i in [0, count) on all cores, in no particular order. Blocks of at most
// `grain` indices are not divided further; a grain of 1 suits bodies that take long by themselves.
template <class Body>
void for_all(std::size_t count, const Body& body, std::size_t grain = kBlock) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                    [&](const auto& range) { run_block(range.begin(), range.end(), body); });
}

// Reduces the indices [0, count) to one total on all cores. body(i, total) adds what belongs to
// index i to a partial total. Every partial total starts as a copy of `none`, so joining with
// `none` must change nothing. join(a, b) returns the combination of two partial totals; it must be
// exact, commutative and associative.
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

// Reduces to a sum of integers. body(i, total) adds index i to a partial sum.
template <class Body>
std::uint64_t sum_all(std::size_t count, const Body& body) {
  return reduce_all(count, std::uint64_t{0}, body, std::plus<>());
}

// Returns the first index in [0, count) for which is_bad(i), if there is one. Looks at all of them.
template <class IsBad>
std::optional<std::size_t> first_of_all(std::size_t count, const IsBad& is_bad) {
  const std::size_t found = reduce_all(
      count, count,
      [&](std::size_t i, std::size_t& first) {
        if (is_bad(i)) first = std::min(first, i);
      },
      [](std::size_t a, std::size_t b) { return std::min(a, b); });
  return found < count ? std::optional(found) : std::nullopt;
}

}  // namespace vdwmesh
