// BrickMesher: marching cubes over a list of candidate bricks in three steps.
// 1. Counting runs over waves of candidates, and each wave is divided into tasks of 32 bricks that
//    run in parallel. A task writes the bricks that hold surface to the elements reserved for it.
//    After the wave, the parts of the tasks are moved together.
// 2. One prefix sum numbers all vertices and triangles.
// 3. Emission again runs in tasks of 32 bricks. Each brick writes to the parts of the mesh arrays
//    that its numbers name.
// The order of bricks, vertices and triangles does not depend on the number of threads.
#include "extract/bricks/brick_mesher.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "core/monitor.hpp"
#include "core/workspace.hpp"
#include "extract/brick_search.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kBricksPerTask = 32;
constexpr std::size_t kBricksPerWave = 256 * kBricksPerTask;  // 8192 bricks, some MB
// From this many bricks on, some MB, memory is returned to the system before the mesh is allocated.
constexpr std::size_t kManyBricks = 4096;
// Room for so many bricks, 30 MB, is no burden, even where untouched memory counts.
constexpr std::size_t kSomeBricks = 65536;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Divides [0, count) into consecutive pieces of kBricksPerTask and calls body(task, begin, end) for
// the number and the bounds of each, on all cores. advance() reports progress to the monitor, and
// throws Cancelled if the caller asked to stop.
template <class Body>
void for_tasks(std::size_t count, Monitor* monitor, Body body) {
  const std::size_t tasks = (count + kBricksPerTask - 1) / kBricksPerTask;
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    const std::size_t begin = task * kBricksPerTask;
    const std::size_t end = std::min(count, begin + kBricksPerTask);
    body(task, begin, end);
    advance(monitor, end - begin);
  });
}

std::size_t task_count(std::size_t count) { return (count + kBricksPerTask - 1) / kBricksPerTask; }

// Closes the gaps between the parts of a wave. Part t has sizes[t] bricks from first + t *
// kBricksPerTask on. The parts are moved one after the other to `end`, where the bricks of earlier
// waves end; returns the new end. A part that is already in place is not moved.
ActiveBrick* close_up(ActiveBrick* end, ActiveBrick* first, std::span<const std::size_t> sizes) {
  for (const std::size_t size : sizes) {
    end = end == first ? end + size : std::move(first, first + size, end);
    first += kBricksPerTask;
  }
  return end;
}

// Fills `all` with the candidates that hold surface. `all` is first resized to the number of
// candidates, with `room` for more bricks behind them, but not for more than there are candidates
// or kSomeBricks: a layer of a grid may have 10^8 bricks of which two hold surface, and room that
// is never used is refused where the system counts it. The elements are not initialised, and
// untouched pages take no memory. Each wave writes to the elements of its candidates, and the
// bricks that it keeps are then moved to the end of the bricks kept so far. So there is no second
// array.
void count_all(std::span<const std::uint64_t> candidates, std::uint64_t room,
               const BrickLoops& loops, Monitor* monitor, Buffer<ActiveBrick>& all) {
  const std::size_t most_room = std::max(candidates.size(), kSomeBricks);
  all.reserve(candidates.size() + std::min<std::uint64_t>(room, most_room));
  resize_untouched(all, candidates.size());
  ActiveBrick* end = all.data();
  std::vector<std::size_t> sizes;
  begin_stage(monitor, "field", candidates.size());
  for (std::size_t first = 0; first < candidates.size(); first += kBricksPerWave) {
    const auto wave =
        candidates.subspan(first, std::min(kBricksPerWave, candidates.size() - first));
    ActiveBrick* const slots = all.data() + first;
    sizes.resize(task_count(wave.size()));
    for_tasks(wave.size(), monitor, [&](std::size_t task, std::size_t a, std::size_t b) {
      sizes[task] = loops.count(wave.subspan(a, b - a), slots + a);
    });
    end = close_up(end, slots, sizes);
  }
  all.resize(static_cast<std::size_t>(end - all.data()));
}

// Sets the prefix sums.
void sum_up(CountedBricks& counted) {
  const Buffer<ActiveBrick>& bricks = counted.bricks;
  counted.before.resize(bricks.size() + 1);
  counted.before[0] = {0, 0};
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    const BrickSums& before = counted.before[b];
    counted.before[b + 1] = {before.vertices + bricks[b].vertices,
                             before.triangles + bricks[b].triangles};
  }
}

// Index of the first brick whose key is at or above `key`.
std::size_t first_at(const Buffer<ActiveBrick>& bricks, std::uint64_t key) {
  const auto found = std::ranges::lower_bound(bricks, key, {}, &ActiveBrick::key);
  return static_cast<std::size_t>(found - bricks.begin());
}

// Shifts all prefix sums so that the numbers of the range's first brick begin with `first`. The
// sums of the bricks before the range may wrap around below 0, modulo 2^64.
void renumber(CountedBricks& counted, const MeshSize& first) {
  const BrickSums own = counted.before[counted.begin];
  const BrickSums shift{first.vertices - own.vertices, first.triangles - own.triangles};
  if (shift.vertices == 0 && shift.triangles == 0) return;
  for (BrickSums& sums : counted.before) {
    sums = {sums.vertices + shift.vertices, sums.triangles + shift.triangles};
  }
}

}  // namespace

