// Which patches of a cell share a vertex around which all patches are a star, eight at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "refine/crossings/box_lanes.hpp"
#include "refine/crossings/patch_fans.hpp"

namespace vdwmesh {

class SharedStars {
 public:
  // Makes room for so many patches; those that were set are lost.
  void resize(std::size_t count) {
    if (count <= star_[0].size()) return;
    const std::size_t room = (count + BoxLanes::kLanes - 1) / BoxLanes::kLanes * BoxLanes::kLanes;
    for (auto& stars : star_) stars.assign(room, StarFans::kNone);
  }

  void set(std::size_t i, const PatchFans& fans, const Triangle& corner) {
    for (std::size_t k = 0; k < 3; ++k) {
      star_[k][i] = !fans.empty() && fans.is_star(corner[k]) ? corner[k] : StarFans::kNone;
    }
  }

  // Whether one of the corners of patch i has a star around it.
  bool has_star(std::size_t i) const {
    return star_[0][i] != StarFans::kNone || star_[1][i] != StarFans::kNone ||
           star_[2][i] != StarFans::kNone;
  }
  // Bit k tells whether patches i and first + k share a corner with a star. `first` is a multiple
  // of BoxLanes::kLanes.
  std::uint32_t shared(std::size_t i, std::size_t first) const;

 private:
  std::array<std::vector<std::uint32_t>, 3> star_;  // the corner, or kNone
};

VDWMESH_INLINE std::uint32_t SharedStars::shared(std::size_t i, std::size_t first) const {
  using Ids = std::uint32_t __attribute__((vector_size(BoxLanes::kLanes * sizeof(std::uint32_t))));
  EightMasks found{};
  for (std::size_t k = 0; k < 3; ++k) {
    Ids own;
    std::memcpy(&own, &star_[k][first], sizeof own);
    EightMasks equal{};
    for (const auto& stars : star_) equal |= own == Ids{} + stars[i];
    found |= equal & (own != Ids{} + StarFans::kNone);
  }
  return bits_of_eight(found);
}

}  // namespace vdwmesh
