// The few pieces of TBB that the project uses, on plain threads, for the thread sanitizer: Debian's
// TBB is not instrumented, so the sanitizer neither sees its hand-overs nor anything it guards. In
// the preset tsan the headers beside this file stand before TBB's; every loop then runs on
// threads that the sanitizer follows. Slow and simple; loops inside of loops run where they are.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace tbb {

class global_control {
 public:
  enum parameter { max_allowed_parallelism };

  global_control(parameter, std::size_t threads) : before_(limit().exchange(threads)) {}
  global_control(const global_control&) = delete;
  global_control& operator=(const global_control&) = delete;
  ~global_control() { limit().store(before_); }

  static std::size_t active_value(parameter) { return limit().load(); }

 private:
  // At least four: races need company, also where there are few cores.
  static std::atomic<std::size_t>& limit() {
    static std::atomic<std::size_t> value{std::max(4u, std::thread::hardware_concurrency())};
    return value;
  }
  std::size_t before_;
};

namespace info {
inline int default_concurrency() { return static_cast<int>(std::thread::hardware_concurrency()); }
}  // namespace info

namespace plain {

inline thread_local bool is_worker = false;

// Where several tasks throw, one of the exceptions leaves, as with TBB.
template <class Task>
void run_tasks(std::size_t count, const Task& task) {
  const std::size_t threads =
      std::min(count, global_control::active_value(global_control::max_allowed_parallelism));
  if (threads <= 1 || is_worker) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return;
  }
  std::atomic<std::size_t> next{0};
  std::exception_ptr thrown;
  std::mutex guard;
  const auto work = [&] {
    is_worker = true;
    try {
      for (std::size_t i = next++; i < count; i = next++) task(i);
    } catch (...) {
      next = count;
      const std::lock_guard lock(guard);
      thrown = std::current_exception();
    }
    is_worker = false;
  };
  std::vector<std::thread> team;
  for (std::size_t i = 0; i < threads; ++i) team.emplace_back(work);
  for (std::thread& thread : team) thread.join();
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace plain

template <class T>
class blocked_range {
 public:
  blocked_range(T begin, T end, std::size_t grain = 1) : begin_(begin), end_(end), grain_(grain) {}

  T begin() const { return begin_; }
  T end() const { return end_; }
  bool empty() const { return !(begin_ < end_); }
  std::size_t size() const { return empty() ? 0 : static_cast<std::size_t>(end_ - begin_); }
  std::size_t grainsize() const { return grain_; }

  // The range in pieces of its grain: the same pieces on every run.
  std::size_t pieces() const { return (size() + grain_ - 1) / grain_; }
  blocked_range piece(std::size_t i) const {
    const auto first = static_cast<T>(begin_ + static_cast<T>(i * grain_));
    return {first, i + 1 == pieces() ? end_ : static_cast<T>(first + static_cast<T>(grain_)),
            grain_};
  }

 private:
  T begin_, end_;
  std::size_t grain_;
};

template <class T, class Body>
void parallel_for(const blocked_range<T>& range, const Body& body) {
  plain::run_tasks(range.pieces(), [&](std::size_t i) { body(range.piece(i)); });
}

template <class T, class Body>
void parallel_for(T begin, T end, const Body& body) {
  parallel_for(blocked_range<T>(begin, end), [&](const blocked_range<T>& piece) {
    for (T i = piece.begin(); i < piece.end(); ++i) body(i);
  });
}

template <class T, class Total, class Body, class Join>
Total parallel_deterministic_reduce(const blocked_range<T>& range, const Total& none,
                                    const Body& body, const Join& join) {
  std::vector<Total> parts(range.pieces(), none);
  plain::run_tasks(parts.size(), [&](std::size_t i) { parts[i] = body(range.piece(i), none); });
  Total total = none;
  for (const Total& part : parts) total = join(total, part);
  return total;
}

template <class T, class Total, class Body, class Join>
Total parallel_reduce(const blocked_range<T>& range, const Total& none, const Body& body,
                      const Join& join) {
  return parallel_deterministic_reduce(range, none, body, join);
}

template <class... Task>
void parallel_invoke(const Task&... task) {
  const std::function<void()> tasks[] = {task...};
  plain::run_tasks(sizeof...(task), [&](std::size_t i) { tasks[i](); });
}

template <class Iterator, class Less = std::less<>>
void parallel_sort(Iterator begin, Iterator end, const Less& less = {}) {
  std::sort(begin, end, less);
}

}  // namespace tbb
