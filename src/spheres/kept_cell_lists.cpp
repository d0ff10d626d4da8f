// A kept list is found by what it was built from: the frame, the reaches, and the revision of the
// SphereSet, a number that changes with every change of the spheres. Comparing all reaches costs
// about a thousandth of building a list.
#include "spheres/kept_cell_lists.hpp"

#include <algorithm>

#include "core/fixed_blocks.hpp"
#include "core/workspace.hpp"

namespace vdwmesh {

bool KeptCellLists::KeptList::holds(const SphereSet& spheres, std::span<const double> wanted,
                                    const CellListFrame* wanted_frame) const {
  if (revision == 0 || revision != spheres.revision()) return false;
  if (is_framed != (wanted_frame != nullptr)) return false;
  if (is_framed && !(frame == *wanted_frame)) return false;
  return std::ranges::equal(reach, wanted);
}

const CellListView& KeptCellLists::get(const SphereSet& spheres, std::span<const double> reach,
                                       const CellListFrame* frame) {
  for (std::size_t e = 0; e < entries_.size(); ++e) {
    if (!entries_[e].holds(spheres, reach, frame)) continue;
    last_ = e;
    return entries_[e].list.view();
  }
  // Neither entry has the list: replace the one that was not requested last.
  last_ = 1 - last_;
  KeptList& entry = entries_[last_];
  entry.revision = 0;  // building may throw, and then the entry must not count as a list
  if (frame != nullptr) {
    entry.list.rebuild(spheres, reach, *frame);
    entry.frame = *frame;
  } else {
    entry.list.rebuild(spheres, reach);
  }
  entry.is_framed = frame != nullptr;
  entry.reach.assign(reach.begin(), reach.end());
  entry.revision = spheres.revision();
  return entry.list.view();
}

const CellListView& ball_list(const SphereSet& spheres, Workspace& workspace) {
  std::vector<double> reach(spheres.size());
  for_each_index(reach.size(), [&](std::size_t i) { reach[i] = spheres[i].radius; });
  return workspace.get<KeptCellLists>().get(spheres, reach, nullptr);
}

}  // namespace vdwmesh
