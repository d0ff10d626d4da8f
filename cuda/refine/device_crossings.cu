// Finds crossing triangles with a uniform grid of cells. The grid is built in these steps: extent
// of all boxes, width of the cells, number of entries per cell, prefix sum, entries. An entry is a
// patch in the list of a cell.
//
// Then the pairs of patches that share a cell are listed (find_pairs()), as many at a time as the
// list has room for, and tested (patch_pair_tests.cuh). A pair that shares several cells is listed
// in one of them only: the cell that holds the lower corner of the intersection of the two boxes.
// This is the reference point method of spatial joins (Dittrich and Seeger, ICDE 2000).
#include <thrust/iterator/transform_iterator.h>

#include <algorithm>
#include <cmath>
#include <cub/device/device_reduce.cuh>
#include <limits>
#include <utility>

#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/device.cuh"
#include "cuda/refine/device_crossings.cuh"
#include "cuda/refine/patch_pair_tests.cuh"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 256;
// The pairs of patches that are expected for an entry: on level 0 no pair is left out for a star.
constexpr std::uint64_t kPairsOfTriangle = 8, kPairsOfPatch = 2;
// Pairs of quarters of two patches.
constexpr std::uint64_t kQuarterPairs = 16;
// Blocks, for each multiprocessor, of kernels that loop over lists whose length is known on the
// device alone.
constexpr unsigned kListBlocksPerProcessor = 8;
// The width of a cell, in units of the mean of the longest sides of patches' boxes.
constexpr double kCellWidth = 2;
constexpr const char* kPurpose = "looking for crossing triangles";

// ---- the grid ----

struct PatchesExtent {
  FloatBox all;      // holds all boxes
  double width_sum;  // the sum, over the boxes, of the longest side of each, Å
};

// The extent of no box: joined with any extent, it gives that extent.
constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr PatchesExtent kNoExtent{{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}}, 0};

// The extent of a single box.
struct ExtentOf {
  __host__ __device__ PatchesExtent operator()(const SurveyedPatch& patch) const {
    const FloatBox& box = patch.box;
    double width = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = static_cast<double>(box.upper[axis]) - box.lower[axis];
      width = along > width ? along : width;
    }
    return {box, width};
  }
};

// The extent of two groups of boxes together.
struct JoinExtents {
  __host__ __device__ PatchesExtent operator()(PatchesExtent a, const PatchesExtent& b) const {
    for (int axis = 0; axis < 3; ++axis) {
      a.all.lower[axis] = fminf(a.all.lower[axis], b.all.lower[axis]);
      a.all.upper[axis] = fmaxf(a.all.upper[axis], b.all.upper[axis]);
    }
    a.width_sum += b.width_sum;
    return a;
  }
};

// The number of cells of width `cell` that the box spans along an axis.
double cells_along(const FloatBox& all, double cell, int axis) {
  return std::floor((static_cast<double>(all.upper[axis]) - all.lower[axis]) / cell) + 1;
}

// The index, along one axis, of the cell that holds the coordinate, clamped to the grid. Rounding
// keeps the order of coordinates: a larger one never gets a lower index. So if two boxes have a
// point in common, the cell of that point is in the range of cells of both, and both are listed in
// it.
__device__ std::uint32_t cell_along(const CrossingGrid& grid, int axis, float coordinate) {
  const double place = (coordinate - grid.origin[axis]) * grid.per_length;
  return static_cast<std::uint32_t>(fmin(fmax(place, 0.0), grid.cells[axis] - 1.0));
}

// The position of a cell in the grid, as its index along each axis.
struct GridCell {
  std::uint32_t along[3];
};

__device__ GridCell cell_at(const CrossingGrid& grid, const float* corner) {
  return {cell_along(grid, 0, corner[0]), cell_along(grid, 1, corner[1]),
          cell_along(grid, 2, corner[2])};
}

