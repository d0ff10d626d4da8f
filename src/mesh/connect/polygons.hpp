// Triangulates the polygons of a mesh file. Readers add the faces one by one; add() makes fans of
// triangles at once, and finish() corrects the fans of concave polygons.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/mesh_io.hpp"

namespace vdwmesh::formats {

class Polygons {
 public:
  // Appends a polygon, whose corners are vertex indices, to mesh.triangles as a fan around its
  // first corner: n corners give n - 2 triangles. A face of fewer than three corners is counted and
  // left out.
  void add(IndexedMesh& mesh, const std::vector<std::uint32_t>& corners);

  // Call it when all positions are known and all indices are checked. If a fan folds over, which
  // happens for concave polygons, its triangles are replaced by those of ear clipping (Meisters
  // 1975) in the plane normal to the polygon's area vector. There are n - 2 of them as well, so no
  // other triangle moves. Adds notes to `file` that say what was done.
  void finish(MeshFile& file);

 private:
  struct Fan {
    std::size_t first;      // index of its first triangle
    std::uint32_t corners;  // number of corners of the polygon
  };
  std::vector<Fan> fans_;      // of polygons with more than three corners
  std::uint64_t too_few_ = 0;  // faces with fewer than three corners
};

}  // namespace vdwmesh::formats
