// Finds the bricks that the surface may cross, by descending an octree from coarse to fine. The
// elements of the octree are lattice blocks: 2^level bricks along each axis. ("Node" below is
// always a node of the grid, "thread block" is CUDA's word.) Each level of the descent tests the
// eight children of every lattice block that the level above has kept, with bounds on the field
// over the child's box: the tests of extract/blended/block_bounds.hpp in float32. The children that
// pass are compacted into a list. The bricks, which are the blocks of level 0, are marked among all
// bricks of the grid, and the marks give the list in the order of keys. Where the grid has many
// times more bricks than are tested, the kept ones are compacted as on other levels and sorted.
//
// One warp tests one parent. The warp gathers the spheres near the parent, and all eight children
// are tested against them at once: four lanes per child, each of which takes every fourth sphere.
// At the end the four lanes combine their results.
//
// Of a stack of fields (fields.cuh) all surfaces are searched at once. The grids of a stack stand
// on each other along z, and a block's key has its index in the stack. To find where it lies, the
// layers of the fields below its own are subtracted, which gives its index in its field's grid.
//
// A test may keep a block without surface, but it drops none that has some: all bounds are widened
// by more than the rounding errors of float32. For blended fields FieldBounds does this (its
// margins grow with the number of atoms, so they cover the rounding of sums), for the union of
// balls UnionTest::add().
#include <array>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_select.cuh>
#include <string>
#include <utility>

#include "cuda/extract/bricks/marked_bricks.cuh"
#include "cuda/extract/bricks/ordered_gather.cuh"
#include "cuda/memory/cub_calls.cuh"
#include "cuda/memory/launch.cuh"
#include "extract/blended/block_bounds.hpp"
#include "extract/blended/local_atom.hpp"

namespace vdwmesh {
namespace {

constexpr unsigned kThreads = 128;

constexpr int kChildren = 8;
// Lane c + 8 p of a warp tests child c = 0 .. 7 against part p = 0 .. 3 of the spheres: those whose
// number in the gathered batch is p modulo 4.
constexpr unsigned kLanesPerChild = kWarp / kChildren;

__device__ int own_child() { return static_cast<int>(threadIdx.x % kChildren); }
__device__ unsigned own_part() { return threadIdx.x % kWarp / kChildren; }

// A sphere near a parent block. Vectors lead to the middle of the parent: they are short, so
// float32 suffices.
struct NearSphere {
  float from[3];  // from the sphere's centre to the middle of the parent, Å
  float size;     // Test::size_of(): the radius (Å) for the union, the scale (1/Å²) for a field
  Vec3d center;   // Å; plane_in_subgrid() needs it in double, for the thesis presets
};

// A warp's shared memory: the list places of gathered spheres, and the batch of up to 32 spheres
// that is being tested. gather_by_warp() hands over places as soon as there are 32. The lanes add
// up to 32 places at once to the up to 31 that wait, so `place` is twice as long.
struct Waiting {
  ListPlace place[2 * kWarp];
  NearSphere sphere[kWarp];
};

// The child block that a lane tests.
struct ChildBlock {
  LatticeBlock nodes;
  BlockBox box;
  // from_parent: from the parent's middle to the child's middle. half: half the size of the box. Å.
  float from_parent[3], half[3];
};

__device__ ChildBlock child_block(const GridSpec& grid, const BrickIndex& child, int level,
                                  const Vec3d& parent_middle) {
  ChildBlock c{};
  c.nodes = lattice_block(child, level);
  c.box = block_box(grid, c.nodes);
  // `middle` is in double and `half` in float. The difference of two middles is taken in double, so
  // that only the short result is rounded.
  const BoxFrame<float> frame = box_frame<float>(c.box.lower, c.box.upper);
  for (int axis = 0; axis < 3; ++axis) {
    c.from_parent[axis] = static_cast<float>(frame.middle[axis] - parent_middle[axis]);
    c.half[axis] = frame.half[axis];
  }
  return c;
}

// Vote of the warp: bit c of the result is set if `says` is true on at least one of the four lanes
// of child c. The ballot has a bit per lane, 8 p + c, so its four bytes are the parts p. The loop
// ors the upper half onto the lower half, then again: all four bytes meet in the lowest.
__device__ unsigned vote_by_child(bool says) {
  unsigned votes = __ballot_sync(kAllLanes, says);
  for (unsigned step = kWarp / 2; step >= kChildren; step /= 2) votes |= votes >> step;
  return votes & ((1u << kChildren) - 1);
}
// What vote_by_child() returns if every child has a lane with a true vote.
constexpr unsigned kAllChildren = (1u << kChildren) - 1;

// The test of a child for a blended field. Each lane adds its part of the atoms to `bounds`,
// which counts them and sums bounds on what each contributes: its least and its most, and as
// functions of the place its tangent and its chord (FieldBounds in block_bounds.hpp). join() adds
// the sums of the child's four lanes; bounds.lower() and bounds.upper() then bound the field in
// the child's box.
template <BlendedKind Kind>
struct BlendedTest {
  ShapeParameters<float> shape;
  float isovalue;
  FieldBounds<float> bounds;
  bool stopped_early = false;  // see can_stop()

