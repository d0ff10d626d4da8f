// arrange_part(): chooses balls by the keys of their centres, and arranges them.
//
// 1. All processes cut the curve at the same places (part_cuts.hpp).
// 2. Own spheres are in a cell list, in which every other sphere looks for one that it touches.
// 3. The near spheres are arranged in the frame of the whole set.
// 4. Arcs and corners that are not at an own ball are left out.
#include "arrangement/mesher/part_arrangement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "arrangement/mesher/part_cuts.hpp"
#include "core/fixed_blocks.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {
namespace {

// Balls touch, or might but for rounding, if they meet when all radii are longer by this fraction,
// and one by this fraction of its coordinates. That is beyond all that the complex depends on.
constexpr double kSlack = 1e-5, kRounding = 1e-12;

double largest_coordinate(const Sphere& s) {
  return std::max({std::abs(s.center.x), std::abs(s.center.y), std::abs(s.center.z)});
}

bool may_touch(const Sphere& a, const Sphere& b) {
  return norm(a.center - b.center) <=
         (1 + kSlack) * (a.radius + b.radius) + kRounding * largest_coordinate(a);
}

// The spheres of a part and all that may touch one of them, ascending.
std::vector<SphereId> near_spheres(const SphereSet& spheres, const PartCuts& parts,
                                   std::uint32_t number) {
  const std::vector<SphereId> own =
      collect<SphereId>(spheres.size(), [&](std::size_t i, std::vector<SphereId>& found) {
        if (parts.owner_of(spheres[i]) == number) found.push_back(static_cast<SphereId>(i));
      });
  if (own.empty()) return {};
  std::vector<Sphere> of_part;
  std::vector<double> reach;
  for (const SphereId i : own) {
    of_part.push_back(spheres[i]);
    reach.push_back((1 + kSlack) * spheres[i].radius);
  }
  const SphereSet own_set(std::move(of_part));
  const CellList list(own_set, reach);
  const CellListView& view = list.view();
  return collect<SphereId>(spheres.size(), [&](std::size_t i, std::vector<SphereId>& found) {
    const Sphere& s = spheres[i];
    const double radius = (1 + kSlack) * s.radius + kRounding * largest_coordinate(s);
    const Vec3d around{radius, radius, radius};
    const bool is_near =
        visit_near_box(view, s.center - around, s.center + around,
                       [&](ListPlace place) { return may_touch(s, view.spheres[place]); });
    if (is_near) found.push_back(static_cast<SphereId>(i));
  });
}

// Leaves out the arcs and corners without an own ball.
void leave_out_others(const MeshShare::Run& own, BoundaryArcs& boundary) {
  const auto is_at_own = [&](const auto& balls) {
    return std::ranges::any_of(balls,
                               [&](std::uint32_t b) { return b >= own.first && b < own.second; });
  };
  std::vector<std::uint32_t> number(boundary.corners.size(), kNoIndex);
  std::uint32_t corners = 0, arcs = 0;
  for (std::uint32_t c = 0; c < number.size(); ++c) {
    if (!is_at_own(boundary.corners[c].balls)) continue;
    number[c] = corners;
    boundary.corners[corners++] = boundary.corners[c];
  }
  for (const BoundaryArc& arc : boundary.arcs) {
    if (!is_at_own(arc.balls)) continue;
    BoundaryArc& kept = boundary.arcs[arcs++];
    kept = arc;
    if (kept.is_circle()) continue;
    for (std::uint32_t& end : kept.ends) end = number[end];
  }
  boundary.corners.resize(corners);
  boundary.arcs.resize(arcs);
}

// The corners or arcs whose lowest ball is an own one: the last ones, since those of the balls
// before, which other processes have, come first.
template <class Items>
MeshShare::Run own_run(const Items& items, std::uint32_t first_own_ball) {
  const auto first = std::ranges::partition_point(
      items, [&](const auto& item) { return item.balls[0] < first_own_ball; });
  return {static_cast<std::uint32_t>(first - items.begin()),
          static_cast<std::uint32_t>(items.size())};
}

}  // namespace

ArrangedPart arrange_part(const SphereSet& spheres, std::size_t number, std::size_t parts,
                          const ExactMeshOptions& options) {
  const BallFrame frame = ball_frame(spheres);
  const PartCuts cut(spheres, frame.order, options, parts);
  const auto mine = static_cast<std::uint32_t>(number);
  const std::vector<SphereId> ids = near_spheres(spheres, cut, mine);
  ArrangedPart out{};
  if (ids.empty()) return out;
  std::vector<Sphere> near;
  for (const SphereId i : ids) near.push_back(spheres[i]);
  out.arrangement = arrange(placed_balls(SphereSet(std::move(near)), frame), options.monitor,
                            options.memory_limit);
  PlacedBalls& t = out.arrangement.balls;
  for (SphereId& id : t.ids) id = ids[id];
  for (const SphereId id : t.ids) out.part.owner.push_back(cut.owner_of(spheres[id]));
  MeshShare& share = out.part.share;
  const auto own = std::ranges::equal_range(out.part.owner, mine);
  share.balls = {static_cast<std::uint32_t>(own.begin() - out.part.owner.begin()),
                 static_cast<std::uint32_t>(own.end() - out.part.owner.begin())};
  const std::vector<std::uint8_t>& doubts = out.arrangement.is_doubtful;
  out.doubtful = static_cast<std::uint64_t>(
      std::count(doubts.begin() + share.balls.first, doubts.begin() + share.balls.second, 1));
  out.boundary = boundary_arcs(t, out.arrangement.boundary, {}, options.monitor);
  leave_out_others(share.balls, out.boundary);
  share.corners = own_run(out.boundary.corners, share.balls.first);
  share.arcs = own_run(out.boundary.arcs, share.balls.first);
  return out;
}

}  // namespace vdwmesh
