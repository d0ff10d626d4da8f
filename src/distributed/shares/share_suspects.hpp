// Spheres of a share that the arcs cannot measure. The first rank gets them with the balls around
// them and measures those of all ranks by one triangulation, as one process does.
#pragma once

#include <span>
#include <vector>

#include "distributed/ranks.hpp"
#include "distributed/shares/chosen_spheres.hpp"
#include "measures/reference_measures.hpp"

namespace vdwmesh {

struct ShareSuspects {
  std::vector<SphereId> ids;       // in the whole set
  std::vector<NumberedBall> near;  // likewise: they and all that overlap or touch one of them
};

// `suspects` are indices of the near spheres, of which `list` is a cell list.
inline ShareSuspects suspects_of(const ChosenSpheres& near, std::span<const SphereId> suspects,
                                 const CellListView& list) {
  ShareSuspects found{{}, balls_near(list, SphereSet::view(near.spheres), suspects)};
  for (NumberedBall& ball : found.near) ball.id = near.ids[ball.id];
  for (const SphereId i : suspects) found.ids.push_back(near.ids[i]);
  return found;
}

// Those of all ranks, on the first one. Collective.
inline ShareSuspects collect_suspects(const Ranks& ranks, const ShareSuspects& mine) {
  return {ranks.collect(std::span(mine.ids)), ranks.collect(std::span(mine.near))};
}

}  // namespace vdwmesh
