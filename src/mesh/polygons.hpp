// Polygons of a mesh file become triangles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/mesh_io.hpp"

namespace vdwmesh::formats {

class Polygons {
 public:
  // Adds the polygon as a fan of triangles around its first corner: n - 2 of n corners.
  void add(IndexedMesh& mesh, const std::vector<std::uint32_t>& corners);

  // To be called once all positions are there and all indices are checked. Where a fan would fold
  // over, because the polygon is concave, its triangles are replaced by as many that ear clipping
  // finds (Meisters 1975), in the plane of the polygon's area vector. Notes what was done.
  void finish(MeshFile& file);

 private:
  struct Fan {
    std::size_t first;  // triangle
    std::uint32_t corners;
  };
  std::vector<Fan> fans_;  // of more than three corners
  std::uint64_t too_few_ = 0;
};

}  // namespace vdwmesh::formats
