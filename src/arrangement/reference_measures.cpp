// reference_measures(): triangulation, dual complex, inclusion-exclusion, and back to the order and
// the units of the SphereSet. The triangulation's lengths are divided by 2^scale_exponent; the
// power of two makes the way back exact, short of overflow and underflow.
#include "arrangement/reference_measures.hpp"

#include <cmath>

#include "arrangement/complex/dual_complex.hpp"
#include "arrangement/complex/measures.hpp"

namespace vdwmesh {

std::vector<SphereMeasures> in_order_of(const SphereSet& spheres, const PowerTriangulation& t,
                                        const std::vector<SphereMeasures>& measures) {
  std::vector<SphereMeasures> out(spheres.size(), SphereMeasures{0, 0});
  for (std::size_t i = 0; i < measures.size(); ++i) {
    out[t.ids[i]] = {std::ldexp(measures[i].area, 2 * t.scale_exponent),
                     std::ldexp(measures[i].volume, 3 * t.scale_exponent)};
  }
  return out;
}

std::vector<SphereMeasures> reference_measures(const SphereSet& spheres) {
  const PowerTriangulation triangulation = triangulate(spheres);
  return in_order_of(spheres, triangulation,
                     inclusion_exclusion(triangulation, dual_complex(triangulation)));
}

}  // namespace vdwmesh
