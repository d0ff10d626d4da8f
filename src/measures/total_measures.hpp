// Area and volume of a union as sums over its balls. For the library's own use.
#pragma once

#include <span>

#include "measures/exact_union.hpp"
#include "measures/measured_spheres.hpp"

namespace vdwmesh {

// Sums over the measured entries, rounded once (exact_sum.hpp). They depend neither on the order of
// the entries nor on the number of threads, and who adds up parts of a union by ExactSum gets the
// same.
SphereMeasures total_measures(std::span<const SphereMeasures> per_sphere,
                              const MeasuredSpheres& measured);
SphereMeasures total_measures(std::span<const SphereMeasures> per_sphere);  // of all

}  // namespace vdwmesh
