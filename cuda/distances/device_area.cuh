// The area of a mesh as an interval (analysis/survey/mesh_area.hpp), in device memory.
#pragma once

#include <vector>

#include "analysis/survey/mesh_area.hpp"
#include "cuda/distances/device_tree.cuh"
#include "cuda/memory/device_memory.cuh"

namespace vdwmesh::distance {

// The area as kernels read it. The area of the mesh is an interval (Å²) in which triangle follows
// on triangle; the arrays have the ends of their subintervals, which rise.
struct AreaView {
  const double* starts;  // of the blocks of triangles, and the area of all
  const double* ends;    // of the triangles
  std::uint32_t triangles;
  std::uint32_t blocks;

  // Returns the point at the position `place`. Its triangle is the one that MeshArea::Cursor finds:
  // the first that ends beyond it, in or after the last block that begins at or before it.
  __device__ Vec3d point_at(const SoupView& mesh, double place) const {
    const std::uint32_t block = first_above(starts + 1, blocks - 1, place);
    const std::uint32_t first = block * static_cast<std::uint32_t>(kTrianglesPerAreaBlock);
    const std::uint32_t found = first + first_above(ends + first, triangles - first, place);
    const std::uint32_t t = found < triangles ? found : triangles - 1;
    const bool begins_block = t % kTrianglesPerAreaBlock == 0;
    return point_at_area(mesh(t), begins_block ? starts[t / kTrianglesPerAreaBlock] : ends[t - 1],
                         place);
  }

 private:
  // The index of the first of `count` rising numbers that is above `place`, or `count`.
  __device__ static std::uint32_t first_above(const double* numbers, std::uint32_t count,
                                              double place) {
    std::uint32_t low = 0;
    while (count > 0) {
      const std::uint32_t half = count / 2;
      const bool above = numbers[low + half] > place;
      low = above ? low : low + half + 1;
      count = above ? half : count - half - 1;
    }
    return low;
  }
};

class DeviceArea {
 public:
  // Throws InvalidInput for a mesh without area. Waits for the device.
  DeviceArea(const SoupView& mesh, const Stream& stream);
  double total() const { return total_; }  // Å²
  AreaView view() const;

 private:
  DeviceArray<double> starts_, ends_;
  double total_ = 0;
};

}  // namespace vdwmesh::distance
