// Pipelines of three steps, as mesh files are written: the first deals out items, the second works
// on several at a time, the third takes them in their order.
#pragma once

#include <optional>
#include <tuple>

#include "../plain_threads.hpp"

namespace tbb {

enum class filter_mode { parallel, serial_in_order };

class flow_control {
 public:
  void stop() { stopped_ = true; }
  bool stopped() const { return stopped_; }

 private:
  bool stopped_ = false;
};

namespace plain {

template <class In, class Out, class Call>
struct Step {
  Call call;
};

template <class... Steps>
struct Chain {
  std::tuple<Steps...> all;
};

}  // namespace plain

template <class In, class Out, class Call>
plain::Step<In, Out, Call> make_filter(filter_mode, const Call& call) {
  return {call};
}

namespace plain {

template <class A, class B, class C, class F, class G>
Chain<Step<A, B, F>, Step<B, C, G>> operator&(const Step<A, B, F>& a, const Step<B, C, G>& b) {
  return {{a, b}};
}
template <class First, class Second, class Third>
Chain<First, Second, Third> operator&(const Chain<First, Second>& two, const Third& third) {
  return {std::tuple_cat(two.all, std::make_tuple(third))};
}

}  // namespace plain

// As many items at a time as there may be tokens.
template <class Item, class Made, class Deal, class Make, class Take>
void parallel_pipeline(
    std::size_t tokens,
    const plain::Chain<plain::Step<void, Item, Deal>, plain::Step<Item, Made, Make>,
                       plain::Step<Made, void, Take>>& steps) {
  const auto& [deal, make, take] = steps.all;
  flow_control control;
  while (!control.stopped()) {
    std::vector<Item> items;
    while (items.size() < tokens) {
      const Item item = deal.call(control);
      if (control.stopped()) break;
      items.push_back(item);
    }
    std::vector<std::optional<Made>> made(items.size());
    const auto& step = make;
    plain::run_tasks(items.size(), [&](std::size_t i) { made[i].emplace(step.call(items[i])); });
    for (const std::optional<Made>& one : made) take.call(*one);
  }
}

}  // namespace tbb
