// Exact signs about balls and their powers: pow_b(x) = |x - c_b|² - r_b².
//
// Radii enter as they are and are squared inside, exactly: tangency of balls given in doubles is
// decided for those doubles, not for rounded squares. Each predicate is a polynomial evaluated in
// double with a certified error bound, and again in exact arithmetic when the bound does not
// settle the sign. Finite input of any magnitude is right; it is fast where radii are near 1.
#pragma once

#include <array>

#include "spheres/sphere_set.hpp"

namespace vdwmesh {

enum class Sign : signed char { negative = -1, zero = 0, positive = 1 };

// Positive where the centre of d is on the side of a, b, c that sees them counter-clockwise.
Sign orientation_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d);

// Conflict test of the regular triangulation: positive where t lies inside the sphere orthogonal to
// the positively oriented p, q, r, s.
Sign power_side(const Sphere& p, const Sphere& q, const Sphere& r, const Sphere& s,
                const Sphere& t);

// Sign of the squared radius of the smallest sphere orthogonal to all: the size of the simplex,
// <= 0 where the closed balls meet on its dual face. Centres are affinely independent.
Sign size_sign(const Sphere& a, const Sphere& b);
Sign size_sign(const Sphere& a, const Sphere& b, const Sphere& c);
Sign size_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d);

// Sign of pow_d - pow_a at the centre of that smallest sphere: negative where d makes the simplex
// attached (its size is then that of a coface).
Sign side_sign(const Sphere& a, const Sphere& d);
Sign side_sign(const Sphere& a, const Sphere& b, const Sphere& d);
Sign side_sign(const Sphere& a, const Sphere& b, const Sphere& c, const Sphere& d);

// Whether the radical plane lies strictly between the centres; where the size of the edge is 0,
// this tells balls that touch from outside from one that touches the other from inside.
bool plane_between_centers(const Sphere& a, const Sphere& b);

}  // namespace vdwmesh
