// arrange_part(): chooses balls by the keys of their centres, and arranges them.
//
// 1. All processes cut the curve at the same places (PartCuts).
// 2. Own spheres are in a cell list, in which every other sphere looks for one that it touches.
// 3. The near spheres are arranged in the frame of the whole set.
// 4. Arcs and corners that are not at an own ball are left out.
//
// The curve is cut by counting, because nobody should sort the whole set:
//
// 1. Estimate the exposed area of a sample of the spheres: each has some points on it, of which
//    every other sphere of the set strikes out those that it covers.
// 2. Add up the work in the cells of the curve that the highest bits of the keys name. A part
//    should end where a share of the work has been done. Where that is in the middle of a cell that
//    has much of a part's work, count again in this cell, by the next bits, and so on. One distant
//    sphere makes the cells of the others a few, which are divided so.
//
// Work is counted in whole numbers, so that sums do not depend on the order of their terms.
#include "creases/arcs/part_arrangement.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "core/fixed_blocks.hpp"
#include "spheres/cell_list.hpp"
#include "spheres/even_directions.hpp"
#include "spheres/spatial_frame.hpp"

namespace vdwmesh {
namespace {

// Where a set of spheres is cut into parts for several processes: between keys of the curve through
// it (spheres/spatial_frame.hpp), so that the parts are about equal in work.
class PartCuts {
 public:
  // Processes that have the same set and edge lengths make the same cuts. The work is estimated: so
  // much for each sphere, and so much for each triangle of its exposed area. Precondition: the set
  // is not empty.
  PartCuts(const SphereSet& spheres, const SpatialFrame& frame, const ExactMeshOptions& options,
           std::size_t parts);

  // The number of the part to which a sphere belongs; it rises with the key.
  std::uint32_t owner_of(const Sphere& s) const;

