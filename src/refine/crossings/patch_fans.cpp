// PatchFans: every patch is judged by itself, as a piece of the fans of its three corners. The
// judgement is kept, so that it can be taken back from the fans when the patch has changed.
#include "refine/crossings/patch_fans.hpp"

#include "core/blocks.hpp"
#include "surface/patch_star.hpp"

namespace vdwmesh {
namespace {

VDWMESH_INLINE LanePoint directions_at(const Buffer<Vec3f>& direction, const Triangle& corner) {
  return at_corners(direction[corner[0]], direction[corner[1]], direction[corner[2]]);
}

VDWMESH_INLINE StarFans::Judgement judge(const Midpoints& level, std::size_t t,
                                         const Buffer<Vec3f>& direction) {
  const Buffer<Vec3d>& p = level.mesh.positions;
  const auto v = level.vertices(t);
  return judge_patch(at_corners(p[v[0]], p[v[1]], p[v[2]]), at_corners(p[v[3]], p[v[4]], p[v[5]]),
                     directions_at(direction, level.corners(t)));
}

VDWMESH_INLINE StarFans::Judgement judge(const DividedMidpoints& level, std::size_t t,
                                         const Buffer<Vec3f>& direction) {
  const Buffer<Vec3d>& p = level.mesh.positions;
  const auto v = level.vertices(t);
  const auto kind = [&](std::size_t i) { return at_corners(p[v[i]], p[v[i + 1]], p[v[i + 2]]); };
  return judge_twice_divided({kind(0), kind(3), kind(6), kind(9), kind(12)},
                             directions_at(direction, level.corners(t)));
}

}  // namespace

template <class Level>
void PatchFans::judge_all(const Level& level) {
  judgements_.resize(level.patches());
  for_all(level.patches(), [&](std::size_t t) {
    judgements_[t] = judge(level, t, direction_);
    fans_.add(level.corners(t), judgements_[t]);
  });
}

PatchFans::PatchFans(const Midpoints& level)
    : fans_(level.parent.vertex_count()),
      direction_(fan_directions(level.mesh.positions, level.parent.vertex_count(),
                                level.parent.triangles)) {
  judge_all(level);
}

PatchFans::PatchFans(const DividedMidpoints& level) : fans_(level.corner_vertices()) {
  Buffer<Triangle> corners(level.patches());
  for_all(level.patches(), [&](std::size_t t) { corners[t] = level.corners(t); });
  direction_ = fan_directions(level.mesh.positions, level.corner_vertices(), corners);
  judge_all(level);
}

template <class Level>
void PatchFans::renew(const Level& level, std::size_t patch) {
  const StarFans::Judgement now = judge(level, patch, direction_);
  fans_.replace(level.corners(patch), judgements_[patch], now);
  judgements_[patch] = now;
}

template void PatchFans::renew(const Midpoints&, std::size_t);
template void PatchFans::renew(const DividedMidpoints&, std::size_t);

}  // namespace vdwmesh
