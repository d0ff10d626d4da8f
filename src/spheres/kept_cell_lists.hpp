// Cell lists that a Workspace keeps, so that the stages of a run do not each build their own.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/workspace.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// The last two lists that were asked for: a run needs no more, one of the balls and one of the
// field. A third takes the place and the memory of the one that was not asked for last.
class KeptCellLists {
 public:
  // The list of these spheres with these reaches (Å, one for each sphere), in the cells of `frame`
  // or, if that is null, in its own. It is valid until two other lists were asked for. Throws as
  // CellList does.
  const CellListView& get(const SphereSet& spheres, std::span<const double> reach,
                          const CellListFrame* frame);

 private:
  struct Entry {
    CellList list;
    std::uint64_t revision = 0;  // of the SphereSet; 0: no list yet
    std::vector<double> reach;
    bool is_framed = false;
    CellListFrame frame;  // if is_framed

    bool holds(const SphereSet& spheres, std::span<const double> wanted,
               const CellListFrame* wanted_frame) const;
  };
  std::array<Entry, 2> entries_;
  std::size_t last_ = 0;  // index of the entry that was asked for last
};

// The list whose reach is the radius, which the workspace keeps.
const CellListView& ball_list(const SphereSet& spheres, Workspace& workspace);

}  // namespace vdwmesh
