// The intersecting pairs of a mesh by CGAL's exact predicates, of all pairs of triangles.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <vector>

#include "analysis/crossings/facet_tree.hpp"
#include "analysis/mesh_measures.hpp"

namespace vdwmesh::testing {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// The predicates with which CGAL's function self_intersections() decides, for all pairs.
class CgalPairs {
 public:
  explicit CgalPairs(const IndexedMesh& mesh) : mesh_(mesh) {}

  TrianglePairs all() const {
    TrianglePairs pairs;
    for (std::uint32_t i = 0; i < mesh_.triangle_count(); ++i) {
      if (is_flat(mesh_.triangles[i])) continue;
      const Box box = box_of(mesh_, i);
      for (std::uint32_t j = i + 1; j < mesh_.triangle_count(); ++j) {
        if (overlap(box, box_of(mesh_, j)) && !is_flat(mesh_.triangles[j]) &&
            intersect(mesh_.triangles[i], mesh_.triangles[j])) {
          pairs.push_back({i, j});
        }
      }
    }
    return pairs;
  }

 private:
  using Points = std::vector<CgalKernel::Point_3>;

  static bool overlap(const Box& a, const Box& b) {
    for (int axis = 0; axis < 3; ++axis)
      if (a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis]) return false;
    return true;
  }
  CgalKernel::Point_3 point(std::uint32_t v) const {
    const Vec3d& p = mesh_.positions[v];
    return {p.x, p.y, p.z};
  }
  CgalKernel::Triangle_3 triangle(const Triangle& t) const {
    return {point(t[0]), point(t[1]), point(t[2])};
  }
  bool is_flat(const Triangle& t) const { return triangle(t).is_degenerate(); }
  // The points of t whose vertices are, or are not, vertices of `other`.
  Points points(const Triangle& t, const Triangle& other, bool shared) const {
    Points found;
    for (const std::uint32_t v : t)
      if ((std::ranges::count(other, v) > 0) == shared) found.push_back(point(v));
    return found;
  }
  bool intersect(const Triangle& a, const Triangle& b) const {
    const Points shared = points(a, b, true), p = points(a, b, false), q = points(b, a, false);
    switch (shared.size()) {
      case 0:
        return CGAL::do_intersect(triangle(a), triangle(b));
      case 1:
        return CGAL::do_intersect(triangle(a), CgalKernel::Segment_3(q[0], q[1])) ||
               CGAL::do_intersect(triangle(b), CgalKernel::Segment_3(p[0], p[1]));
      case 2:
        return CGAL::coplanar(shared[0], shared[1], p[0], q[0]) &&
               CGAL::coplanar_orientation(shared[0], shared[1], p[0], q[0]) == CGAL::POSITIVE;
      default:
        return true;
    }
  }

  const IndexedMesh& mesh_;
};

}  // namespace vdwmesh::testing
