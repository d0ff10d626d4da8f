// Packs boundaries for first looks on a device (boundary_look.hpp), many of them in one piece of
// memory in the order of their size, and unpacks what comes back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "creases/share/boundary_look.hpp"
#include "creases/share/patch_device.hpp"

namespace vdwmesh {

class LookBatch {
 public:
  // Takes the jobs in their order, each that still fits with those taken before in so many bytes on
  // a device, but none with too many points for one thread. Keeps a view of them.
  LookBatch(std::span<const LookJob> jobs, std::uint64_t most_bytes);

  // Descending by size, so that threads side by side have about as much to do.
  std::span<const BoundedLook> looks() const { return looks_; }
  // The job of look i.
  std::uint32_t job(std::size_t i) const { return order_[i]; }
  std::size_t input_bytes() const { return input_bytes_; }
  std::size_t state_bytes() const { return state_bytes_; }
  std::size_t work_bytes() const { return work_bytes_; }
  // How many requests all looks may have together.
  std::size_t most_requests() const { return most_requests_; }

  // Writes the packed boundaries, on all cores.
  void pack(std::byte* input) const;
  // Gives the job of look i its triangulation. Returns the requests as mesh_patch() has them: those
  // given, of the look, and those for the area of the patch.
  PatchVector<PieceSplit> finish(std::size_t i, std::byte* states,
                                 std::span<const PieceSplit> requests) const;

 private:
  std::span<const LookJob> jobs_;
  std::vector<std::uint32_t> order_;
  std::vector<BoundedLook> looks_;
  std::size_t input_bytes_ = 0, state_bytes_ = 0, work_bytes_ = 0, most_requests_ = 0;
};

}  // namespace vdwmesh
