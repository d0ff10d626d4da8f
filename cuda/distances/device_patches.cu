// Copies patches to the device. Their covers and corners, which stand in many arrays of the host,
// are put into one array each, and the patches point into these.
#include "core/fixed_blocks.hpp"
#include "cuda/distances/measure_distances.cuh"
#include "cuda/memory/transfer.cuh"

namespace vdwmesh::distance {
namespace {

// Patches and what belongs to them in arrays of the host, ready to be copied.
struct FlatPatches {
  Buffer<Patch> patches;
  Buffer<Sphere> balls;
  Buffer<std::uint32_t> ranks;
  Buffer<Cover> covers;
  Buffer<SphereCorner> corners;
};

struct ListSizes {
  std::size_t covers = 0, corners = 0;
};

// The numbers of covers and corners of the patches before each one, and of all.
std::vector<ListSizes> prefix_sums(std::span<const Patch> patches) {
  std::vector<ListSizes> sums(patches.size() + 1);
  for (std::size_t i = 0; i < patches.size(); ++i) {
    sums[i + 1] = {sums[i].covers + patches[i].cover_count,
                   sums[i].corners + patches[i].corner_count};
  }
  return sums;
}

// The patches point into device arrays that begin at `covers` and `corners`.
FlatPatches flatten(const ExposedSurface& surface, const std::vector<ListSizes>& first,
                    const Cover* covers, const SphereCorner* corners) {
  const std::span<const Patch> patches = surface.searched();
  FlatPatches flat;
  flat.patches.resize(patches.size());
  flat.balls.resize(patches.size());
  flat.ranks.resize(patches.size());
  flat.covers.resize(first.back().covers);
  flat.corners.resize(first.back().corners);
  for_each_index(patches.size(), [&](std::size_t i) {
    const Patch& patch = patches[i];
    flat.balls[i] = patch.ball;
    flat.ranks[i] = to_index(surface.list().rank[patch.place]);
    flat.patches[i] = patch;
    flat.patches[i].covers = covers + first[i].covers;
    flat.patches[i].corners = corners + first[i].corners;
    std::copy_n(patch.covers, patch.cover_count, flat.covers.data() + first[i].covers);
    std::copy_n(patch.corners, patch.corner_count, flat.corners.data() + first[i].corners);
  });
  return flat;
}

}  // namespace

DeviceExposedPatches::DeviceExposedPatches(const ExposedSurface& surface, const Stream& stream)
    : patches_(surface.searched().size(), stream),
      balls_(surface.searched().size(), stream),
      ranks_(surface.searched().size(), stream) {
  const std::vector<ListSizes> first = prefix_sums(surface.searched());
  covers_ = DeviceArray<Cover>(first.back().covers, stream);
  corners_ = DeviceArray<SphereCorner>(first.back().corners, stream);
  const FlatPatches flat = flatten(surface, first, covers_.data(), corners_.data());
  upload_parts({{patches_.data(), flat.patches.data(), patches_.bytes()},
                {balls_.data(), flat.balls.data(), balls_.bytes()},
                {ranks_.data(), flat.ranks.data(), ranks_.bytes()},
                {covers_.data(), flat.covers.data(), covers_.bytes()},
                {corners_.data(), flat.corners.data(), corners_.bytes()}},
               stream);
}

}  // namespace vdwmesh::distance
