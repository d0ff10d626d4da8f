// PartCuts: cuts by counting, because nobody should sort the whole set.
//
// 1. Estimate the exposed area of a sample of the spheres: each has some points on it, of which
//    every other sphere of the set strikes out those that it covers.
// 2. Add up the work in the cells of the curve that the highest bits of the keys name. A part
//    should end where a share of the work has been done. Where that is in the middle of a cell that
//    has much of a part's work, count again in this cell, by the next bits, and so on. One distant
//    sphere makes the cells of the others a few, which are divided so.
//
// Work is counted in whole numbers, so that sums do not depend on the order of their terms.
#include "arrangement/mesher/part_cuts.hpp"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "core/fixed_blocks.hpp"
#include "spheres/cell_list.hpp"
#include "spheres/even_directions.hpp"

namespace vdwmesh {
namespace {

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

}  // namespace

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

}  // namespace vdwmesh
