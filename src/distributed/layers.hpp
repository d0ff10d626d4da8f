// The spheres of a set counted in layers across an axis, so that they can be divided into parts of
// equal numbers without being sorted. All ranks that have the set find the same parts.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Which layer a sphere is in.
class LayerScale {
 public:
  static constexpr std::size_t kLayers = 4096;

  // `box` is that of the centres of all spheres.
  LayerScale(const Box& box, int axis) : axis_(axis), lower_(box.lower[axis]) {
    const double height = box.upper[axis] - lower_;
    scale_ = height > 0 ? kLayers / height : 0;
  }

  std::size_t layer_of(const Sphere& s) const {
    const double layer = (s.center[axis_] - lower_) * scale_;
    return static_cast<std::size_t>(std::clamp(layer, 0.0, kLayers - 1.0));
  }

 private:
  int axis_;
  double lower_, scale_;
};

class Layers {
 public:
  // Precondition: the set is not empty.
  Layers(const SphereSet& spheres, int axis)
      : scale_(center_bounding_box(spheres), axis), starts_(LayerScale::kLayers + 1) {
    for (const Sphere& s : spheres.spheres()) ++starts_[layer_of(s) + 1];
    std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  }

  std::size_t layer_of(const Sphere& s) const { return scale_.layer_of(s); }

  // The first layer before which at least `spheres` spheres lie.
  std::size_t end_of(std::uint64_t spheres) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(starts_, spheres) - starts_.begin());
  }

 private:
  LayerScale scale_;
  // [layer]: the number of spheres in the layers before it; the last element counts all.
  std::vector<std::uint64_t> starts_;
};

}  // namespace vdwmesh
