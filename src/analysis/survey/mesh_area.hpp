// MeshArea maps the interval [0, A], with A the area of a mesh in Å², onto the mesh, so that equal
// lengths of the interval become equal areas of the mesh. Samples that are spread evenly over the
// interval are then spread evenly over the mesh. A position is a number of this interval.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/distances/triangle_points.hpp"
#include "core/host_device.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

inline Corners corners_of(const IndexedMesh& mesh, std::size_t triangle) {
  const auto& [i, j, k] = mesh.triangles[triangle];
  return {mesh.positions[i], mesh.positions[j], mesh.positions[k]};
}

// The subinterval of a triangle begins where the one before it ends, and is as long as the area of
// the triangle. It is computed block by block: sums over whole blocks say where the blocks begin,
// and areas are added up within a block alone.
inline constexpr std::size_t kTrianglesPerAreaBlock = 2048;

// Returns where each block begins, given the area of each (Å², added in the order of the
// triangles), and then the area of all. Throws InvalidInput if that is not above 0.
std::vector<double> area_block_starts(std::span<const double> sums);

// Returns where the subinterval ends that begins at `begin` and belongs to a triangle of this area,
// Å². `limit` is where the next block begins. The ends within a block have other roundings than the
// beginnings of blocks, so the limit is needed for ends that never fall. Since they never fall, the
// triangle of a position is well defined: the first one that ends beyond it.
VDWMESH_HD inline double end_of_area(double begin, double area, double limit) {
  const double end = begin + area;
  return end < limit ? end : limit;
}

// Returns the point at the position `place` of the interval, given its triangle and where the
// subinterval of that begins, Å².
VDWMESH_HD inline Vec3d point_at_area(const Corners& triangle, double begin, double place) {
  const double area = area_of(triangle);
  const double fraction = area > 0 ? (place - begin) / area : 0.0;
  return point_of_triangle(triangle, fraction < 0 ? 0.0 : (fraction > 1 ? 1.0 : fraction));
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
    double begin_ = 0, end_ = 0;  // the subinterval of the current triangle, Å²
    std::array<double, kTrianglesPerAreaBlock> areas_;  // of its block, Å²
  };

 private:
  const IndexedMesh& mesh_;
  std::vector<double> starts_;  // where each block of triangles begins, then total(), Å²
};

}  // namespace vdwmesh
