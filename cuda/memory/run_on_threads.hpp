// Work shared among threads of the host.
#pragma once

#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace vdwmesh {

// Calls work(k) for each k below count, all at once, the first on the caller's thread. When all are
// done, throws what the first of them threw.
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
    std::vector<std::jthread> others;
    for (std::size_t k = 1; k < count; ++k) others.emplace_back(guarded, k);
    if (count > 0) guarded(0);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace vdwmesh
