// Bricks marked in an array that has a byte for each brick of the grid, as a list of rising keys:
// the marks stand in the order of the keys, so nothing is sorted.
#pragma once

#include "cuda/extract/bricks/extract_stages.cuh"

namespace vdwmesh {

// Where brick (x, y, z) stands among all bricks of a grid that has bricks[0] x bricks[1] x
// bricks[2] of them: x fastest and z slowest. Keys rise with this number.
VDWMESH_HD inline std::int64_t brick_number(const std::int32_t (&bricks)[3],
                                            const BrickIndex& brick) {
  return (static_cast<std::int64_t>(brick.z) * bricks[1] + brick.y) * bricks[0] + brick.x;
}

// Keys, rising, of the bricks whose mark is not 0. Precondition: at most `most_marked` are, for
// which there is room.
KeyList keys_of_marks(const std::uint8_t* marks, const std::int32_t (&bricks)[3],
                      std::uint64_t most_marked, const Stream& stream);

}  // namespace vdwmesh
