// SurfaceFaces: joins faces along the curves that they share. A crease is found again from its
// other probe by its ends, which are named by what they are and not by where.
#include "excluded/probes/surface_faces.hpp"

#include <algorithm>

namespace vdwmesh::excluded {

void SurfaceFaces::join_saddles(DisjointSets& faces) const {
  for (std::uint32_t i = 0; i < surface.arcs.size(); ++i) {
    const RolledArc& arc = surface.arcs[i];
    if (surface.counts(arc, included) && !arc.spindle) faces.join(half(i, 0), half(i, 1));
  }
  for (std::size_t s = 0; s < surface.sides.size(); ++s) {
    for (std::size_t k = 0; k < 2; ++k) {
      const std::uint32_t p = records.side_piece[s][k];
      if (p != kNoIndex) faces.join(half(surface.sides[s].arc, k), piece(p));
    }
  }
}

// From the other probe a crease runs the other way.
std::uint64_t SurfaceFaces::join_creases(DisjointSets& faces) const {
  std::uint64_t unmatched = 0;
  std::uint32_t last = kNoIndex;
  for (const Crease& c : records.creases) {
    const auto begin = records.creases.begin() + records.first_crease[c.other],
               finish = records.creases.begin() + records.first_crease[c.other + 1];
    const auto found = std::find_if(begin, finish, [&](const Crease& d) {
      return d.other == c.probe && d.from == c.to && d.to == c.from;
    });
    if (found != finish) {
      faces.join(piece(c.piece), piece(found->piece));
    } else if (last != c.probe) {
      last = c.probe;
      ++unmatched;
    }
  }
  return unmatched;
}

}  // namespace vdwmesh::excluded