// Calls visit(cell) for every cell that the box touches, with the cell's number.
template <class Visit>
__device__ void visit_cells(const CrossingGrid& grid, const FloatBox& box, const Visit& visit) {
  const GridCell low = cell_at(grid, box.lower), high = cell_at(grid, box.upper);
  for (std::uint64_t z = low.along[2]; z <= high.along[2]; ++z) {
    for (std::uint64_t y = low.along[1]; y <= high.along[1]; ++y) {
      const std::uint64_t row = (z * grid.cells[1] + y) * grid.cells[0];
      for (std::uint64_t x = low.along[0]; x <= high.along[0]; ++x) visit(row + x);
    }
  }
}

// Counts the entries of every cell in grid.start, which begins as zeros. One thread per patch.
__global__ void count_entries(CrossingGrid grid, const SurveyedPatch* patches,
                              std::uint64_t count) {
  const std::uint64_t t = thread_index();
  if (t >= count) return;
  visit_cells(grid, patches[t].box,
              [&](std::uint64_t cell) { atomicAdd(&grid.start[cell], 1ull); });
}

// Writes the entries. One thread per patch. When the kernel begins, start[c] is the end of cell
// c's list (an inclusive prefix sum of the counts). Each list is filled from its end and start[c]
// decreased, so that in the end it is the list's first entry. The order within a list depends on
// the scheduling of threads; the marks of vertices do not.
__global__ void fill_cells(CrossingGrid grid, const SurveyedPatch* patches, std::uint64_t count) {
  const std::uint64_t t = thread_index();
  if (t >= count) return;
  visit_cells(grid, patches[t].box, [&](std::uint64_t cell) {
    // Adding ~0 subtracts one; the result is the value before.
    const unsigned long long behind = atomicAdd(&grid.start[cell], ~0ull);
    grid.entries[behind - 1] = {static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(cell)};
  });
}

// Makes all cells dirty that list a patch which the pass must test. One thread per patch.
__global__ void mark_dirty(CrossingGrid grid, const SurveyedPatch* patches, std::uint64_t count,
                           std::uint8_t* dirty) {
  const std::uint64_t t = thread_index();
  if (t >= count || !is_wanted(patches[t])) return;
  visit_cells(grid, patches[t].box, [&](std::uint64_t cell) { dirty[cell] = 1; });
}

// Writes which triangles of level 0 a later pass must test. One thread per triangle.
__global__ void renew_wanted(GivenPatches level, MoveStatesView states, int pass,
                             SurveyedPatch* patches) {
  const std::uint64_t t = thread_index();
  if (t >= level.patches()) return;
  for (int i = 0; i < 3; ++i) {
    const bool wanted = has_wanted_state(states, level.vertex(t, i), pass);
    patches[t].marks[i] = wanted ? SurveyedPatch::kWanted : 0;
  }
}

// Makes all patches such that no pass must test them. One thread per patch.
__global__ void want_none(SurveyedPatch* patches, std::uint64_t count) {
  const std::uint64_t t = thread_index();
  if (t >= count) return;
  for (std::uint8_t& marks : patches[t].marks) {
    marks &= static_cast<std::uint8_t>(~SurveyedPatch::kWanted);
  }
}

// The patch of the parent's half-edge that the thread handles in a launch of two threads per listed
// edge. A patch may come more than once.
template <class Patches>
__device__ std::uint64_t patch_at(const Patches& level, const EdgeList& list) {
  const std::uint64_t i = thread_index(), h = level.edges.half_edge(list.edges[i / 2]);
  return level.patch_of(i % 2 == 0 ? h : level.parent.opposite[h]);
}

// Says that a pass must test the patches at listed edges, makes their cells dirty, and lists each
// of these patches once. Two threads per edge.
template <class Patches>
__global__ void want_listed(Patches level, CrossingGrid grid, EdgeList list, SurveyedPatch* patches,
                            std::uint8_t* dirty, std::uint32_t* changed,
                            unsigned long long* count) {
  const bool has = thread_index() < 2 * list.count;
  bool first = false;
  std::uint64_t t = 0;
  if (has) {
    t = patch_at(level, list);
    // The bytes of a patch's marks as a word: byte 0 has the lowest bits.
    auto* const marks = reinterpret_cast<unsigned*>(patches[t].marks);
    first = (atomicOr(marks, SurveyedPatch::kWanted) & SurveyedPatch::kWanted) == 0;
    visit_cells(grid, patches[t].box, [&](std::uint64_t cell) { dirty[cell] = 1; });
  }
  const unsigned long long slot = reserve(count, first ? 1 : 0);
  if (first) changed[slot] = static_cast<std::uint32_t>(t);
}

