// The numbers of a sphere: its id, its rank and its list place. Host and device.
//
// All three are integers from 0 to the number of spheres less 1. Taken for each other, they would
// name another sphere, and nothing would fail. So two of them are types of their own: neither turns
// into an integer, or an integer into one of them, unless it is asked to. The id (SphereId,
// sphere_set.hpp) is the number that callers, labels and files have, and stays an integer.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"

namespace vdwmesh {

// Index of a sphere in a CellList. Lists of different spheres or reaches have different places.
enum class ListPlace : std::uint32_t {};

// Index of a sphere in canonical_order(). The lowest rank wins every exact tie.
enum class Rank : std::uint32_t {};

VDWMESH_HD constexpr std::uint32_t to_index(ListPlace place) {
  return static_cast<std::uint32_t>(place);
}
VDWMESH_HD constexpr std::uint32_t to_index(Rank rank) { return static_cast<std::uint32_t>(rank); }

// An array with an element for each list place; owns nothing. Only a list place is its index.
template <class T>
class ByListPlace {
 public:
  ByListPlace() = default;
  VDWMESH_HD constexpr ByListPlace(const T* first) : first_(first) {}

  VDWMESH_HD constexpr const T& operator[](ListPlace place) const {
    return first_[to_index(place)];
  }
  VDWMESH_HD constexpr const T* data() const { return first_; }

 private:
  const T* first_;  // no default value: the arrays of kernels are in types without constructors
};

}  // namespace vdwmesh