  __device__ explicit BlendedTest(const FieldContext& f)
      : shape(f.shape), isovalue(static_cast<float>(f.model.isovalue)) {}
  __device__ static float size_of(const FieldModel& m, const Sphere& s) {
    return static_cast<float>(inverse_square_scale(m, s.radius));
  }
  __device__ void add(const FieldModel& m, const NearSphere& s, const float (&to_middle)[3],
                      const ChildBlock& child) {
    bounds.add<Kind>(shape, s.size, to_middle, child.half,
                     subgrid_overlap(m, child.nodes, s.center));
  }
  // The early exit of field_may_cross() in block_bounds.hpp, for the whole warp. True if every
  // child is likely to hold surface, so that visiting more atoms is not worth its cost; all
  // children are kept then, and their own children are tested on the next level. The conditions
  // are:
  // - The children are of level 3 or above. Smaller blocks are always tested with all atoms.
  // - bounds.most >= isovalue on a lane of each child: the atoms so far admit inside nodes. More
  //   atoms only raise this sum.
  // - bounds.least <= 0 on all lanes: the atoms so far contribute nothing that is certain over a
  //   whole child, so nothing hints that a child lies inside.
  __device__ bool can_stop(const ChildBlock& child) {
    stopped_early = child.nodes.level > 2 && __all_sync(kAllLanes, bounds.least <= 0) &&
                    vote_by_child(bounds.most >= isovalue) == kAllChildren;
    return stopped_early;
  }
  // Replaces the sums of each lane by those of its child.
  __device__ void join() {
    join(bounds.least);
    join(bounds.most);
    join(bounds.atoms);
    join(bounds.tangents);
    join(bounds.chords);
    for (int axis = 0; axis < 3; ++axis) {
      join(bounds.tangent_slope[axis]);
      join(bounds.chord_slope[axis]);
    }
  }
  // Whether all nodes of the child are proved to be outside, or inside. After an early exit atoms
  // are missing from the sums, which are no bounds then: both answers are false, and the child is
  // kept.
  __device__ bool is_outside(const ChildBlock& child) const {
    return !stopped_early && bounds.upper(child.half) < isovalue;
  }
  __device__ bool is_inside(const ChildBlock& child) const {
    return !stopped_early && bounds.lower(child.half) >= isovalue;
  }

 private:
  // Sum over the four lanes of a child (butterfly reduction over the lane bits 8 and 16).
  __device__ static void join(float& value) {
    value = joined_by_warp<kWarp / 2, kChildren>(value, [](float a, float b) { return a + b; });
  }
};

// The test of a child for the union of balls: whether a ball touches its box, and whether one ball
// holds all of it. Both are computed in float32. If rounding errors leave open whether a ball
// touches the box, it counts as touching; if they leave open whether it holds the box, it does not
// count as holding.
struct UnionTest {
  float largest = 0;  // the largest radius of all balls, Å
  bool touched = false, covered = false;

