// Sets of which every rank knows parts. Parts that have an element in common are parts of one set.
#pragma once

#include <compare>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/disjoint_sets.hpp"

namespace vdwmesh {

// An element on a border, and a set that it is in. Both are names, of any values.
struct BorderElement {
  std::uint64_t element, set;

  friend auto operator<=>(const BorderElement&, const BorderElement&) = default;
};

// The sets of border elements, of which all that share an element are made one.
class JoinedSets {
 public:
  explicit JoinedSets(std::vector<BorderElement> border);

  // How many sets there are after joining, if there were `sets` before, those on borders included.
  std::uint64_t count(std::uint64_t sets) const { return sets - names_.size() + joined_.count(); }

  // A number that is the same for all sets that were joined with this one; nothing if the set is on
  // no border.
  std::optional<std::uint32_t> number_of(std::uint64_t set);

 private:
  std::uint32_t place_of(std::uint64_t set) const;

  std::vector<std::uint64_t> names_;  // of the sets on borders, ascending
  DisjointSets joined_;               // of places in names_
};

}  // namespace vdwmesh
