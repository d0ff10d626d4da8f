// The exact tests are those of CGAL's kernel with exact predicates. Coordinates are taken as the
// rational numbers that the doubles are, so the answers do not depend on rounding.
#include "creases/plane/plane_predicates.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace vdwmesh {
namespace {

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;

Point exact_point(const PlanePoint& p) { return {p.x, p.y}; }

}  // namespace

int exact_orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return CGAL::orientation(exact_point(a), exact_point(b), exact_point(c));
}

int exact_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c,
                    const PlanePoint& d) {
  return CGAL::side_of_oriented_circle(exact_point(a), exact_point(b), exact_point(c),
                                       exact_point(d));
}

}  // namespace vdwmesh
