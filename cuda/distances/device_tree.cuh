// Box trees in device memory, built there by the formulas of the host
// (analysis/distances/box_tree_build.hpp) over the triangles of a mesh or over balls.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/distances/box_tree_view.hpp"
#include "analysis/distances/triangle_points.hpp"
#include "cuda/memory/device_memory.cuh"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::distance {

// A mesh in device memory, as kernels read it.
struct SoupView {
  const Vec3d* positions;
  const std::uint32_t* vertices;  // 3 per triangle
  std::uint32_t triangle_count;
  std::uint64_t vertex_count;

  __device__ Corners operator()(std::uint32_t t) const {
    const std::uint32_t* const v = vertices + 3 * std::uint64_t{t};
    return {positions[v[0]], positions[v[1]], positions[v[2]]};
  }
};

// Positions and triangles of a mesh, copied to the device.
class DeviceSoup {
 public:
  DeviceSoup(const IndexedMesh& mesh, const Stream& stream);
  SoupView view() const;

 private:
  DeviceArray<Vec3d> positions_;
  DeviceArray<std::uint32_t> vertices_;
};

class DeviceBoxTree {
 public:
  // Precondition: the world contains the triangles, or the balls, and all later queries.
  DeviceBoxTree(const SoupView& mesh, const Box& world, const Stream& stream);
  DeviceBoxTree(const Sphere* balls, std::uint32_t count, const Box& world, const Stream& stream);

  // Valid as long as the tree.
  const BoxTreeView& view() const { return view_; }

 private:
  template <class BoxOf>
  void build(std::uint32_t count, const BoxOf& box_of, const Stream& stream);
  template <class BoxOf>
  void sort(std::uint32_t count, const BoxOf& box_of, const Stream& stream);

  DeviceArray<std::uint32_t> order_;
  std::vector<DeviceArray<BoxNode>> levels_;
  BoxTreeView view_;
};

}  // namespace vdwmesh::distance