 private:
  SpatialFrame frame_;
  std::vector<std::uint64_t> begins_;  // the first key of each part but the first, ascending
};

// To arrange a ball takes as long as to mesh so many triangles, about.
constexpr std::uint64_t kWorkOfBall = 8;
// No sphere has more work than this, so sums of 2^32 fit 64 bits.
constexpr double kMostWork = 0x1p31;

constexpr std::size_t kSampledBalls = 4096;
constexpr int kSamplePoints = 32;  // of each; a mask has one bit for each

// The estimated triangles of a sphere that stands for others, and its key.
struct SampledWork {
  std::uint64_t key, work;
};

std::vector<SampledWork> sampled_work(const SphereSet& spheres, const SpatialFrame& frame,
                                      const ExactMeshOptions& options) {
  const std::size_t count = std::min(spheres.size(), kSampledBalls);
  const auto sphere_of = [&](std::size_t i) { return i * spheres.size() / count; };
  std::vector<Sphere> sampled;
  for (std::size_t i = 0; i < count; ++i) sampled.push_back(spheres[sphere_of(i)]);
  const SphereSet sample(std::move(sampled));
  const CellList list = make_ball_list(sample);
  const CellListView& view = list.view();
  std::array<Vec3d, kSamplePoints> directions;
  for (int k = 0; k < kSamplePoints; ++k) {
    directions[static_cast<std::size_t>(k)] = even_direction(k, kSamplePoints);
  }
  std::vector<std::uint32_t> covered(count, 0);  // by place in the list, a bit for each point
  for_each_index(spheres.size(), [&](std::size_t i) {
    const Sphere& s = spheres[i];
    const Vec3d around{s.radius, s.radius, s.radius};
    visit_near_box(view, s.center - around, s.center + around, [&](ListPlace place) {
      const std::size_t own = sphere_of(view.id[place]);
      if (own == i) return false;
      // Of equal spheres the first one has the area.
      const double square = s.radius * s.radius * (i < own ? 1 + 1e-9 : 1 - 1e-9);
      const Sphere& ball = view.spheres[place];
      std::uint32_t mask = 0;
      for (std::size_t k = 0; k < directions.size(); ++k) {
        const Vec3d d = ball.center + ball.radius * directions[k] - s.center;
        mask |= static_cast<std::uint32_t>(dot(d, d) < square) << k;
      }
      if (mask != 0) {
        std::atomic_ref(covered[to_index(place)]).fetch_or(mask, std::memory_order_relaxed);
      }
      return false;
    });
  });
  const double weight = static_cast<double>(spheres.size()) / static_cast<double>(count);
  std::vector<SampledWork> work;
  for (std::size_t i = 0; i < count; ++i) {
    const auto place = static_cast<ListPlace>(i);
    const Sphere& s = view.spheres[place];
    const double exposed = (kSamplePoints - std::popcount(covered[i])) / double{kSamplePoints};
    const double length = options.edge_lengths.empty()
                              ? options.edge_length
                              : options.edge_lengths[sphere_of(view.id[place])];
    const double triangles = exposed == 0 ? 0
                                          : exposed * 4 * std::numbers::pi * s.radius * s.radius /
                                                (std::sqrt(3.0) / 4 * length * length);
    work.push_back(
        {frame.key(s.center), static_cast<std::uint64_t>(std::min(weight * triangles, kMostWork))});
  }
  return work;
}

// A run of keys with one or more ends of parts in it.
struct KeyCell {
  std::uint64_t first;  // its keys are first to first + 2^bits - 1
  int bits;
  std::uint64_t before;             // work of the keys before it
  std::vector<std::uint64_t> ends;  // how much work the parts before each end should have, in all
};

constexpr int kBitsAtOnce = 12;

// The bits of keys that are not looked at when a cell is divided.
int bits_left(const KeyCell& cell) { return std::max(cell.bits - kBitsAtOnce, 0); }

// The work in each division of these cells, which are ascending and of equal size.
std::vector<std::uint64_t> work_in(const std::vector<KeyCell>& cells, const SphereSet& spheres,
                                   const SpatialFrame& frame,
                                   const std::vector<SampledWork>& samples) {
  using Work = std::vector<std::uint64_t>;
  const int bits = cells.front().bits, left = bits_left(cells.front());
  const std::size_t divisions = std::size_t{1} << (bits - left);
  const auto add = [&](std::uint64_t key, std::uint64_t work, Work& sums) {
    const auto behind = std::ranges::upper_bound(cells, key, {}, &KeyCell::first);
    if (behind == cells.begin()) return;
    const std::uint64_t place = (key - std::prev(behind)->first) >> left;
    if (place >= divisions) return;
    sums[static_cast<std::size_t>(behind - cells.begin() - 1) * divisions + place] += work;
  };
  const Work none(cells.size() * divisions, 0);
  tbb::enumerable_thread_specific<Work> of_threads(none);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, spheres.size(), kIndicesPerBlock),
                    [&](const auto& range) {
                      Work& sums = of_threads.local();
                      for (std::size_t i = range.begin(); i != range.end(); ++i) {
                        add(frame.key(spheres[i].center), kWorkOfBall, sums);
                      }
                    });
  Work all = none;
  for (const SampledWork& sample : samples) add(sample.key, sample.work, all);
  for (const Work& sums : of_threads) {
    for (std::size_t i = 0; i < all.size(); ++i) all[i] += sums[i];
  }
  return all;
}

// Finds the ends of parts in a cell whose divisions have this work. Those that fall in a division
// with more than `least` work, which can be divided further, are appended to `finer`, the others to
// `begins`.
void find_ends(const KeyCell& cell, std::span<const std::uint64_t> work, std::uint64_t least,
               std::vector<KeyCell>& finer, std::vector<std::uint64_t>& begins) {
  const int left = bits_left(cell);
  std::uint64_t before = cell.before;
  std::size_t division = 0;
  for (const std::uint64_t end : cell.ends) {
    while (division + 1 < work.size() && before + work[division] <= end) before += work[division++];
    const std::uint64_t first = cell.first + (std::uint64_t{division} << left);
    if (left > 0 && work[division] > least) {
      if (finer.empty() || finer.back().first != first) finer.push_back({first, left, before, {}});
      finer.back().ends.push_back(end);
      continue;
    }
    const bool is_behind = before + work[division] / 2 < end;
    begins.push_back(is_behind ? first + (std::uint64_t{1} << left) : first);
  }
}

