// A binary search over numbers, for host and device.
#pragma once

#include "core/host_device.hpp"

namespace vdwmesh {

// The first number from `low` up to `end` for which is_before(number) is false; `end` if there is
// none. Precondition: is_before() is true up to some number and false from there on.
template <class Number, class IsBefore>
VDWMESH_HD Number first_from(Number low, Number end, const IsBefore& is_before) {
  while (low < end) {
    const Number middle = low + (end - low) / 2;
    if (is_before(middle)) {
      low = middle + 1;
    } else {
      end = middle;
    }
  }
  return low;
}

}  // namespace vdwmesh
