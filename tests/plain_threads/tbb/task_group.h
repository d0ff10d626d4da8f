// Used by CGAL's box intersection and for the arrays of a SurfaceMesh.
#pragma once

#include <functional>

#include "../plain_threads.hpp"

namespace tbb {

// Its tasks begin when they are waited for.
class task_group {
 public:
  template <class Task>
  void run(const Task& task) {
    tasks_.push_back(task);
  }
  void wait() {
    plain::run_tasks(tasks_.size(), [&](std::size_t i) { tasks_[i](); });
    tasks_.clear();
  }

 private:
  std::vector<std::function<void()>> tasks_;
};

}  // namespace tbb
