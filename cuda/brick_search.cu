// Which bricks the surface can cross: octree descent. A thread per block for the union of balls;
// for blended fields a warp per parent, whose lanes take an atom each and bound it for all
// children.
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_select.cuh>
#include <string>
#include <utility>

#include "cuda/cub_calls.cuh"
#include "cuda/extract_stages.cuh"
#include "cuda/ordered_gather.cuh"
#include "extract/block_bounds.hpp"
#include "extract/local_atom.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 128;

// One thread per child of a block: keeps the key of the child where it may hold surface.
__global__ void test_children(FieldContext f, const std::uint64_t* parents, std::uint64_t count,
                              int child_level, std::uint64_t* keys, std::uint8_t* keep) {
  const std::uint64_t i = static_cast<std::uint64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= 8 * count) return;
  const BrickIndex parent = brick_of_key(parents[i / 8]);
  const int c = static_cast<int>(i % 8);
  const BrickIndex child{2 * parent.x + (c & 1), 2 * parent.y + (c >> 1 & 1),
                         2 * parent.z + (c >> 2)};
  keys[i] = brick_key(child);
  keep[i] = may_hold_surface(f.list, f.model, lattice_block(child, child_level)) ? 1 : 0;
}

// Squared distances along one axis from an atom to the nearest and the farthest of a block's nodes.
struct AxisRange {
  float least, most;
};

// Both halves of a parent along one axis.
struct Halves {
  double lower[2], upper[2];       // Å
  std::int64_t first[2], last[2];  // lattice nodes
  bool empty[2], touches_border[2];
};

__device__ Halves halves_of(const GridSpec& grid, int axis, std::int32_t parent, int child_level) {
  Halves h{};
  const std::int64_t side = static_cast<std::int64_t>(kBrickSide) << child_level;
  const std::int64_t end = grid.cells[axis] + 1;
  for (int half = 0; half < 2; ++half) {
    h.first[half] = (2 * static_cast<std::int64_t>(parent) + half) * side;
    h.last[half] = h.first[half] + side;
    const std::int64_t first = h.first[half] < 1 ? 1 : h.first[half];
    const std::int64_t last = h.last[half] > end ? end : h.last[half];
    h.touches_border[half] = first != h.first[half] || last != h.last[half];
    h.empty[half] = first > last;
    h.lower[half] = lattice_coordinate(grid, axis, first);
    h.upper[half] = lattice_coordinate(grid, axis, last);
  }
  return h;
}

__device__ AxisRange range_to(const Halves& h, int half, double center) {
  const double a = h.lower[half] - center, b = h.upper[half] - center;
  const auto near = static_cast<float>(a > 0 ? a : (b < 0 ? -b : 0));
  const auto far = static_cast<float>(-a > b ? -a : b);
  return {near * near, far * far};
}

constexpr int kChildren = 8;

// Bounds on the field in the children of a parent; float sums, which the margin covers.
struct ChildBounds {
  float least[kChildren] = {}, most[kChildren] = {};
};

// Whether the atom's sub-grid meets, and whether it holds, a half of the parent along an axis.
__device__ SubgridOverlap subgrid_overlap(const FieldModel& m, const Halves& h, int axis, int half,
                                          double center) {
  if (m.truncation != Truncation::subgrid) return {true, true};
  const std::int64_t cell = subgrid_cell(m.grid, axis, center);
  const std::int64_t low = cell - m.subgrid_cells + 1, high = cell + m.subgrid_cells + 1;
  return {h.last[half] >= low && h.first[half] <= high,
          h.first[half] >= low && h.last[half] <= high};
}

template <FieldKind kind>
__device__ void add_to_bounds(const FieldModel& m, const ShapeParameters<float>& shape,
                              const Halves (&halves)[3], const Sphere& atom, ChildBounds& bounds) {
  const auto scale = static_cast<float>(inverse_square_scale(m, atom.radius));
  AxisRange range[3][2];
  SubgridOverlap overlap[3][2];
  for (int axis = 0; axis < 3; ++axis) {
    for (int half = 0; half < 2; ++half) {
      range[axis][half] = range_to(halves[axis], half, atom.center[axis]);
      overlap[axis][half] = subgrid_overlap(m, halves[axis], axis, half, atom.center[axis]);
    }
  }
#pragma unroll
  for (int c = 0; c < kChildren; ++c) {
    const int x = c & 1, y = c >> 1 & 1, z = c >> 2;
    const float near = range[0][x].least + range[1][y].least + range[2][z].least;
    const float far = range[0][x].most + range[1][y].most + range[2][z].most;
    if (!overlap[0][x].meets || !overlap[1][y].meets || !overlap[2][z].meets) continue;
    bounds.most[c] += shape_value<kind>(shape, near, scale);
    if (!overlap[0][x].holds || !overlap[1][y].holds || !overlap[2][z].holds) continue;
    bounds.least[c] += shape_value<kind>(shape, far, scale);
  }
}