void throw_missing_neighbour(const BrickIndex& brick) {
  throw InternalError(
      fmt::format("the surface leaves brick ({}, {}, {}) for a neighbour that the search left out",
                  brick.x, brick.y, brick.z));
}

BrickMesher::BrickMesher(const GridSpec& grid, BrickLoops loops, LabelWidth width,
                         const ExtractOptions& options, Workspace& workspace)
    : grid_(grid),
      loops_(std::move(loops)),
      width_(width),
      options_(options),
      counted_(workspace.get<CountedBricks>()) {}

void BrickMesher::count(const CandidateSearch& candidates, const KeyRange& own,
                        std::uint64_t halo_room) {
  const Clock::time_point start = Clock::now();
  count_all(candidates(), halo_room, loops_, options_.monitor, counted_.bricks);
  sum_up(counted_);
  counted_.begin = first_at(counted_.bricks, own.begin);
  counted_.end = first_at(counted_.bricks, own.end);
  const std::size_t border =
      std::min(counted_.end, first_at(counted_.bricks, first_with_border(own)));
  naming_triangles_ = counted_.before[counted_.end].triangles - counted_.before[border].triangles;
  stats_.surface_bricks = counted_.end - counted_.begin;
  for (std::size_t b = counted_.begin; b < counted_.end; ++b) {
    stats_.grid_clipped += counted_.bricks[b].clipped_cells;
  }
  stats_.field_seconds += seconds_since(start);
}

std::span<const ActiveBrick> BrickMesher::counted(const KeyRange& range) const {
  const std::size_t begin = first_at(counted_.bricks, range.begin),
                    end = first_at(counted_.bricks, range.end);
  return std::span(counted_.bricks).subspan(begin, end - begin);
}

void BrickMesher::set_halo(std::span<const std::vector<ActiveBrick>> parts) {
  counted_.bricks.resize(counted_.end);
  for (const std::vector<ActiveBrick>& part : parts) {
    counted_.bricks.insert(counted_.bricks.end(), part.begin(), part.end());
  }
  sum_up(counted_);
}

MeshSize BrickMesher::size() const {
  const BrickSums &from = counted_.before[counted_.begin], &to = counted_.before[counted_.end];
  return {to.vertices - from.vertices, to.triangles - from.triangles};
}

HaloVertices BrickMesher::halo() const {
  const std::vector<BrickSums>& before = counted_.before;
  return {before[counted_.begin].vertices - before.front().vertices,
          before.back().vertices - before[counted_.end].vertices, naming_triangles_};
}

MeshArrays BrickMesher::arrays() const {
  return {.connectivity = options_.connectivity, .normals = options_.normals, .width = width_};
}

void BrickMesher::check_limits() const {
  const std::uint64_t scratch = counted_.bricks.size() * (sizeof(ActiveBrick) + sizeof(BrickSums));
  check_mesh_limits({size(), arrays(), scratch, grid_.spacing}, options_.memory_limit);
}

void BrickMesher::emit(const MeshSize& first, IndexedMesh& mesh) {
  const Clock::time_point start = Clock::now();
  if (counted_.bricks.size() > kManyBricks) return_freed_pages();
  make_room(mesh, size(), arrays());
  renumber(counted_, first);
  const BrickList numbered{counted_.bricks.data(), counted_.before.data(), counted_.bricks.size()};
  const Emission emission{numbered, mesh, {first.vertices, first.triangles}};
  const std::size_t bricks = counted_.end - counted_.begin;
  std::vector<EmissionTally> tallies(task_count(bricks));
  begin_stage(options_.monitor, "extract", bricks);
  for_tasks(bricks, options_.monitor, [&](std::size_t task, std::size_t a, std::size_t b) {
    tallies[task] = loops_.emit(emission, counted_.begin + a, counted_.begin + b);
  });
  EmissionTally all;
  for (const EmissionTally& tally : tallies) all.add(tally);
  stats_.clamped_vertices = all.clamped;
  stats_.unmatched_faces = all.unmatched_faces;
  stats_.extract_seconds = seconds_since(start);
}

void mesh_bricks(ExtractResult& result, const GridSpec& grid, const CandidateSearch& candidates,
                 const BrickLoops& loops, LabelWidth width, const ExtractOptions& options,
                 Workspace& workspace) {
  BrickMesher mesher(grid, loops, width, options, workspace);
  mesher.count(candidates);
  mesher.check_limits();
  if (options.on_size) options.on_size(mesher.size());
  mesher.emit({}, result.mesh);
  if (mesher.stats().unmatched_faces != 0) {
    throw InternalError("the surface leaves a brick for a neighbour that the search left out");
  }
  result.grid = grid;
  result.stats = mesher.stats();
}

}  // namespace vdwmesh
