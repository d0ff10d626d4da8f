// Exact signs about balls and their powers: pow_b(x) = |x - c_b|² - r_b².
//
// Radii enter as they are and are squared inside, exactly. So the tangency of balls given in
// doubles is decided for these doubles, not for rounded squares. Each predicate is a polynomial. It
// is evaluated in double with a certified error bound, and again in exact arithmetic if the bound
// does not settle the sign. The sign is right for finite input of any magnitude. The evaluation is
// fast if radii are near 1, because double then neither over- nor underflows.
#pragma once

#include <array>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

enum class Sign : signed char { negative = -1, zero = 0, positive = 1 };

// Positive if the centre of d is on the side of the plane abc from which the centres of a, b, c are
// counter-clockwise, zero if it is on the plane.
Sign orientation_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d);

// Conflict test of the regular triangulation, for positively oriented p, q, r, s. Positive if ball
// t and the sphere orthogonal to these four have a negative power product: the squared distance of
// their centres is less than the sum of their squared radii.
Sign power_side(const Sphere& p, const Sphere& q, const Sphere& r, const Sphere& s,
                const Sphere& t);

// power_side() of a cell's four balls and another one, never zero: at a tie, as if |x|² - r² had
// been raised for each ball by a little, and by infinitely more for a ball whose centre comes later
// in the order of x, then y, then z. So the answers of all cells fit together, in every subset of
// the balls (O. Devillers and M. Teillaud 2011, "Perturbations for Delaunay and weighted Delaunay
// 3D triangulations"; CGAL decides in the same way).
Sign conflict_side(const std::array<const Sphere*, 4>& cell, const Sphere& ball);

// The size of the simplex of these balls: the sign of the squared radius of the smallest sphere
// orthogonal to all of them. It is <= 0 exactly if the closed balls have a point in common on their
// dual face, the set of points with equal power to all. Precondition: the centres are affinely
// independent.
Sign size_sign(const Sphere& a, const Sphere& b);
Sign size_sign(const Sphere& a, const Sphere& b, const Sphere& c);
Sign size_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d);

// The sign of pow_d - pow_a at the centre of the smallest sphere orthogonal to the balls of a
// simplex: all arguments but the last, d. Negative means that d makes the simplex attached. The
// simplex is then in the dual complex only as a face of a larger simplex, whatever its size.
Sign side_sign(const Sphere& a, const Sphere& d);
Sign side_sign(const Sphere& a, const Sphere& b, const Sphere& d);
Sign side_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d);

// Whether the radical plane lies strictly between the centres. If the size of edge ab is 0, this
// distinguishes balls that touch from outside from a ball that touches the other from inside.
bool plane_between_centers(const Sphere& a, const Sphere& b);

}  // namespace vdwmesh
