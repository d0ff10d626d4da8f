// Area and volume of a union as sums over its balls. For the library's own use.
#pragma once

#include <span>

#include "arrangement/exact_union.hpp"
#include "arrangement/measured_spheres.hpp"

namespace vdwmesh {

// Sums over the measured entries, in wide accumulators. The order in which they are added depends
// on the number of entries alone, so the result is the same for any number of threads.
SphereMeasures total_measures(std::span<const SphereMeasures> per_sphere,
                              const MeasuredSpheres& measured);
SphereMeasures total_measures(std::span<const SphereMeasures> per_sphere);  // of all

}  // namespace vdwmesh
