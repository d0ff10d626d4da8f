// Frees the GIL around a computation and watches for signals meanwhile (call.hpp). The two threads
// share one object, Job: the computing thread sets its end, the watching thread its stop.
#include "call.hpp"

#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh::python {
namespace {

namespace py = pybind11;

// Short beside the 0.3 s in which people expect an answer, long beside the GIL's switch interval of
// 5 ms.
constexpr std::chrono::milliseconds kSignalPeriod{20};

// The arena of oneTBB in which a call runs its parallel loops. Without one, each thread that begins
// a call gets an arena of its own from oneTBB, whose memory, some 9 KiB, does not come back when
// the thread ends. Arenas are therefore kept, as many as calls ran at the same time, until the
// process ends: at that time oneTBB may be gone, so nothing destroys them.
class ArenaOfCall {
 public:
  explicit ArenaOfCall(std::optional<int> threads)
      : threads_(threads.value_or(tbb::task_arena::automatic)) {
    const std::lock_guard lock(kept().mutex);
    std::vector<std::unique_ptr<tbb::task_arena>>& unused = kept().arenas[threads_];
    if (unused.empty()) {
      arena_ = std::make_unique<tbb::task_arena>(threads_);
    } else {
      arena_ = std::move(unused.back());
      unused.pop_back();
    }
  }
  ~ArenaOfCall() {
    const std::lock_guard lock(kept().mutex);
    kept().arenas[threads_].push_back(std::move(arena_));
  }
  ArenaOfCall(const ArenaOfCall&) = delete;
  ArenaOfCall& operator=(const ArenaOfCall&) = delete;

  void run(const std::function<void(Monitor&)>& work, Monitor& monitor) {
    arena_->execute([&] { work(monitor); });
  }

 private:
  struct KeptHandler {
    std::mutex mutex;
    std::map<int, std::vector<std::unique_ptr<tbb::task_arena>>> arenas;  // by number of threads
  };
  static KeptHandler& kept() {
    static KeptHandler* const all = new KeptHandler;
    return *all;
  }

  int threads_;
  std::unique_ptr<tbb::task_arena> arena_;
};

class StopMonitor : public Monitor {
 public:
  void begin_stage(std::string_view, std::uint64_t) override {}
  void advance(std::uint64_t) override {}
  bool cancelled() const override { return stop_.load(std::memory_order_relaxed); }
  void stop() { stop_.store(true, std::memory_order_relaxed); }

 private:
  std::atomic<bool> stop_ = false;
};

class Job {
 public:
  Job(std::optional<int> threads, const std::function<void(Monitor&)>& work)
      : thread_([this, threads, &work] { compute(threads, work); }) {}
  ~Job() { thread_.join(); }
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  void stop() { monitor_.stop(); }
  bool ends_within(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex_);
    return ended_.wait_for(lock, time, [this] { return has_ended_; });
  }
  // Once it has ended.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void compute(std::optional<int> threads, const std::function<void(Monitor&)>& work) {
    try {
      ArenaOfCall(threads).run(work, monitor_);
    } catch (...) {
      error_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    ended_.notify_one();
  }

  StopMonitor monitor_;
  std::exception_ptr error_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool has_ended_ = false;
  std::thread thread_;  // last, because it uses the others
};

bool is_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

// Runs the handlers of signals that came. Throws what a handler raised.
void handle_signals() {
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

// The main thread's part. The job ends before its error is known, because it uses what the caller
// owns.
void watch(Job& job) {
  while (!job.ends_within(kSignalPeriod)) {
    try {
      handle_signals();
    } catch (py::error_already_set&) {
      job.stop();
      throw;
    }
  }
  job.rethrow();
}

}  // namespace

void run_freely(std::optional<int> threads, const std::function<void(Monitor&)>& work) {
  const bool has_signals = is_main_thread();
  const py::gil_scoped_release free;
  if (has_signals) {
    Job job(threads, work);
    watch(job);
  } else {
    StopMonitor never;
    ArenaOfCall(threads).run(work, never);
  }
}

}  // namespace vdwmesh::python
