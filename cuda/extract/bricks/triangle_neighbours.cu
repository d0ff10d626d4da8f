// Finds the neighbours of every brick in the list of bricks, by binary searches in their rising
// keys: neighbours along x stand next to each other, so five searches find all ten.
#include "core/errors.hpp"
#include "core/first_from.hpp"
#include "cuda/extract/bricks/triangle_neighbours.cuh"
#include "cuda/memory/launch.cuh"
#include "extract/grid.hpp"

namespace vdwmesh {
namespace {

// The difference between the keys of neighbours along y and along z (see brick_key()); along x it
// is 1.
constexpr std::uint64_t kStepY = std::uint64_t{1} << 21, kStepZ = std::uint64_t{1} << 42;

// Writes neighbours[own] of every brick. `keys` are the keys of all bricks, rising. Six threads per
// brick, one for each task; blockIdx.y is the task. Neighbours along x are next to each other in
// the list if both are in it, so the ten neighbours need only five binary searches:
// - task 0: the two neighbours along x, without a search;
// - tasks 1 to 3: the upper neighbour along y (1), along z (2), or along both (3), and the next
//   brick along x from there;
// - tasks 4 and 5: the lower neighbour along y or z.
__global__ void find_neighbours(const std::uint64_t* keys, std::uint32_t size,
                                TriangleNeighbours* neighbours) {
  const std::uint32_t own = blockIdx.x * blockDim.x + threadIdx.x;
  if (own >= size) return;
  std::uint32_t* place = neighbours[own].place;
  const std::uint64_t key = keys[own];
  // The index `at` if the brick there has the wanted key, else kNoBrick.
  const auto place_of = [&](std::uint32_t at, std::uint64_t wanted) {
    return at < size && keys[at] == wanted ? at : kNoBrick;
  };
  // The index from `low` up to `end` of the first key that is at least `wanted`, or `end`.
  const auto first_at_least = [&](std::uint32_t low, std::uint32_t end, std::uint64_t wanted) {
    return first_from(low, end, [&](std::uint32_t i) { return keys[i] < wanted; });
  };
  const auto task = static_cast<int>(blockIdx.y);
  if (task == 0) {
    // At x = 0 there is no lower neighbour, and key - 1 would borrow from y.
    const bool first = brick_of_key(key).x == 0 || own == 0;
    place[neighbour_across(0)] = first ? kNoBrick : place_of(own - 1, key - 1);
    place[upper_neighbour(1, 0, 0)] = place_of(own + 1, key + 1);
  } else if (task <= 3) {
    const int dy = task & 1, dz = task >> 1;
    const std::uint64_t wanted = key + (dy ? kStepY : 0) + (dz ? kStepZ : 0);
    const std::uint32_t at = first_at_least(own + 1, size, wanted);
    // If the wanted brick is not in the list, `at` is where the next larger key stands, maybe
    // wanted + 1.
    const std::uint32_t there = place_of(at, wanted);
    place[upper_neighbour(0, dy, dz)] = there;
    place[upper_neighbour(1, dy, dz)] = place_of(there == kNoBrick ? at : at + 1, wanted + 1);
  } else {
    const bool along_y = task == 4;
    const BrickIndex index = brick_of_key(key);
    const bool first = (along_y ? index.y : index.z) == 0;
    const std::uint64_t wanted = key - (along_y ? kStepY : kStepZ);
    place[neighbour_across(along_y ? 2 : 4)] =
        first ? kNoBrick : place_of(first_at_least(0, own, wanted), wanted);
  }
}

}  // namespace

void find_triangle_neighbours(const KeyList& keys, TriangleNeighbours* neighbours,
                              const Stream& stream) {
  if (keys.count >= kNoBrick) throw LimitExceeded("more bricks than 32 bits number");
  constexpr unsigned threads = 128;
  launch("find_neighbours", find_neighbours, {dim3(blocks_for(keys.count, threads), 6), threads},
         stream, keys.keys.data(), static_cast<std::uint32_t>(keys.count), neighbours);
}

}  // namespace vdwmesh
