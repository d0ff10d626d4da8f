// Measures how fast one core copies memory, as the measure that stages are held against: a stage
// that must read and write so many bytes cannot be faster. The best of several runs counts; blocks
// are far larger than the caches.
#include "pipeline/copy_rate.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>

#include "steps/stopwatch.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::size_t kBytes = std::size_t{256} << 20;
constexpr int kRuns = 4;

using Block = std::unique_ptr<char[]>;

Block untouched_block() { return Block(new char[kBytes]); }

double rate_of_copy(char* to, const char* from) {
  const CpuWatch watch;
  std::memcpy(to, from, kBytes);
  asm volatile("" : : "r"(to) : "memory");  // somebody may read the copy: it must be made
  return 2.0 * kBytes / watch.seconds();
}

}  // namespace

CopyRate measure_copy_rate() {
  const Block from = untouched_block();
  std::memset(from.get(), 1, kBytes);
  CopyRate rate;
  for (int run = 0; run < kRuns; ++run) {
    const Block to = untouched_block();
    rate.fresh = std::max(rate.fresh, rate_of_copy(to.get(), from.get()));
    rate.warm = std::max(rate.warm, rate_of_copy(to.get(), from.get()));
  }
  return rate;
}

}  // namespace vdwmesh::apps
