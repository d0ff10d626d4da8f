// Arrays go to MPI in pieces: MPI 3 counts elements by int, and implementations have lost bytes of
// files beyond 1 GiB (Open MPI issues 2399 and 14379).
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace vdwmesh {

inline constexpr std::size_t kMostBytesOfACall = std::size_t{1} << 30;

// Calls transfer(first byte, number of bytes) for the pieces of an array, in their order.
template <class Byte, class Transfer>
void in_pieces(std::span<Byte> bytes, const Transfer& transfer) {
  for (std::size_t done = 0; done < bytes.size(); done += kMostBytesOfACall) {
    transfer(bytes.data() + done,
             static_cast<int>(std::min(kMostBytesOfACall, bytes.size() - done)));
  }
}

}  // namespace vdwmesh