// Says that the next pass need not test the patches at listed edges. Two threads per edge.
template <class Patches>
__global__ void forget_listed(Patches level, EdgeList list, SurveyedPatch* patches) {
  if (thread_index() >= 2 * list.count) return;
  std::uint8_t& marks = patches[patch_at(level, list)].marks[0];
  marks &= static_cast<std::uint8_t>(~SurveyedPatch::kWanted);
}

// ---- crossings ----

// Whether the pair of patches with boxes a and b is to be tested in the cell at `place`, one of the
// cells that both touch: whether this cell holds the lower corner of the boxes' intersection.
// Precondition: the boxes overlap.
__device__ bool is_first_shared(const CrossingGrid& grid, const GridCell& place, const FloatBox& a,
                                const FloatBox& b) {
  bool first = true;
  for (int axis = 0; axis < 3; ++axis) {
    const float corner = fmaxf(a.lower[axis], b.lower[axis]);
    first &= cell_along(grid, axis, corner) == place.along[axis];
  }
  return first;
}

// Whether two patches have a corner with a star in common, so that none of their triangles cross.
// `fans` has the states of all fans; it is null if they are as they were in pass 0.
__device__ bool share_star(const SurveyedPatch& a, const SurveyedPatch& b, const FanState* fans) {
  bool share = false;
  for (const std::uint32_t star : a.star) {
    const bool is_shared = star == b.star[0] || star == b.star[1] || star == b.star[2];
    if (!is_shared || star == kNoStar) continue;
    share |= fans == nullptr || fans[star] == kStarFan;
  }
  return share;
}

// Lists the pairs of patches that must be tested for crossing triangles, those of the entries from
// `first` to `last`: one thread per entry compares its patch with those before it in the same cell,
// and with itself if a patch has quarters. The lanes of a cell take them in the same order, so that
// they mostly read the same patch. Counts all pairs and writes those that there is room for. `fans`
// is as in share_star().
__global__ void find_pairs(CrossingGrid grid, const SurveyedPatch* patches,
                           const std::uint8_t* dirty, std::uint64_t first, std::uint64_t last,
                           bool has_quarters, const FanState* fans, NumberPair* pairs,
                           std::uint64_t room, unsigned long long* count) {
  const std::uint64_t own = first + thread_index();
  CellEntry entry{0, 0};
  std::uint64_t next = 0, end = 0;
  SurveyedPatch mine{};
  GridCell place{};
  bool mine_wanted = false;
  if (own < last) {
    entry = grid.entries[own];
    if (dirty[entry.cell] != 0) {
      next = grid.start[entry.cell];
      end = has_quarters ? own + 1 : own;
      mine = patches[entry.patch];
      mine_wanted = is_wanted(mine);
      const std::uint32_t row = entry.cell / grid.cells[0];
      place = {{entry.cell % grid.cells[0], row % grid.cells[1], row / grid.cells[1]}};
    }
  }
  while (__any_sync(kAllLanes, next < end)) {
    const std::uint64_t base = next;
    std::uint32_t found = 0;  // bit k: the pair with entry base + k
    for (; next < end && next < base + 32; ++next) {
      const SurveyedPatch other = patches[grid.entries[next].patch];
      if (!overlap(mine.box, other.box)) continue;
      if (!mine_wanted && !is_wanted(other)) continue;
      if (share_star(mine, other, fans)) continue;
      if (!is_first_shared(grid, place, mine.box, other.box)) continue;
      found |= 1u << (next - base);
    }
    unsigned long long slot = reserve(count, static_cast<unsigned>(__popc(found)));
    for (; found != 0; found &= found - 1, ++slot) {
      const std::uint64_t k = base + static_cast<unsigned>(__ffs(static_cast<int>(found))) - 1;
      if (slot < room) pairs[slot] = {entry.patch, grid.entries[k].patch};
    }
  }
}

}  // namespace

