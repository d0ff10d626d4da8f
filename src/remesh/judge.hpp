// Judge: whether an operation may change the mesh. For the library's own use.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "remesh/crossing_guard.hpp"
#include "remesh/feature_graph.hpp"
#include "remesh/foot_oracle.hpp"

namespace vdwmesh::remesh {

// What is known of the vertices, each array by vertex.
struct VertexTable {
  std::vector<Vec3d> position;      // Å
  std::vector<Vec3d> normal;        // outward, unit; about the mean at a crease or corner
  std::vector<double> edge_length;  // Å: the wanted length of its edges
  std::vector<VertexHold> hold;
  std::vector<std::uint32_t> patch;  // its patch, or any of its patches
};

// The squared sine of the smallest angle of a triangle: the squared double area, divided by the
// squares of the two longer sides.
double shape_of(const Vec3d& a, const Vec3d& b, const Vec3d& c);
inline double shape_of(const NewTriangle& t) {
  return shape_of(t.corner[0], t.corner[1], t.corner[2]);
}

// An operation as the judge sees it.
struct MeshChange {
  std::vector<std::uint32_t> removed;  // triangles
  std::vector<NewTriangle> made;       // in their place
};

class Judge {
 public:
  // All must outlive this. `farthest`: how far from the surface triangles may be, Å.
  Judge(const FootOracle& oracle, const VertexTable& vertices, const CrossingGuard& guard,
        double farthest)
      : oracle_(oracle), vertices_(vertices), guard_(guard), farthest_(farthest) {}

  // Whether no new triangle has a shape below `least_shape`, is turned away from the surface, is
  // far from it in its middle, or crosses another one in a zone.
  bool allows(const MeshChange& change, double least_shape) const;
  // The height of the middle of a triangle above the surface, Å; infinite if it has no foot.
  double height(const NewTriangle& t) const;

 private:
  bool faces_outward(const NewTriangle& t) const;
  bool is_near(const NewTriangle& t) const;

  const FootOracle& oracle_;
  const VertexTable& vertices_;
  const CrossingGuard& guard_;
  double farthest_;
};

}  // namespace vdwmesh::remesh
