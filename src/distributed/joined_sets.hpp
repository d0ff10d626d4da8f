// Sets that were made in parts, and that elements on borders join.
#pragma once

#include <cstdint>
#include <vector>

namespace vdwmesh {

// An element on a border, and a set that it is in. Both are names, of any values.
struct BorderElement {
  std::uint64_t element, set;
};

// The number of sets that are left of `sets` sets when all sets that share an element are made one.
std::uint64_t count_joined(std::uint64_t sets, std::vector<BorderElement> border);

}  // namespace vdwmesh