template <class Patches>
CrossingFinder<Patches>::CrossingFinder(const Patches& level, const MoveStatesView& move_states,
                                        std::uint64_t pairs_at_once, const Stream& stream)
    : level_(level), stream_(stream), found_(1, stream.get()), near_count_(1, stream.get()) {
  if (level.patches() == 0) return;
  if (level.mesh.triangles > std::numeric_limits<std::uint32_t>::max()) {
    throw LimitExceeded("crossings are looked for among at most 2^32 - 1 triangles");
  }
  require_device_memory(
      crossing_search_bytes(level.patches(), Patches::kQuarters > 0, pairs_at_once), kPurpose);
  patches_ = DeviceArray<SurveyedPatch>(level.patches(), stream.get());
  quarters_ = DeviceArray<FloatBox>(Patches::kQuarters * level.patches(), stream.get());
  judge_fans(move_states);
  shape();
  fill(pairs_at_once);
}

// Makes the boxes of the patches and finds their stars. Single triangles have none.
template <class Patches>
void CrossingFinder<Patches>::judge_fans(const MoveStatesView& move_states) {
  const std::uint64_t patches = level_.patches();
  if constexpr (Patches::kQuarters > 0) {
    fans_ = zeros<FanState>(level_.corner_vertices(), stream_);
    directions_ = zeros<Vec3f>(level_.corner_vertices(), stream_);
    launch("add_directions", add_directions<Patches>, over(patches, kThreads), stream_, level_,
           directions_.data());
  }
  launch("survey_patches", survey_patches<Patches>, over(3 * patches, kTestThreads), stream_,
         level_, move_states, patches_.data(), quarters_.data(), directions_.data(), fans_.data());
  launch("note_stars", note_stars<Patches>, over(patches, kThreads), stream_, level_, fans_.data(),
         patches_.data());
}

// Chooses origin, width and number of the cells. If kCellWidth gives more cells than patches (or
// than 64, or than 32 bits number), the width grows by the cube root of the excess, and by 1 % at
// least, until the cells are few enough.
template <class Patches>
void CrossingFinder<Patches>::shape() {
  const DeviceArray<PatchesExtent> total(1, stream_.get());
  const auto extents = thrust::make_transform_iterator(
      static_cast<const SurveyedPatch*>(patches_.data()), ExtentOf{});
  run_cub("extent of the patches", stream_.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceReduce::Reduce(scratch, bytes, extents, total.data(),
                                     static_cast<std::int64_t>(patches_.size()), JoinExtents{},
                                     kNoExtent, stream_.get());
  });
  const PatchesExtent extent = fetch(total.data(), stream_);
  const auto patches = static_cast<double>(patches_.size());
  const double most = std::clamp(patches, 64.0, double{std::numeric_limits<std::uint32_t>::max()});
  // The bound of 1e-100 Å avoids a division by zero if all patches are points.
  double cell = std::max(kCellWidth * extent.width_sum / patches, 1e-100);
  for (;;) {
    double cells = 1;
    for (int axis = 0; axis < 3; ++axis) cells *= cells_along(extent.all, cell, axis);
    if (cells <= most) break;
    cell *= std::max(1.01, std::cbrt(cells / most));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid_.origin[axis] = extent.all.lower[axis];
    grid_.cells[axis] =
        static_cast<std::uint32_t>(cells_along(extent.all, cell, static_cast<int>(axis)));
  }
  grid_.per_length = 1 / cell;
}

