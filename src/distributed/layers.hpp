// The spheres of a set counted in layers across an axis, so that they can be divided into parts of
// equal numbers without being sorted. All ranks that have the set find the same parts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class Layers {
 public:
  // Precondition: the set is not empty.
  Layers(const SphereSet& spheres, int axis) : axis_(axis), starts_(kLayers + 1) {
    const Box box = center_bounding_box(spheres);
    lower_ = box.lower[axis];
    const double height = box.upper[axis] - lower_;
    scale_ = height > 0 ? kLayers / height : 0;
    for (const Sphere& s : spheres.spheres()) ++starts_[layer_of(s) + 1];
    for (std::size_t layer = 0; layer < kLayers; ++layer) starts_[layer + 1] += starts_[layer];
  }

  std::size_t layer_of(const Sphere& s) const {
    const double layer = (s.center[axis_] - lower_) * scale_;
    return static_cast<std::size_t>(std::clamp(layer, 0.0, kLayers - 1.0));
  }

  // [layer]: the number of spheres in the layers before it; the last element counts all.
  const std::vector<std::uint64_t>& starts() const { return starts_; }

  // The first layer before which at least `spheres` spheres lie.
  std::size_t end_of(std::uint64_t spheres) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(starts_, spheres) - starts_.begin());
  }

 private:
  static constexpr std::size_t kLayers = 4096;
  int axis_;
  double lower_ = 0, scale_ = 0;
  std::vector<std::uint64_t> starts_;
};

}  // namespace vdwmesh
