// How Python calls the library: without the GIL, with Ctrl-C, on a given number of threads.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <optional>

#include "core/monitor.hpp"

namespace vdwmesh::python {

// Runs work(monitor) on at most `threads` threads, without a number on all cores, while other
// threads of Python run, and returns when it is done. Rethrows what `work` throws. If a signal
// handler of Python raises meanwhile, as the one for Ctrl-C does, the work is stopped by its
// monitor, and what the handler raised is thrown.
//
// Only Python's main thread runs signal handlers. There the work goes to a thread of its own, and
// the main thread looks for signals every kSignalPeriod. Starting the thread takes some 20 µs.
void run_freely(std::optional<int> threads, const std::function<void(Monitor&)>& work);

// The same with a result.
template <class Work>
auto call(std::optional<int> threads, const Work& work) {
  std::optional<std::invoke_result_t<Work, Monitor&>> result;
  run_freely(threads, [&](Monitor& monitor) { result.emplace(work(monitor)); });
  return *std::move(result);
}

}  // namespace vdwmesh::python