// Takes the memory of the grid, after checking that it is there, and writes the entries. The array
// `start` has one element per cell and one more, which stays 0 while counting and is the number of
// all entries after the prefix sum.
template <class Patches>
void CrossingFinder<Patches>::fill(std::uint64_t pairs_at_once) {
  const std::uint64_t cells = std::uint64_t{grid_.cells[0]} * grid_.cells[1] * grid_.cells[2];
  require_device_memory((cells + 1) * sizeof(unsigned long long) + cells, kPurpose);
  start_ = zeros<unsigned long long>(cells + 1, stream_);
  dirty_ = DeviceArray<std::uint8_t>(cells, stream_.get());
  grid_.start = start_.data();
  const LaunchShape shape = over(patches_.size(), kThreads);
  launch("count_entries", count_entries, shape, stream_, grid_, patches_.data(), patches_.size());
  run_cub("scan of the cells", stream_.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::InclusiveSum(scratch, bytes, start_.data(), start_.data(),
                                         static_cast<std::int64_t>(cells + 1), stream_.get());
  });
  const std::uint64_t entries = fetch(start_.data() + cells, stream_);
  const std::uint64_t per_entry = Patches::kQuarters > 0 ? kPairsOfPatch : kPairsOfTriangle;
  const std::uint64_t room = std::min(per_entry * entries, pairs_at_once);
  const std::uint64_t near_room = Patches::kQuarters > 0 ? std::max(room, kQuarterPairs) : 0;
  require_device_memory(entries * sizeof(CellEntry) + (room + near_room) * sizeof(NumberPair),
                        kPurpose);
  entries_ = DeviceArray<CellEntry>(entries, stream_.get());
  pairs_ = DeviceArray<NumberPair>(room, stream_.get());
  near_ = DeviceArray<NumberPair>(near_room, stream_.get());
  at_once_ = std::max<std::uint64_t>(1, room / per_entry);
  grid_.entries = entries_.data();
  launch("fill_cells", fill_cells, shape, stream_, grid_, patches_.data(), patches_.size());
}

// Lists the pairs of the entries from `first` on, of as many entries as have room in the list, and
// returns where the next ones begin. If there is no room for the pairs of as many entries as
// before, half as many are taken from then on. A single entry has at most as many pairs as there
// are patches; if these have no room, it is made.
template <class Patches>
std::uint64_t CrossingFinder<Patches>::find(std::uint64_t first, const FanState* fans) {
  for (;;) {
    const std::uint64_t last = std::min<std::uint64_t>(entries_.size(), first + at_once_);
    clear(found_, stream_.get());
    launch("find_pairs", find_pairs, over(last - first, kThreads), stream_, grid_, patches_.data(),
           dirty_.data(), first, last, Patches::kQuarters > 0, fans, pairs_.data(), pairs_.size(),
           found_.data());
    listed_ = fetch(found_.data(), stream_);
    if (listed_ <= pairs_.size()) return last;
    if (last - first > 1) {
      at_once_ = (last - first) / 2;
      continue;
    }
    pairs_ = DeviceArray<NumberPair>();
    require_device_memory(listed_ * sizeof(NumberPair), kPurpose);
    pairs_ = DeviceArray<NumberPair>(listed_, stream_.get());
  }
}

// Tests the listed pairs of patches, a part of them at a time, so that all pairs of their quarters
// have room in a list.
template <class Patches>
void CrossingFinder<Patches>::test(const MoveStatesView& move_states) {
  const unsigned most_blocks = kListBlocksPerProcessor * multiprocessors();
  const auto blocks = [=](std::uint64_t items) -> LaunchShape {
    return {std::min(blocks_for(items, kTestThreads), most_blocks), kTestThreads};
  };
  if constexpr (Patches::kQuarters == 0) {
    launch("test_triangles", test_triangles, blocks(listed_), stream_, level_.mesh, move_states,
           pairs_.data(), found_.data());
  } else {
    const std::uint64_t most = near_.size() / kQuarterPairs;
    for (std::uint64_t first = 0; first < listed_; first += most) {
      const std::uint64_t count = std::min(most, listed_ - first);
      NumberPair* const pairs = pairs_.data() + first;
      if constexpr (!Patches::kHasParts) {
        launch("drop_kept_apart of patches", drop_kept_apart, over(count, kTestThreads), stream_,
               level_, pairs, count, nullptr);
      }
      clear(near_count_, stream_.get());
      launch("list_quarters", list_quarters<Patches>, over(count, kTestThreads), stream_,
             quarters_.data(), pairs, count, near_.data(), near_count_.data());
      const LaunchShape lists = blocks(kQuarterPairs * count);
      if constexpr (Patches::kHasParts) {
        launch("drop_kept_apart of parts", drop_kept_apart, lists, stream_, level_, near_.data(),
               near_.size(), near_count_.data());
        launch("test_parts", test_parts, lists, stream_, level_.mesh, move_states, near_.data(),
               near_count_.data());
      } else {
        launch("test_triangles", test_triangles, lists, stream_, level_.mesh, move_states,
               near_.data(), near_count_.data());
      }
    }
  }
}

