// Numbers for names, in the order in which a list first has them, on all cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {

// Numbers the names in [0, names) that a list of `count` places has: name_of(place) is the name at
// a place, or `names` if there is none. A name whose first place comes earlier has a lower number,
// whatever the number of threads. Calls number(name, n) once for each name that is in the list, and
// returns how many there are.
template <class NameOf, class Number>
std::uint32_t number_first_named(std::size_t count, std::size_t names, const NameOf& name_of,
                                 const Number& number) {
  Buffer<std::size_t> first(names);  // by name: its first place
  for_each_index(names, [&](std::size_t n) { first[n] = std::numeric_limits<std::size_t>::max(); });
  for_each_index(count, [&](std::size_t place) {
    const std::size_t name = name_of(place);
    if (name >= names) return;
    const std::atomic_ref least(first[name]);
    std::size_t known = least.load(std::memory_order_relaxed);
    while (place < known && !least.compare_exchange_weak(known, place, std::memory_order_relaxed)) {
    }
  });
  return number_all(
      count,
      [&](std::size_t place) {
        const std::size_t name = name_of(place);
        return name < names && first[name] == place;
      },
      [&](std::size_t place, std::uint32_t n) { number(name_of(place), n); });
}

}  // namespace vdwmesh
