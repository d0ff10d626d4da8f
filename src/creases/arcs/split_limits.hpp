// When to give up splitting pieces: if curves nearly coincide, it might never end.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/curves_too_close.hpp"
#include "creases/arcs/arc_sampling.hpp"
#include "creases/arcs/boundary_arcs.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class SplitLimits {
 public:
  // Keeps references. `ids`: of the balls; the sampling is as yet without splits.
  SplitLimits(std::span<const SphereId> ids, const BoundaryArcs& boundary,
              const ArcSampling& sampling);

  // All without a result but check_fit() throw CurvesTooClose, with the spheres that meet in a
  // piece, and with the limit that ended the splitting.
  [[noreturn]] void refuse_after(int rounds, const ArcPiece& piece) const;
  // Of two curves on the sphere of this ball that have a point in common where they should not.
  [[noreturn]] void refuse_coincident(std::uint32_t ball) const;
  // Gives up if a piece to be split is straight.
  void check_straightness(std::span<const PieceSplit> splits) const;
  // Gives up if pieces just split have too many pieces on their arcs, or if all arcs together have.
  // The counts are of all arcs, before any split and now.
  struct Growth {
    std::uint64_t pieces_at_first, pieces;
    bool fits;
    std::uint64_t memory_limit;
  };
  void check_growth(std::span<const PieceSplit> splits, const Growth& growth) const;
  // Throws LimitExceeded if they do not fit into memory. It comes before check_growth():
  // CurvesTooClose would lead to another mesh, and the mesh to depend on memory.
  void check_fit(const Growth& growth) const;
  // Whether the arc has not so many pieces that splits for the angles of triangles must end, long
  // before check_growth() gives up; and whether this holds for all arcs of the pieces just split.
  bool has_room_for_angles(std::uint32_t arc) const;
  bool leave_room(std::span<const PieceSplit> splits) const;
  // Whether a piece is so straight that check_straightness() gives up, or nearly: whether its
  // sagitta is less than so many times what is too little.
  bool is_straight(const ArcPiece& piece, double times = 1) const;

 private:
  // `by`: what did not tell the curves apart.
  [[noreturn]] void refuse(const ArcPiece& piece, const std::string& by) const;
  bool has_grown(std::uint64_t now, std::uint64_t at_first) const;

  std::span<const SphereId> ids_;
  const BoundaryArcs& boundary_;
  const ArcSampling& sampling_;
  std::vector<std::uint32_t> pieces_of_arc_at_first_;
  std::uint64_t allowed_growth_;  // besides 64 for each piece that there was at first
};

}  // namespace vdwmesh
