// The vertices around which all patches of a level are a star (surface/patch_star.hpp): no two
// triangles of these patches cross.
#pragma once

#include <cstdint>

#include "core/buffer.hpp"
#include "core/vec3.hpp"
#include "refine/level_view.hpp"
#include "surface/star_fans.hpp"

namespace vdwmesh {

// Of a level with midpoints. Each patch is judged as a piece of the fans of its corners.
class PatchFans {
 public:
  PatchFans() = default;  // nothing is known
  explicit PatchFans(const Midpoints& level);
  explicit PatchFans(const DividedMidpoints& level);

  bool empty() const { return judgements_.empty(); }
  bool is_star(std::uint32_t vertex) const { return fans_.is_star(vertex); }

  // Judges a patch anew after vertices of it were put back. Several threads may renew different
  // patches. Until all that have changed are renewed, is_star() may be wrong.
  template <class Level>
  void renew(const Level& level, std::size_t patch);

 private:
  template <class Level>
  void judge_all(const Level& level);

  StarFans fans_;
  // By corner; the same in every pass, because all pieces of a fan need one map.
  Buffer<Vec3f> direction_;
  Buffer<StarFans::Judgement> judgements_;  // by patch
};

extern template void PatchFans::renew(const Midpoints&, std::size_t);
extern template void PatchFans::renew(const DividedMidpoints&, std::size_t);

}  // namespace vdwmesh
