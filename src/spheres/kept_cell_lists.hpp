// Cell lists that a Workspace keeps, so that the stages of a run do not each build their own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "spheres/cell_list.hpp"

namespace vdwmesh {

class Workspace;

// Keeps the two cell lists that were requested last. A run needs no more: one of the balls and one
// of the field. A request for a third list replaces the older of the two and reuses its memory.
class KeptCellLists {
 public:
  // The list of these spheres with these reaches (Å, one for each sphere), in the cells of `frame`
  // or, if `frame` is null, in cells made for these spheres. The list is built if it is not kept.
  // The reference is valid until two other lists have been requested. Throws as CellList does.
  const CellListView& get(const SphereSet& spheres, std::span<const double> reach,
                          const CellListFrame* frame);

 private:
  struct KeptList {
    CellList list;
    // What the list was built from: the SphereSet's revision (0: there is no list yet), the
    // reaches, and the given frame, if is_framed.
    std::uint64_t revision = 0;
    std::vector<double> reach;
    bool is_framed = false;
    CellListFrame frame;

    bool holds(const SphereSet& spheres, std::span<const double> wanted,
               const CellListFrame* wanted_frame) const;
  };
  std::array<KeptList, 2> entries_;
  std::size_t last_ = 0;  // index of the entry that was requested last
};

// The list of the workspace's KeptCellLists in which the reach of a sphere is its radius.
const CellListView& ball_list(const SphereSet& spheres, Workspace& workspace);

}  // namespace vdwmesh
