// Memory of the host for batches of patches on their way to a device and back, and the offsets
// of their results.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/large_pages.hpp"
#include "cuda/mesher/mesh_patches.cuh"

namespace vdwmesh::mesher {

// An array of the host that is used for one batch after another, since the first write to a page
// costs more than the others, on large pages. It need not be page-locked: upload_parts() and
// download_parts() copy through page-locked memory of their own.
template <class T>
class KeptRoom {
 public:
  // An array of at least `count` elements, whose values are undefined.
  T* take(std::size_t count) {
    if (count > size_) {
      room_.reset();
      room_ = std::make_unique_for_overwrite<T[]>(count);
      advise_large_pages(room_.get(), count);
      size_ = count;
    }
    return room_.get();
  }
  T* data() const { return room_.get(); }

 private:
  std::unique_ptr<T[]> room_;
  std::size_t size_ = 0;
};

// Where the results of each patch go, one after another; the last offsets are the ends.
inline std::vector<ResultOffsets> offsets_of(const PatchOutcome* outcomes, std::size_t count) {
  std::vector<ResultOffsets> offsets(count + 1, ResultOffsets{0, 0, 0});
  for (std::size_t i = 0; i < count; ++i) {
    const PatchOutcome& o = outcomes[i];
    const bool failed = o.failure != PatchFailure::none;
    offsets[i + 1] = {offsets[i].interior + (failed ? 0 : o.interior),
                      offsets[i].triangle + (failed ? 0 : o.triangles),
                      offsets[i].split + (failed ? 0 : o.splits)};
  }
  return offsets;
}

}  // namespace vdwmesh::mesher