  // The cell list sorts spheres into levels by reach; the union's spheres reach to their radius.
  __device__ explicit UnionTest(const FieldContext& f) {
    for (int l = 0; l < f.list.level_count; ++l) {
      largest = fmaxf(largest, __double2float_ru(f.list.levels[l].reach));
    }
  }
  __device__ static float size_of(const FieldModel&, const Sphere& s) {
    return static_cast<float>(s.radius);
  }
  __device__ void add(const FieldModel&, const NearSphere& s, const float (&to_middle)[3],
                      const ChildBlock& child) {
    // Squared distances (Å²) of the nearest and of the farthest point of the box from the centre of
    // the ball. `extent` (Å) bounds all coordinates that are rounded on the way: `end`, to_middle,
    // from_parent, and NearSphere::from, which is to_middle less from_parent.
    float near = 0, far = 0, extent = 0;
    for (int axis = 0; axis < 3; ++axis) {
      // Distances from the centre along the axis: of the box's middle, and of its far end.
      const float away = fabsf(to_middle[axis]), end = away + child.half[axis];
      const float gap = fmaxf(away - child.half[axis], 0.0f);
      near = fmaf(gap, gap, near);
      far = fmaf(end, end, far);
      extent += end + fabsf(child.from_parent[axis]);
    }
    // A bound on the errors in Å. A rounding to float32 costs at most one unit, 2^-24 times
    // `extent`. A coordinate of to_middle costs three units: NearSphere::from and from_parent are
    // rounded, and so is their sum. `half`, `end`, `gap`, squares and sums cost a few more. 2e-6 is
    // ample: it makes 33 units. `extent` counts from_parent because the border of the grid may cut
    // the child to a slice whose middle is much farther from the parent's than the slice is thick.
    const float error_bound = 2e-6f * extent, outer = s.size + error_bound;
    const float inner = fmaxf(s.size - error_bound, 0.0f);
    touched |= near <= outer * outer;
    covered |= far <= inner * inner;
  }
  // Whether the answers for all children are settled, so that more balls would not change them. A
  // covered child is inside for good. A touched child is not outside, and if its half width exceeds
  // the largest radius, no ball covers it either.
  __device__ bool can_stop(const ChildBlock& child) const {
    return vote_by_child(covered || (touched && child.half[0] > largest)) == kAllChildren;
  }
  // Replaces the two answers of each lane by those of its child: true if they are true on one of
  // its four lanes.
  __device__ void join() {
    const unsigned child = 1u << own_child();
    const unsigned touched_children = vote_by_child(touched),
                   covered_children = vote_by_child(covered);
    touched = (touched_children & child) != 0;
    covered = (covered_children & child) != 0;
  }
  // Whether no ball touches the child's box; whether one ball holds all of it. Valid after join().
  __device__ bool is_outside(const ChildBlock&) const { return !touched; }
  __device__ bool is_inside(const ChildBlock&) const { return covered; }
};

// Tests all eight children of a parent by one warp, each lane for its own `child`, with 32 gathered
// spheres at a time: each lane prepares one sphere in shared memory, then it tests its child
// against every fourth of them. Afterwards `test` has the answer for the child of the lane.
// `parent` is the parent's box.
template <class Test>
__device__ void test_child(const FieldContext& f, const BlockBox& parent,
                           const Vec3d& parent_middle, const ChildBlock& child, Waiting& waiting,
                           Test& test) {
  const unsigned lane = threadIdx.x % kWarp;
  gather_by_warp(f, parent.lower, parent.upper, waiting.place, kWarp, [&](std::uint32_t count) {
    if (lane < count) {
      const Sphere& s = f.list.spheres[waiting.place[lane]];
      const Vec3d from = parent_middle - s.center;
      waiting.sphere[lane] = {
          {static_cast<float>(from.x), static_cast<float>(from.y), static_cast<float>(from.z)},
          Test::size_of(f.model, s),
          s.center};
    }
    // The batch must be complete before any lane reads it, and be read before it is overwritten.
    __syncwarp();
    for (std::uint32_t k = own_part(); k < count; k += kLanesPerChild) {
      const NearSphere& s = waiting.sphere[k];
      const float to_middle[3] = {s.from[0] + child.from_parent[0],
                                  s.from[1] + child.from_parent[1],
                                  s.from[2] + child.from_parent[2]};
      test.add(f.model, s, to_middle, child);
    }
    __syncwarp();
    // Visitor of gather_by_warp(): true ends the gathering.
    return test.can_stop(child);
  });
  test.join();
}

// Where test_children() writes which children it keeps: to a list of all children, or, if they are
// bricks, to marks of all bricks of the grid. The arrays of the other form are null.
struct KeptChildren {
  // The list. For child c of parent i, at index 8 i + c: its key, and 1 if it is kept, else 0.
  std::uint64_t* keys = nullptr;
  std::uint8_t* keep = nullptr;
  // The marks. At the brick_number() of a brick: 1 if it is kept. Other marks are not written.
  std::uint8_t* marks = nullptr;
  std::int32_t bricks[3] = {};  // of the grid along each axis