PartCuts::PartCuts(const SphereSet& spheres, const SpatialFrame& frame,
                   const ExactMeshOptions& options, std::size_t parts)
    : frame_(frame) {
  const std::vector<SampledWork> samples = sampled_work(spheres, frame, options);
  std::uint64_t whole = kWorkOfBall * spheres.size();
  for (const SampledWork& sample : samples) whole += sample.work;
  KeyCell all{0, 3 * kHilbertBits, 0, {}};
  for (std::size_t part = 1; part < parts; ++part) {
    all.ends.push_back(static_cast<std::uint64_t>(
        static_cast<double>(whole) * static_cast<double>(part) / static_cast<double>(parts)));
  }
  const std::uint64_t least = whole / parts / 64;
  std::vector<KeyCell> cells;
  if (parts > 1) cells.push_back(std::move(all));
  while (!cells.empty()) {
    const std::vector<std::uint64_t> work = work_in(cells, spheres, frame_, samples);
    const std::size_t divisions = work.size() / cells.size();
    std::vector<KeyCell> finer;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      find_ends(cells[c], std::span(work).subspan(c * divisions, divisions), least, finer, begins_);
    }
    cells = std::move(finer);
  }
  std::ranges::sort(begins_);
}

std::uint32_t PartCuts::owner_of(const Sphere& s) const {
  const auto behind = std::ranges::upper_bound(begins_, frame_.key(s.center));
  return static_cast<std::uint32_t>(behind - begins_.begin());
}

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

// Whether a scaled ball is of an ordinary size, so that the triangulation of any part of the balls
// has numbers that neither over- nor underflow.
bool is_ordinary(const Sphere& s) {
  constexpr double kLeastRadius = 1e-30;  // of the largest
  return s.radius >= kLeastRadius && largest_coordinate(s) <= kFarthestSphere;
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
  const int exponent = scale_exponent(spheres);
  const SpatialFrame frame = spatial_frame(spheres);
  const PartCuts cut(spheres, frame, options, parts);
  const auto mine = static_cast<std::uint32_t>(number);
  const std::vector<SphereId> ids = near_spheres(spheres, cut, mine);
  ArrangedPart out{};
  if (ids.empty()) return out;
  std::vector<Sphere> near;
  for (const SphereId i : ids) near.push_back(spheres[i]);
  out.arrangement = arrange(placed_balls(SphereSet(std::move(near)), frame, exponent),
                            options.monitor, options.memory_limit);
  PlacedBalls& t = out.arrangement.balls;
  for (SphereId& id : t.ids) id = ids[id];
  for (const SphereId id : t.ids) out.part.owner.push_back(cut.owner_of(spheres[id]));
  MeshShare& share = out.part.share;
  const auto own = std::ranges::equal_range(out.part.owner, mine);
  share.balls = {static_cast<std::uint32_t>(own.begin() - out.part.owner.begin()),
                 static_cast<std::uint32_t>(own.end() - out.part.owner.begin())};
  out.is_ordinary = std::ranges::all_of(t.balls, is_ordinary);
  out.boundary = boundary_arcs(t, out.arrangement.boundary, {}, options.monitor);
  leave_out_others(share.balls, out.boundary);
  share.corners = own_run(out.boundary.corners, share.balls.first);
  share.arcs = own_run(out.boundary.arcs, share.balls.first);
  return out;
}

}  // namespace vdwmesh
