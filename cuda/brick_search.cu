// Which bricks the surface can cross: octree descent, a thread per block.
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_select.cuh>
#include <string>
#include <utility>
#include <vector>

#include "cuda/cub_calls.cuh"
#include "cuda/extract_stages.cuh"
#include "extract/block_bounds.hpp"

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

KeyList surviving_children(const FieldContext& f, const KeyList& parents, int child_level,
                           std::uint64_t most, const Stream& stream) {
  const std::uint64_t children = 8 * parents.count;
  KeyList result;
  if (children == 0) return result;
  const DeviceArray<std::uint64_t> keys(children, stream.get());
  const DeviceArray<std::uint8_t> keep(children, stream.get());
  test_children<<<blocks_for(children, kThreads), kThreads, 0, stream.get()>>>(
      f, parents.keys.data(), parents.count, child_level, keys.data(), keep.data());
  check_launch("test_children");
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

constexpr std::int64_t kFirstBlocks = 4096;

FirstBlocks first_blocks(const GridSpec& grid, const Stream& stream) {
  std::int64_t count[3];
  int level = 0;
  do {
    ++level;
    const std::int32_t side = 1 << level;
    for (int axis = 0; axis < 3; ++axis)
      count[axis] = (brick_count(grid.cells[axis]) + side - 1) / side;
  } while (count[0] * count[1] * count[2] > kFirstBlocks);
  std::vector<std::uint64_t> keys;
  for (std::int32_t z = 0; z < count[2]; ++z) {
    for (std::int32_t y = 0; y < count[1]; ++y) {
      for (std::int32_t x = 0; x < count[0]; ++x) keys.push_back(brick_key({x, y, z}));
    }
  }
  FirstBlocks first{{upload(keys.data(), keys.size(), stream.get()), keys.size()}, level};
  stream.wait();  // the host's keys go
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
