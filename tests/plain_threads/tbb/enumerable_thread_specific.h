#pragma once

#include <deque>
#include <functional>
#include <map>

#include "../plain_threads.hpp"

namespace tbb {

// One value for each thread that asks, made of the arguments of the constructor; places do not move.
template <class Value>
class enumerable_thread_specific {
 public:
  template <class... Arguments>
  explicit enumerable_thread_specific(const Arguments&... arguments)
      : make_([=](std::deque<Value>& values) { values.emplace_back(arguments...); }) {}

  Value& local() {
    const std::lock_guard lock(guard_);
    const auto [found, fresh] = index_.try_emplace(std::this_thread::get_id(), values_.size());
    if (fresh) make_(values_);
    return values_[found->second];
  }
  auto begin() { return values_.begin(); }
  auto end() { return values_.end(); }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }

 private:
  std::function<void(std::deque<Value>&)> make_;
  std::mutex guard_;
  std::map<std::thread::id, std::size_t> index_;
  std::deque<Value> values_;
};

}  // namespace tbb
