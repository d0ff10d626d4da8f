// The patches of an exposed surface in device memory.
#pragma once

#include <cstdint>

#include "analysis/exposed_surface.hpp"
#include "cuda/distances/device_tree.cuh"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh::distance {

class DevicePatches {
 public:
  DevicePatches(const ExposedSurface& surface, const Stream& stream);

  std::uint32_t size() const { return static_cast<std::uint32_t>(patches_.size()); }
  const Patch* patches() const { return patches_.data(); }
  const Sphere* balls() const { return balls_.data(); }  // of the patches
  // [patch]: the rank of its sphere in canonical order, which numbers its random stream.
  const std::uint32_t* ranks() const { return ranks_.data(); }

 private:
  DeviceArray<Patch> patches_;
  DeviceArray<Sphere> balls_;
  DeviceArray<std::uint32_t> ranks_;
  DeviceArray<Cover> covers_;
  DeviceArray<Corner> corners_;
};

}  // namespace vdwmesh::distance
