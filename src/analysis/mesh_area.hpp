// MeshArea maps the interval [0, A], with A the area of a mesh in Å², onto the mesh, so that equal
// lengths of the interval become equal areas of the mesh. Samples that are spread evenly over the
// interval are then spread evenly over the mesh. A position is a number of this interval.
#pragma once

#include <cstddef>
#include <vector>

#include "analysis/triangle_points.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

inline Corners corners_of(const IndexedMesh& mesh, std::size_t triangle) {
  const auto& [i, j, k] = mesh.triangles[triangle];
  return {mesh.positions[i], mesh.positions[j], mesh.positions[k]};
}

// The area of a mesh as the interval [0, total()], in Å². The triangles have consecutive
// subintervals, in their order, each as long as the area of its triangle. Memory is one number for
// every 2048 triangles.
class MeshArea {
 public:
  // The mesh must outlive this. Throws InvalidInput for a mesh without area.
  explicit MeshArea(const IndexedMesh& mesh);

  double total() const { return starts_.back(); }  // Å²

  // Visits positions of the interval in increasing order.
  class Cursor {
   public:
    // Starts at the position `place` in [0, total()].
    Cursor(const MeshArea& area, double place);

    // Returns the point of the mesh at the position `place`, Å². It does not depend on where the
    // cursor started. Precondition: `place` is not below the position of the previous call.
    Vec3d point_at(double place);

   private:
    void enter(std::size_t triangle);

    const MeshArea& area_;
    std::size_t triangle_;
    double begin_ = 0, length_ = 0;  // the subinterval of the current triangle, Å²
  };

 private:
  const IndexedMesh& mesh_;
  std::vector<double> starts_;  // where each block of triangles begins, then total(), Å²
};

}  // namespace vdwmesh
