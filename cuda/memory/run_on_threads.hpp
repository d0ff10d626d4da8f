// Runs work on several threads of the host.
#pragma once

#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace vdwmesh {

// Calls work(k) for k = 0 .. count - 1, all at the same time: work(0) on the caller's thread, each
// other one on a thread of its own. Returns when all are done. If some have thrown, throws the
// exception of the lowest k.
template <class Work>
void run_on_threads(std::size_t count, const Work& work) {
  std::vector<std::exception_ptr> failures(count);
  const auto guarded = [&](std::size_t k) {
    try {
      work(k);
    } catch (...) {
      failures[k] = std::current_exception();
    }
  };
  {
    // The destructor of this vector waits for its threads.
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < count; ++k) others.emplace_back(guarded, k);
    if (count > 0) guarded(0);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace vdwmesh
