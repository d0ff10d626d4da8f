// Which spheres of a set are measured: all of them, or those that a caller lists. Spheres that are
// not measured still cover the others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class MeasuredSpheres {
 public:
  // Without a list, all `spheres` spheres are measured. Throws InvalidInput for an id that is no
  // sphere; a repeated id counts once.
  MeasuredSpheres(std::size_t spheres, const std::optional<std::span<const SphereId>>& ids) {
    if (!ids) return;
    is_measured_.emplace(spheres, std::uint8_t{0});
    for (const SphereId id : *ids) {
      if (id >= spheres) {
        throw InvalidInput("sphere " + std::to_string(id) + " is to be measured, but there are " +
                           std::to_string(spheres) + " spheres");
      }
      (*is_measured_)[id] = 1;
    }
  }

  bool all() const { return !is_measured_; }
  bool contains(SphereId id) const { return !is_measured_ || (*is_measured_)[id] != 0; }

 private:
  std::optional<std::vector<std::uint8_t>> is_measured_;  // by sphere id; empty: all are
};

}  // namespace vdwmesh