__device__ float warp_sum(float value) {
  for (unsigned step = kWarp / 2; step > 0; step /= 2) {
    value += __shfl_xor_sync(kAllLanes, value, static_cast<int>(step));
  }
  return value;
}

constexpr double kBoundMargin = 1e-3;  // relative, of sums in single precision

// Large blocks with enough of both sides in sight need no exact sums.
__device__ bool all_mixed(const ChildBounds& bounds, float isovalue) {
  bool mixed = true;
  for (int c = 0; c < kChildren; ++c) {
    mixed &= __any_sync(kAllLanes, bounds.most[c] >= isovalue) &&
             __all_sync(kAllLanes, bounds.least[c] == 0);
  }
  return mixed;
}

// Places that wait until they fill a warp.
struct WaitingAtoms {
  std::uint32_t place[2 * kWarp];
};

// The atoms near the parent: those that reach it are collected, and bounded 32 at a time.
template <FieldKind kind>
__device__ ChildBounds bound_children(const FieldContext& f, const Halves (&halves)[3],
                                      int child_level, WaitingAtoms& waiting) {
  const unsigned lane = threadIdx.x % kWarp;
  const ShapeParameters<float> shape = shape_parameters<float>(f.model);
  const auto isovalue = static_cast<float>(f.model.isovalue);
  const Halves &hx = halves[0], &hy = halves[1], &hz = halves[2];
  const auto top = [](const Halves& h) { return h.empty[1] ? h.upper[0] : h.upper[1]; };
  const Vec3d lower{hx.lower[0], hy.lower[0], hz.lower[0]}, upper{top(hx), top(hy), top(hz)};
  ChildBounds bounds;
  std::uint32_t count = 0;
  bool done = false;
  const auto bound_first = [&](std::uint32_t atoms) {
    __syncwarp();
    if (lane < atoms) {
      add_to_bounds<kind>(f.model, shape, halves, f.list.spheres[waiting.place[lane]], bounds);
    }
    __syncwarp();
    count -= atoms;
    if (lane < count) waiting.place[lane] = waiting.place[kWarp + lane];
    done = child_level > 2 && all_mixed(bounds, isovalue);
  };
  for (int l = 0; l < f.list.level_count && !done; ++l) {
    visit_level_by_warp(f.list.levels[l], lower, upper, [&](std::uint32_t place, bool valid) {
      const bool kept = valid && reaches_box(f.model, lower, upper, f.list.spheres[place]);
      const unsigned votes = __ballot_sync(kAllLanes, kept);
      if (kept) waiting.place[count + __popc(votes & ((1u << lane) - 1))] = place;
      count += static_cast<std::uint32_t>(__popc(votes));
      if (count >= kWarp) bound_first(kWarp);
      return done;
    });
  }
  if (!done) bound_first(count);
  return bounds;
}

template <FieldKind kind>
__global__ void __launch_bounds__(kThreads)
    test_blended_children(FieldContext f, const std::uint64_t* parents, std::uint64_t count,
                          int child_level, std::uint64_t* keys, std::uint8_t* keep) {
  __shared__ WaitingAtoms waiting[kThreads / kWarp];
  const unsigned lane = threadIdx.x % kWarp;
  const std::uint64_t i =
      (static_cast<std::uint64_t>(blockIdx.x) * blockDim.x + threadIdx.x) / kWarp;
  if (i >= count) return;
  const BrickIndex parent = brick_of_key(parents[i]);
  const GridSpec& grid = f.model.grid;
  const Halves halves[3] = {halves_of(grid, 0, parent.x, child_level),
                            halves_of(grid, 1, parent.y, child_level),
                            halves_of(grid, 2, parent.z, child_level)};
  const ChildBounds bounds =
      bound_children<kind>(f, halves, child_level, waiting[threadIdx.x / kWarp]);
#pragma unroll
  for (int c = 0; c < kChildren; ++c) {
    const int x = c & 1, y = c >> 1 & 1, z = c >> 2;
    const double most = static_cast<double>(warp_sum(bounds.most[c])) * (1 + kBoundMargin);
    const double least = static_cast<double>(warp_sum(bounds.least[c])) * (1 - kBoundMargin);
    const bool empty = halves[0].empty[x] || halves[1].empty[y] || halves[2].empty[z];
    const bool border =
        halves[0].touches_border[x] || halves[1].touches_border[y] || halves[2].touches_border[z];
    if (static_cast<int>(lane) != c) continue;
    keys[kChildren * i + lane] = brick_key({2 * parent.x + x, 2 * parent.y + y, 2 * parent.z + z});
    keep[kChildren * i + lane] =
        !empty && most >= f.model.isovalue && (least < f.model.isovalue || border) ? 1 : 0;
  }
}

