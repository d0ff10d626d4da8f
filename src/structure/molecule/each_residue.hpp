// A walk over atom sites, residue by residue. Internal header of this folder. It is apart from
// site.hpp because Clang compiles gemmi's sources, which include that one, as C++17, without span.
#pragma once

#include <algorithm>
#include <span>

#include "structure/molecule/site.hpp"

namespace vdwmesh {

// Calls act(sites of the residue, as a span) for each residue.
template <class Act>
void for_each_residue(const Sites& sites, const Act& act) {
  for (auto first = sites.begin(); first != sites.end();) {
    const auto last = std::find_if(
        first, sites.end(), [first](const Site& site) { return site.place != first->place; });
    act(std::span<const Site>(first, last));
    first = last;
  }
}

}  // namespace vdwmesh