  __device__ void write(std::uint64_t i, const BrickIndex& child, bool kept) const {
    if (marks == nullptr) {
      keys[i] = brick_key(child);
      keep[i] = kept ? 1 : 0;
    } else if (kept) {
      marks[brick_number(bricks, child)] = 1;
    }
  }
};

// A warp per parent, 4 warps per thread block, with 6 KB of shared memory. Reads the keys of
// `count` parents of level child_level + 1. Writes for each child whether it is kept: whether it
// may hold surface and may have bricks in `range`. The first lane of each child (part 0) writes.
// The bound of 6 makes the compiler use so few registers that 6 thread blocks fit on a
// multiprocessor at a time.
template <class Test, class Fields>
__global__ void __launch_bounds__(kThreads, 6)
    test_children(const __grid_constant__ Fields fields, const std::uint64_t* parents,
                  std::uint64_t count, int child_level, KeyRange range, KeptChildren result) {
  __shared__ Waiting waiting[kThreads / kWarp];
  const std::uint64_t i = thread_index() / kWarp;
  if (i >= count) return;
  const BrickIndex parent = brick_of_key(parents[i]);
  const FieldOfBlock of_block = fields.of(parents[i], child_level + 1);
  const FieldContext& f = of_block.field;
  const GridSpec& grid = f.model.grid;
  const BlockBox box = block_box(
      grid, lattice_block(of_block.index_in_field(parent, child_level + 1), child_level + 1));
  const Vec3d middle = box_frame<float>(box.lower, box.upper).middle;
  const int c = own_child();
  const BrickIndex index{2 * parent.x + (c & 1), 2 * parent.y + (c >> 1 & 1),
                         2 * parent.z + (c >> 2)};
  const ChildBlock child =
      child_block(grid, of_block.index_in_field(index, child_level), child_level, middle);
  Test test(f);
  test_child(f, box, middle, child, waiting[threadIdx.x / kWarp], test);
  if (own_part() != 0) return;
  // A child that lies inside holds surface all the same if it has virtual nodes: these are outside
  // by definition, so the mesh is closed there.
  const bool crosses =
      !test.is_outside(child) && (!test.is_inside(child) || child.box.touches_border);
  const bool kept = !child.box.empty && crosses && block_meets(range, index, child_level);
  result.write(kChildren * i + static_cast<unsigned>(c), index, kept);
}

template <class Fields>
void test_all_children(const Fields& fields, const KeyList& parents, int child_level,
                       const KeyRange& range, const KeptChildren& result, const Stream& stream) {
  const auto test = [&]<class Test>() {
    launch("test_children", test_children<Test, Fields>, over(kWarp * parents.count, kThreads),
           stream, fields, parents.keys.data(), parents.count, child_level, range, result);
  };
  if (fields.kind() == FieldKind::vdw) {
    test.template operator()<UnionTest>();
  } else {
    with_blended(fields.kind(),
                 [&]<class Kind>(Kind) { test.template operator()<BlendedTest<Kind>>(); });
  }
}

// Throws LimitExceeded if there are more than `most` bricks, the number that fits in the memory
// allowed. Blocks above level 0 are not bricks: one may have several with surface, or none.
void check_kept(std::uint64_t count, std::uint64_t most) {
  if (count <= most) return;
  throw LimitExceeded("the search for the surface keeps " + std::to_string(count) +
                      " bricks of 8 x 8 x 8 nodes; at most " + std::to_string(most) +
                      " fit in the memory allowed: choose a larger spacing");
}

// The children of `parents` that test_children() keeps, in the order of the parents.
template <class Fields>
KeyList surviving_children(const Fields& fields, const KeyList& parents, int child_level,
                           const KeyRange& range, const Stream& stream) {
  const std::uint64_t children = kChildren * parents.count;
  KeyList result;
  if (children == 0) return result;
  const DeviceArray<std::uint64_t> keys(children, stream.get());
  const DeviceArray<std::uint8_t> keep(children, stream.get());
  test_all_children(fields, parents, child_level, range, {keys.data(), keep.data()}, stream);
  result.keys = DeviceArray<std::uint64_t>(children, stream.get());
  const DeviceArray<std::uint64_t> count(1, stream.get());
  run_cub("select", stream.get(), [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::Flagged(scratch, bytes, keys.data(), keep.data(), result.keys.data(),
                                      count.data(), static_cast<std::int64_t>(children),
                                      stream.get());
  });
  result.count = fetch(count.data(), stream);
  return result;
}

// The number of bricks along each axis: of the field's grid, or of the whole stack.
using BrickCount3 = std::array<std::int32_t, 3>;
BrickCount3 bricks_of(const OneField& fields) {
  const Vec3i& cells = fields.context.model.grid.cells;
  return {brick_count(cells.x), brick_count(cells.y), brick_count(cells.z)};
}
BrickCount3 bricks_of(const FieldStack& fields) {
  return {fields.bricks[0], fields.bricks[1], fields.bricks[2]};
}

// The bricks that test_children() keeps, by rising key: by marks.
template <class Fields>
KeyList marked_children(const Fields& fields, const KeyList& parents, const KeyRange& range,
                        const Stream& stream) {
  KeptChildren result;
  std::uint64_t total = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.bricks[axis] = bricks_of(fields)[axis];
    total *= static_cast<std::uint64_t>(result.bricks[axis]);
  }
  const DeviceArray<std::uint8_t> marks = zeros<std::uint8_t>(total, stream.get());
  result.marks = marks.data();
  test_all_children(fields, parents, 0, range, result, stream);
  const std::uint64_t most_marked = std::min(total, kChildren * parents.count);
  return keys_of_marks(marks.data(), result.bricks, most_marked, stream);
}

// The same by sorting.
template <class Fields>
KeyList sorted_children(const Fields& fields, const KeyList& parents, const KeyRange& range,
                        const Stream& stream) {
  KeyList blocks = surviving_children(fields, parents, 0, range, stream);
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

// The lattice blocks with which the descent begins: all blocks of one level, untested. This is the
// finest level with at most kFirstBlocks blocks; coarser ones would not keep the device busy. It is
// at least 1, since the descent tests only children, and level 0 is its end.
struct FirstBlocks {
  KeyList blocks;
  int level;
};

constexpr std::int64_t kFirstBlocks = 65536;

// Writes the keys of all lattice blocks of a box, `width` along x, `height` along y and `count` in
// all, x fastest. A thread per lattice block.
__global__ void list_blocks(std::int64_t width, std::int64_t height, std::int64_t count,
                            std::uint64_t* keys) {
  const std::int64_t i = static_cast<std::int64_t>(thread_index());
  if (i >= count) return;
  keys[i] = brick_key({static_cast<std::int32_t>(i % width),
                       static_cast<std::int32_t>(i / width % height),
                       static_cast<std::int32_t>(i / width / height)});
}

FirstBlocks first_blocks(const OneField& fields, const Stream& stream) {
  const GridSpec& grid = fields.context.model.grid;
  std::int64_t count[3], all = 0;
  int level = 0;
  do {
    ++level;
    const std::int32_t side = 1 << level;
    for (int axis = 0; axis < 3; ++axis)
      // A block at the end may reach beyond the grid.
      count[axis] = (brick_count(grid.cells[axis]) + side - 1) / side;
    all = count[0] * count[1] * count[2];
  } while (all > kFirstBlocks);
  const auto size = static_cast<std::size_t>(all);
  FirstBlocks first{{DeviceArray<std::uint64_t>(size, stream.get()), size}, level};
  launch("list_blocks", list_blocks, over(size, kThreads), stream, count[0], count[1], all,
         first.blocks.keys.data());
  return first;
}

// The same for the blocks of a stack: a thread block for each field.
__global__ void list_stacked_blocks(FieldStack stack, std::uint64_t* keys) {
  const StackedField& field = stack.fields[blockIdx.x];
  const std::int64_t width = field.blocks[0], height = field.blocks[1];
  const std::int64_t count = width * height * field.blocks[2];
  // The field's lowest layer, in blocks; in bricks it is a multiple of 2^first_level.
  const std::int32_t first = field.first_layer >> stack.first_level;
  for (std::int64_t i = threadIdx.x; i < count; i += blockDim.x) {
    keys[field.first_block + static_cast<std::uint64_t>(i)] = brick_key(
        {static_cast<std::int32_t>(i % width), static_cast<std::int32_t>(i / width % height),
         first + static_cast<std::int32_t>(i / width / height)});
  }
}

FirstBlocks first_blocks(const FieldStack& fields, const Stream& stream) {
  const std::uint64_t size = fields.first_blocks;
  FirstBlocks first{{DeviceArray<std::uint64_t>(size, stream.get()), size}, fields.first_level};
  launch("list_stacked_blocks", list_stacked_blocks, {fields.field_count, kThreads}, stream, fields,
         first.blocks.keys.data());
  return first;
}

template <class Fields>
KeyList candidates_of(const Fields& fields, const KeyRange& range, std::uint64_t most,
                      const Stream& stream) {
  FirstBlocks first = first_blocks(fields, stream);
  KeyList blocks = std::move(first.blocks);
  for (int level = first.level; level > 1; --level) {
    blocks = surviving_children(fields, blocks, level - 1, range, stream);
  }
  // Marks cost a byte per brick of the grid, to be cleared and read; a list costs 17 bytes per
  // child and a sort. Up to this many marks per child, marking takes no longer than sorting.
  constexpr double marks_per_child = 64;
  double marks = 1;
  for (const std::int32_t bricks : bricks_of(fields)) marks *= bricks;
  const bool few_marks = marks <= marks_per_child * kChildren * static_cast<double>(blocks.count);
  blocks = few_marks ? marked_children(fields, blocks, range, stream)
                     : sorted_children(fields, blocks, range, stream);
  check_kept(blocks.count, most);
  return blocks;
}

}  // namespace

KeyList candidate_bricks_on_device(const OneField& fields, const KeyRange& range,
                                   std::uint64_t most, const Stream& stream) {
  return candidates_of(fields, range, most, stream);
}

KeyList candidate_bricks_on_device(const FieldStack& fields, const KeyRange& range,
                                   std::uint64_t most, const Stream& stream) {
  return candidates_of(fields, range, most, stream);
}

}  // namespace vdwmesh