using BlendedTest = void (*)(FieldContext, const std::uint64_t*, std::uint64_t, int, std::uint64_t*,
                             std::uint8_t*);

BlendedTest blended_test_of(FieldKind kind) {
  if (kind == FieldKind::blinn) return test_blended_children<FieldKind::blinn>;
  if (kind == FieldKind::soft_object) return test_blended_children<FieldKind::soft_object>;
  return test_blended_children<FieldKind::inverse_squared>;
}

void launch_test(const FieldContext& f, const KeyList& parents, int child_level,
                 std::uint64_t* keys, std::uint8_t* keep, const Stream& stream) {
  const std::uint64_t children = kChildren * parents.count;
  if (f.model.kind == FieldKind::vdw) {
    test_children<<<blocks_for(children, kThreads), kThreads, 0, stream.get()>>>(
        f, parents.keys.data(), parents.count, child_level, keys, keep);
  } else {
    blended_test_of(
        f.model.kind)<<<blocks_for(kWarp * parents.count, kThreads), kThreads, 0, stream.get()>>>(
        f, parents.keys.data(), parents.count, child_level, keys, keep);
  }
  check_launch("test_children");
}

KeyList surviving_children(const FieldContext& f, const KeyList& parents, int child_level,
                           std::uint64_t most, const Stream& stream) {
  const std::uint64_t children = kChildren * parents.count;
  KeyList result;
  if (children == 0) return result;
  const DeviceArray<std::uint64_t> keys(children, stream.get());
  const DeviceArray<std::uint8_t> keep(children, stream.get());
  launch_test(f, parents, child_level, keys.data(), keep.data(), stream);
  result.keys = DeviceArray<std::uint64_t>(children, stream.get());
  const DeviceArray<std::uint64_t> count(1, stream.get());
  run_cub("select", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::Flagged(scratch, bytes, keys.data(), keep.data(), result.keys.data(),
                                      count.data(), static_cast<std::int64_t>(children),
                                      stream.get());
  });
  result.count = fetch(count.data(), stream);
  if (result.count > most) {
    throw LimitExceeded("the surface crosses more than " + std::to_string(result.count) +
                        " bricks of 8 x 8 x 8 nodes; at most " + std::to_string(most) +
                        " fit in the memory allowed: choose a larger spacing");
  }
  return result;
}

// All blocks of the finest level that has at most kFirstBlocks of them: a kernel's worth of work,
// where the root would keep one thread busy.
struct FirstBlocks {
  KeyList blocks;
  int level;
};

constexpr std::int64_t kFirstBlocks = 65536;

__global__ void list_blocks(std::int64_t width, std::int64_t height, std::int64_t count,
                            std::uint64_t* keys) {
  const std::int64_t i = static_cast<std::int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i >= count) return;
  keys[i] = brick_key({static_cast<std::int32_t>(i % width),
                       static_cast<std::int32_t>(i / width % height),
                       static_cast<std::int32_t>(i / width / height)});
}

FirstBlocks first_blocks(const GridSpec& grid, const Stream& stream) {
  std::int64_t count[3], all = 0;
  int level = 0;
  do {
    ++level;
    const std::int32_t side = 1 << level;
    for (int axis = 0; axis < 3; ++axis)
      count[axis] = (brick_count(grid.cells[axis]) + side - 1) / side;
    all = count[0] * count[1] * count[2];
  } while (all > kFirstBlocks);
  const auto size = static_cast<std::size_t>(all);
  FirstBlocks first{{DeviceArray<std::uint64_t>(size, stream.get()), size}, level};
  list_blocks<<<blocks_for(size, kThreads), kThreads, 0, stream.get()>>>(count[0], count[1], all,
                                                                         first.blocks.keys.data());
  check_launch("list_blocks");
  return first;
}

}  // namespace

KeyList candidate_bricks_on_device(const FieldContext& f, std::uint64_t most,
                                   const Stream& stream) {
  FirstBlocks first = first_blocks(f.model.grid, stream);
  KeyList blocks = std::move(first.blocks);
  for (int level = first.level; level > 0; --level) {
    blocks = surviving_children(f, blocks, level - 1, most, stream);
  }
  if (blocks.count == 0) return blocks;
  DeviceArray<std::uint64_t> sorted(blocks.count, stream.get());
  run_cub("sort", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortKeys(scratch, bytes, blocks.keys.data(), sorted.data(),
                                          static_cast<std::int64_t>(blocks.count), 0, 64,
                                          stream.get());
  });
  blocks.keys = std::move(sorted);
  return blocks;
}

}  // namespace vdwmesh
