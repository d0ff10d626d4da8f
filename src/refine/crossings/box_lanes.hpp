// Boxes side by side, for tests of one box against eight at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/lanes/lane_masks.hpp"
#include "core/lanes/lanes.hpp"
#include "refine/crossings/patch_grid.hpp"

namespace vdwmesh {

class BoxLanes {
 public:
  static constexpr std::size_t kLanes = 8;

  // Makes room for so many boxes; those that were set are lost.
  void resize(std::size_t count) {
    if (count <= room_) return;
    room_ = (count + kLanes - 1) / kLanes * kLanes;
    for (auto* ends : {&lower_, &upper_}) {
      for (std::vector<float>& axis : *ends) axis.assign(room_, 0);
    }
  }

  void set(std::size_t i, const PatchBox& box) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower_[axis][i] = box.lower[axis];
      upper_[axis][i] = box.upper[axis];
    }
  }

  // Bit k tells whether boxes i and first + k have a point in common. `first` is a multiple of
  // kLanes.
  std::uint32_t overlapping(std::size_t i, std::size_t first) const;

 private:
  using Floats = float __attribute__((vector_size(kLanes * sizeof(float))));

  static VDWMESH_INLINE Floats floats_at(const float* first) {
    Floats lanes;
    std::memcpy(&lanes, first, sizeof lanes);
    return lanes;
  }

  std::array<std::vector<float>, 3> lower_, upper_;  // by axis
  std::size_t room_ = 0;
};

VDWMESH_INLINE std::uint32_t BoxLanes::overlapping(std::size_t i, std::size_t first) const {
  EightMasks all = EightMasks{} - 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    all &= floats_at(&lower_[axis][first]) <= Floats{} + upper_[axis][i];
    all &= floats_at(&upper_[axis][first]) >= Floats{} + lower_[axis][i];
  }
  return bits_of_eight(all);
}

}  // namespace vdwmesh
