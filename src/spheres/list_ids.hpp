// Cell lists of some spheres of a set, which name them by their ids in the whole set.
#pragma once

#include <span>

#include "core/buffer.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Makes the list name each sphere by another id: `ids`[i] instead of i. `made` holds what the list
// refers to then.
inline void use_ids(std::span<const SphereId> ids, CellListView& list, Buffer<SphereId>& made) {
  made.resize(list.size);
  for_each_index(made.size(),
                 [&](std::size_t i) { made[i] = ids[list.id[static_cast<ListPlace>(i)]]; });
  list.id = made.data();
}

}  // namespace vdwmesh
