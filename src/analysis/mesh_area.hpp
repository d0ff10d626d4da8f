// Points of a mesh by the area that comes before them.
#pragma once

#include <cstddef>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct Corners {
  const Vec3d &a, &b, &c;
};

inline Corners corners_of(const IndexedMesh& mesh, std::size_t triangle) {
  const auto& [i, j, k] = mesh.triangles[triangle];
  return {mesh.positions[i], mesh.positions[j], mesh.positions[k]};
}

// Maps [0, 1) onto the triangle so that equal lengths become equal areas, and a short interval a
// small neighbourhood: the triangular van der Corput sequence of Basu and Owen, "Low discrepancy
// constructions in the triangle" (2015). Each digit of `fraction` to the base 4 chooses one of the
// four triangles that the midpoints of the edges make; the result is the centre of the last one.
Vec3d point_of_triangle(const Corners& triangle, double fraction);

// The mesh's area as an interval, in which each triangle takes a stretch as long as its area, Å²,
// in the order of the triangles. Keeps one number for 2048 triangles.
class MeshArea {
 public:
  // The mesh must outlive this. Throws InvalidInput for a mesh without area.
  explicit MeshArea(const IndexedMesh& mesh);

  double total() const { return starts_.back(); }  // Å²

  // Goes through the interval from any place upwards.
  class Cursor {
   public:
    // Points may be asked for from `place` on, in [0, total()].
    Cursor(const MeshArea& area, double place);

    // The point of the mesh at `place`, Å², which is not below the last one asked for. It does not
    // depend on where the cursor began.
    Vec3d point_at(double place);

   private:
    void enter(std::size_t triangle);

    const MeshArea& area_;
    std::size_t triangle_;
    double begin_ = 0, length_ = 0;  // the triangle's stretch
  };

 private:
  const IndexedMesh& mesh_;
  std::vector<double> starts_;  // of each block of triangles, and the end
};

}  // namespace vdwmesh
