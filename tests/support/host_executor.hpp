// Executes the steps of ElementPipeline on the host, one after another: what a device does, where
// there is none. For tests.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "excluded/elements/element_pipeline.hpp"

namespace vdwmesh::excluded::elements {

class HostExecutor {
 public:
  template <class T>
  using Array = std::vector<T>;

  template <class T>
  std::vector<T> make(std::size_t size) const {
    return std::vector<T>(size);
  }
  template <class T>
  std::vector<T> zeros(std::size_t size) const {
    return std::vector<T>(size);
  }
  template <class T>
  std::vector<T> upload(const std::vector<T>& from) const {
    return from;
  }
  template <class T>
  std::vector<T> download(const T* from, std::size_t size) const {
    return std::vector<T>(from, from + size);
  }
  template <class T>
  void download_to(T* to, const T* from, std::size_t size) const {
    std::copy(from, from + size, to);
  }
  template <class T>
  void put(std::vector<T>& array, std::size_t place, const T& value) const {
    array[place] = value;
  }
  template <class Step>
  void run(const char*, std::uint64_t count, const Step& step) const {
    for (std::uint64_t i = 0; i < count; ++i) step(i);
  }
  std::uint64_t scan(std::vector<std::uint64_t>& counts) const {
    std::exclusive_scan(counts.begin(), counts.end(), counts.begin(), std::uint64_t{0});
    return counts.back();
  }
  std::vector<std::uint32_t> select(const std::vector<std::uint8_t>& flags, std::uint64_t count) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < count; ++i) {
      if (flags[i]) out.push_back(i);
    }
    return out;
  }
  void sort(std::vector<std::uint32_t>& keys, std::vector<std::uint32_t>& values, std::uint64_t) {
    std::vector<std::uint32_t> order(keys.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return keys[a] < keys[b]; });
    std::vector<std::uint32_t> k, v;
    for (const std::uint32_t i : order) {
      k.push_back(keys[i]);
      v.push_back(values[i]);
    }
    keys = std::move(k);
    values = std::move(v);
  }
  OverlapLists<HostExecutor> overlaps(const std::vector<Sphere>& balls,
                                      const std::vector<std::uint32_t>& set, std::size_t) const {
    OverlapLists<HostExecutor> out;
    for (std::uint32_t a = 0; a < balls.size(); ++a) {
      out.first.push_back(out.other.size());
      for (std::uint32_t b = 0; b < balls.size(); ++b) {
        const double sum = balls[a].radius + balls[b].radius;
        if (a == b || set[a] != set[b]) continue;
        if (squared_norm(balls[a].center - balls[b].center) >= sum * sum) continue;
        out.other.push_back(b);
        out.owner.push_back(a);
      }
    }
    out.first.push_back(out.other.size());
    out.entries = out.other.size();
    return out;
  }
};

}  // namespace vdwmesh::excluded::elements
