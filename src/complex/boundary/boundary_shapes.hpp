// Angles and corners of the union's boundary: circles, exposed arcs, and the turning angles between
// them, from the balls and the dual complex.
//
// Usual angles come from positions in double. Those on small circles and of nearly closed or nearly
// empty arcs come from solid and dihedral angles (simplex_shape.hpp), which lose no digits there.
#pragma once

#include "complex/boundary/exposed_arcs.hpp"
#include "complex/simplex_shape.hpp"
#include "core/buffer.hpp"

namespace vdwmesh {

// Looks at the triangulation and the complex, which must outlive it. Lengths are scaled as there.
class BoundaryShapes {
 public:
  // Computes the shapes of all edges and triangles of the complex, on all cores.
  BoundaryShapes(const PowerTriangulation& triangulation, const DualComplex& complex);

  const EdgeShape& edge(std::uint32_t e) const { return edges_[e]; }
  // The two corners of a triangle, exposed or not, relative to its first ball: `above` is on the
  // side of cells[0].
  const CommonPoints& corners(std::size_t triangle) const { return corners_[triangle]; }

  // The vector from the centre of the circle of edge e to a point that is given relative to the
  // first ball of triangle f, which has the edge.
  Vec3d from_circle(std::uint32_t e, const DualTriangle& f, const Vec3d& point) const {
    const auto& [a, b] = k_.edges[e].vertices;
    return between(a, f.vertices[0]) + point -
           (edges_[e].height[0] / edges_[e].length) * between(a, b);
  }
  // The same for a corner.
  Vec3d corner_from_circle(std::uint32_t e, CornerIndex corner) const;

  // The angle of an arc, from 0 to 2 π. A whole circle has 2 π.
  double angle(const ExposedArc& arc) const;

  // The turning angle of the patch on the ball of vertex k at the corners of a triangle, in (0, π)
  // up to rounding. Both corners have the same by symmetry.
  double turning_angle(std::size_t triangle, std::size_t k) const;

 private:
  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }
  Vec3d between(std::uint32_t i, std::uint32_t j) const { return ball(j).center - ball(i).center; }
  bool is_small(std::uint32_t e, double radius) const;
  double reach(std::uint32_t e, std::uint32_t v) const;
  double angle_by_excess(const DualTriangle& f, std::size_t k) const;

  const PowerTriangulation& t_;
  const DualComplex& k_;
  Buffer<EdgeShape> edges_;       // per edge of the complex
  Buffer<CommonPoints> corners_;  // per triangle of the complex
};

}  // namespace vdwmesh
