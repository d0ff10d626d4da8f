// Lays out, packs and unpacks first looks at boundaries: jobs that fit the memory are ordered by
// size, and each gets a place in the input, in the states and in the work memory.
#include "creases/share/look_batch.hpp"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <utility>

#include "core/fixed_blocks.hpp"
#include "creases/patch/patch_area.hpp"
#include "creases/share/patch_batch.hpp"

namespace vdwmesh {
namespace {

// One thread looks at a boundary, so it must not have many points.
constexpr std::uint32_t kMostPointsOfLook = 512;
static_assert(kMostPointsOfLook < kReorderedPoints);

// What a look needs, in bytes. Without points: the boundary has too many for a look.
struct LookNeed {
  PatchSizes sizes = {};
  std::size_t input = 0, state = 0, work = 0;
};

LookNeed need_of(const PatchSizes& sizes) {
  ArrayPlaces input(nullptr), state(nullptr), work(nullptr);
  PatchWork<BoundedMemory> arrays;
  PatchInput in;
  place_boundary(sizes, input, in);
  place_plane(capacity(sizes, PatchArray::plane_points), capacity(sizes, PatchArray::triangles),
              state, in);
  place_look(sizes, nullptr, work, arrays);
  return {sizes, input.bytes(), state.bytes(), work.bytes()};
}

// What a look takes on a device besides, with its requests in one list.
std::size_t other_bytes(const PatchSizes& sizes) {
  return sizeof(BoundedLook) + sizeof(PatchOutcome) + 3 * sizeof(std::uint64_t) +
         capacity(sizes, PatchArray::requests) * sizeof(PieceSplit);
}

}  // namespace

LookBatch::LookBatch(std::span<const LookJob> jobs, std::uint64_t most_bytes) : jobs_(jobs) {
  std::vector<LookNeed> needs(jobs.size());  // found on all cores
  for_each_index(jobs.size(), [&](std::size_t j) {
    const PatchSizes sizes = look_sizes(jobs[j].progress->boundary);
    if (sizes.points <= kMostPointsOfLook) needs[j] = need_of(sizes);
  });
  std::uint64_t bytes = 0;
  for (std::uint32_t j = 0; j < jobs.size(); ++j) {
    if (needs[j].sizes.points == 0) continue;
    const LookNeed& own = needs[j];
    const std::uint64_t with = bytes + own.input + own.state + own.work + other_bytes(own.sizes);
    if (with > most_bytes) continue;
    bytes = with;
    order_.push_back(j);
  }
  tbb::parallel_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(needs[b].sizes.points, a) < std::pair(needs[a].sizes.points, b);
  });
  looks_.reserve(order_.size());
  for (const std::uint32_t j : order_) {
    const LookNeed& own = needs[j];
    looks_.push_back({own.sizes, input_bytes_, state_bytes_, work_bytes_, jobs[j].edge_length});
    input_bytes_ += own.input;
    state_bytes_ += own.state;
    work_bytes_ += own.work;
    most_requests_ += capacity(own.sizes, PatchArray::requests);
  }
}

void LookBatch::pack(std::byte* input) const {
  tbb::parallel_for(std::size_t{0}, looks_.size(), [&](std::size_t i) {
    ArrayPlaces places(input + looks_[i].input);
    PatchInput to;
    place_boundary(looks_[i].sizes, places, to);
    pack_boundary(jobs_[order_[i]].progress->boundary, to);
  });
}

PatchVector<PieceSplit> LookBatch::finish(std::size_t i, std::byte* states,
                                          std::span<const PieceSplit> requests) const {
  const LookJob& job = jobs_[order_[i]];
  const PatchSizes& sizes = looks_[i].sizes;
  ArrayPlaces places(states + looks_[i].state);
  const std::uint32_t points = capacity(sizes, PatchArray::plane_points),
                      triangles = capacity(sizes, PatchArray::triangles);
  PatchInput from;
  place_plane(points, triangles, places, from);
  PlaneTypes::State& plane = job.progress->plane;
  make_room_for_splits(sizes.points, plane);
  plane.points.assign(from.plane_points, from.plane_points + points);
  plane.triangles.assign(from.triangles, from.triangles + triangles);
  plane.star.assign(from.star, from.star + points);
  plane.largest = plane.points[1].x;
  job.progress->is_triangulated = true;
  PatchVector<PieceSplit> splits(requests.begin(), requests.end());
  if (job.area > 0) {
    split_for_area(job.progress->boundary, job.area, job.edge_length, splits);
  }
  sort_requests(splits);
  return splits;
}

}  // namespace vdwmesh
