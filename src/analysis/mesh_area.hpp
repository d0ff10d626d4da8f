// MeshArea maps the interval [0, A], with A the area of a mesh in Å², onto the mesh, so that equal
// lengths of the interval become equal areas of the mesh. Samples that are spread evenly over the
// interval are then spread evenly over the mesh. A position is a number of this interval.
#pragma once

#include <cstddef>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// References to the coordinates of a triangle's vertices, Å. The mesh must outlive them.
struct Corners {
  const Vec3d &a, &b, &c;
};

inline Corners corners_of(const IndexedMesh& mesh, std::size_t triangle) {
  const auto& [i, j, k] = mesh.triangles[triangle];
  return {mesh.positions[i], mesh.positions[j], mesh.positions[k]};
}

// Maps [0, 1) onto the triangle so that equal lengths become equal areas and a short interval
// becomes a small neighbourhood. This is the map of the triangular van der Corput sequence (K. Basu
// and A. B. Owen, "Low discrepancy constructions in the triangle", SIAM J. Numer. Anal. 53 (2015)
// 743). Each digit of `fraction` to the base 4 selects one of the four triangles into which the
// midpoints of the edges divide the current one. The result is the centre of the last triangle.
Vec3d point_of_triangle(const Corners& triangle, double fraction);

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
