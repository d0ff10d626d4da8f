// Whether two facets intersect, decided by the predicates of a kernel of CGAL, which are exact for
// all doubles. How many vertices the facets share decides which test is made.
#include "analysis/crossings/facet_pair_exact.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

namespace vdwmesh {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Points = std::array<Point, 3>;

// The corners in the order of a Matching, so that the vertices that the two facets share come
// first.
Points points_of(const Facet& f, const std::array<std::uint8_t, 3>& order) {
  const auto point = [&](std::size_t k) {
    const Vec3d& p = f.corner[order[k]];
    return Point(p.x, p.y, p.z);
  };
  return {point(0), point(1), point(2)};
}

Kernel::Triangle_3 triangle(const Points& p) { return {p[0], p[1], p[2]}; }

// Whether two triangles that share their first vertex intersect elsewhere. If they do, the edge
// opposite to that vertex in one of them meets the other triangle.
bool meet_beyond_vertex(const Points& a, const Points& b) {
  return CGAL::do_intersect(triangle(a), Kernel::Segment_3(b[1], b[2])) ||
         CGAL::do_intersect(triangle(b), Kernel::Segment_3(a[1], a[2]));
}

// Whether two triangles that share their first two vertices overlap: whether they lie in one plane
// and their third vertices are on the same side of the common edge.
bool fold_over(const Points& a, const Points& b) {
  return CGAL::coplanar(a[0], a[1], a[2], b[2]) &&
         CGAL::coplanar_orientation(a[0], a[1], a[2], b[2]) == CGAL::POSITIVE;
}

}  // namespace

bool is_flat_exactly(const Facet& f) {
  const Points p = points_of(f, {0, 1, 2});
  return CGAL::collinear(p[0], p[1], p[2]);
}

bool intersect_exactly(const Facet& a, const Facet& b, const Matching& m) {
  const Points p = points_of(a, m.a), q = points_of(b, m.b);
  switch (m.shared) {
    case 0:
      return CGAL::do_intersect(triangle(p), triangle(q));
    case 1:
      return meet_beyond_vertex(p, q);
    case 2:
      return fold_over(p, q);
    default:
      return true;
  }
}

}  // namespace vdwmesh
