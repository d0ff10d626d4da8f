// Area and volume of a union of balls as intervals that are proven to contain them.
//
// The dual complex is exact, so its sums (simplex_terms.hpp) are true equations. Each simplex is
// evaluated in intervals of doubles. If the interval of a simplex is too wide, the simplex is
// evaluated again in intervals of 128 bits, then of 256, and so on. The ends of all intervals are
// added without rounding (exact_sum.hpp), so the result depends neither on the number of threads
// nor on the order of the simplices. docs/certificates.md states the theorem and what it assumes.
#pragma once

#include "complex/dual_complex.hpp"
#include "measures/certificate/upward_rounding.hpp"
#include "measures/exact_union.hpp"
#include "measures/measured_spheres.hpp"

namespace vdwmesh {

// Encloses the sums over the measured spheres. Both other arguments must be those of the spheres.
// Throws InvalidInput if the radii and coordinates differ by so many powers of ten that scaling
// them, as the triangulation did, was not exact; InternalError if the processor does not round
// upward; and Cancelled. With RoundingMode::to_nearest, which is for tests, the result is wrong.
UnionCertificate certify(const SphereSet& spheres, const PowerTriangulation& triangulation,
                         const DualComplex& complex, const MeasuredSpheres& measured,
                         Monitor* monitor = nullptr,
                         certificate::RoundingMode mode = certificate::RoundingMode::upward);

}  // namespace vdwmesh
