// Layers across an axis, in which the spheres of a set are counted, so that they can be divided
// into parts of equal numbers without being sorted.
#pragma once

#include <algorithm>
#include <cstddef>

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

}  // namespace vdwmesh
