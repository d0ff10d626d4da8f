#pragma once

#include "../plain_threads.hpp"

namespace tbb::this_task_arena {

// Threads here never take up other work while they wait.
template <class Work>
auto isolate(const Work& work) {
  return work();
}

inline int max_concurrency() { return info::default_concurrency(); }

}  // namespace tbb::this_task_arena