// Notes which patches the pass must test, and makes the cells dirty in which these are. The fans of
// patches that have changed are judged anew.
template <class Patches>
void CrossingFinder<Patches>::want(const MoveStatesView& move_states, int pass,
                                   const EdgeList& changed) {
  const LaunchShape each = over(patches_.size(), kThreads);
  clear(dirty_, stream_.get());
  if constexpr (Patches::kQuarters > 0) {
    if (pass == 1) launch("want_none", want_none, each, stream_, patches_.data(), patches_.size());
    if (pass > 0) {
      const DeviceArray<std::uint32_t> listed(2 * changed.count, stream_.get());
      const auto count = zeros<unsigned long long>(1, stream_);
      launch("want_listed", want_listed<Patches>, over(2 * changed.count, kThreads), stream_,
             level_, grid_, changed, patches_.data(), dirty_.data(), listed.data(), count.data());
      launch("renew_fans", renew_fans<Patches>, over(6 * changed.count, kThreads), stream_, level_,
             listed.data(), count.data(), patches_.data(), directions_.data(), fans_.data());
      return;
    }
  } else if (pass > 0) {
    launch("renew_wanted", renew_wanted, each, stream_, level_, move_states, pass, patches_.data());
  }
  launch("mark_dirty", mark_dirty, each, stream_, grid_, patches_.data(), patches_.size(),
         dirty_.data());
}

template <class Patches>
void CrossingFinder<Patches>::mark(const MoveStatesView& move_states, int pass,
                                   const EdgeList& changed) {
  if (patches_.size() == 0) return;
  want(move_states, pass, changed);
  const FanState* const fans = pass > 0 ? fans_.data() : nullptr;
  for (std::uint64_t first = 0; first < entries_.size();) {
    first = find(first, fans);
    test(move_states);
  }
  if constexpr (Patches::kQuarters > 0) {
    if (pass == 0) return;
    launch("forget_listed", forget_listed<Patches>, over(2 * changed.count, kThreads), stream_,
           level_, changed, patches_.data());
  }
}

// Of each patch what the survey knows, the boxes of its quarters, the offset and the mark of at
// most one cell, and about three entries. There is about one corner for two patches, each with
// the state and the direction of its fan. Then the list of pairs of patches, and if they have
// quarters that of these.
std::uint64_t crossing_search_bytes(std::uint64_t patches, bool has_quarters,
                                    std::uint64_t pairs_at_once) {
  const std::uint64_t of_quarters =
      has_quarters ? 4 * sizeof(FloatBox) + (sizeof(FanState) + sizeof(Vec3f)) / 2 : 0;
  const std::uint64_t of_cells = 3 * sizeof(CellEntry) + sizeof(unsigned long long) + 1;
  const std::uint64_t per_entry = has_quarters ? kPairsOfPatch : kPairsOfTriangle;
  return patches * (sizeof(SurveyedPatch) + of_quarters + of_cells) +
         (has_quarters ? 2 : 1) * std::min(3 * patches * per_entry, pairs_at_once) *
             sizeof(NumberPair);
}

template class CrossingFinder<GivenPatches>;
template class CrossingFinder<MidpointPatches>;
template class CrossingFinder<DividedPatches>;

}  // namespace vdwmesh
