#include "extract/bricks/brick_extraction.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "extract/limits.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kBricksPerTask = 32;
constexpr std::size_t kBricksPerWave = 256 * kBricksPerTask;  // some MB
constexpr std::size_t kManyBricks = 4096;                     // some MB

using Active = Buffer<ActiveBrick>;
using Clock = std::chrono::steady_clock;

// Before each active brick, and in all.
using Bases = std::vector<BrickSums>;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Calls body(task, begin, end) for consecutive pieces of [0, count) on all cores.
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

// Moves the parts of a wave, which begin at `first` and every kBricksPerTask further on, to the end
// of the bricks before them; returns the new end.
ActiveBrick* close_up(ActiveBrick* end, ActiveBrick* first, std::span<const std::size_t> sizes) {
  for (const std::size_t size : sizes) {
    end = end == first ? end + size : std::move(first, first + size, end);
    first += kBricksPerTask;
  }
  return end;
}

// In place and wave by wave, so that little more is touched than what is kept.
Active count_all(std::span<const std::uint64_t> candidates, const BrickLoops& loops,
                 Monitor* monitor) {
  Active all;
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
  return all;
}

Bases sum_up(const Active& bricks) {
  Bases before(bricks.size() + 1);
  for (std::size_t b = 0; b < bricks.size(); ++b) {
    before[b + 1] = {before[b].vertices + bricks[b].vertices,
                     before[b].triangles + bricks[b].triangles};
  }
  return before;
}

}  // namespace

void throw_missing_neighbour(const BrickIndex& brick) {
  throw InternalError(
      fmt::format("the surface leaves brick ({}, {}, {}) for a neighbour that the search left out",
                  brick.x, brick.y, brick.z));
}

ExtractResult mesh_bricks(const GridSpec& grid,
                          const std::function<std::vector<std::uint64_t>()>& candidates,
                          const BrickLoops& loops, LabelWidth width,
                          const ExtractOptions& options) {
  Clock::time_point start = Clock::now();
  ExtractResult result;
  result.grid = grid;
  const Active bricks = count_all(candidates(), loops, options.monitor);
  const Bases before = sum_up(bricks);
  const BrickSums& all = before.back();
  result.stats.surface_bricks = bricks.size();
  for (const ActiveBrick& brick : bricks) result.stats.grid_clipped += brick.clipped_cells;
  const MeshSize size{all.vertices, all.triangles};
  const MeshArrays arrays{
      .connectivity = options.connectivity, .normals = options.normals, .width = width};
  check_mesh_limits({size, arrays, bricks.size() * (sizeof(ActiveBrick) + 16), grid.spacing},
                    options.memory_limit);
  result.stats.field_seconds = seconds_since(start);

  if (options.on_size) options.on_size(size);

  start = Clock::now();
  if (bricks.size() > kManyBricks) return_freed_pages();
  make_room(result.mesh, size, arrays);
  const BrickList numbered{bricks.data(), before.data(), bricks.size()};
  const Emission emission{numbered, result.mesh};
  std::vector<EmissionTally> tallies(task_count(bricks.size()));
  begin_stage(options.monitor, "extract", bricks.size());
  for_tasks(bricks.size(), options.monitor, [&](std::size_t task, std::size_t a, std::size_t b) {
    tallies[task] = loops.emit(emission, a, b);
  });
  EmissionTally all_tasks;
  for (const EmissionTally& tally : tallies) all_tasks.add(tally);
  if (all_tasks.unmatched_faces != 0) {
    throw InternalError("the surface leaves a brick for a neighbour that the search left out");
  }
  result.stats.clamped_vertices = all_tasks.clamped;
  result.stats.extract_seconds = seconds_since(start);
  return result;
}

}  // namespace vdwmesh
