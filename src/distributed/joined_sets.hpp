// Sets that were made in parts, and that elements on borders join.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/disjoint_sets.hpp"

namespace vdwmesh {

// An element on a border, and a set that it is in. Both are names, of any values.
struct BorderElement {
  std::uint64_t element, set;
};

// The sets of border elements, of which all that share an element are made one.
class JoinedSets {
 public:
  explicit JoinedSets(std::vector<BorderElement> border);

  // The number of sets that are left of `sets` sets, of which those on borders are some.
  std::uint64_t count(std::uint64_t sets) const { return sets - names_.size() + joined_.count(); }

  // A number that all sets have that were made one with this one; nothing if it is on no border.
  std::optional<std::uint32_t> number_of(std::uint64_t set);

 private:
  std::uint32_t place_of(std::uint64_t set) const;

  std::vector<std::uint64_t> names_;  // of the sets on borders, ascending
  DisjointSets joined_;               // of places in names_
};

}  // namespace vdwmesh
