// reference_measures(): triangulation, dual complex, inclusion-exclusion, and back to the order and
// the units of the SphereSet. The triangulation's lengths are divided by 2^scale_exponent; the
// power of two makes the way back exact, short of overflow and underflow.
#include "arrangement/reference_measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

void set_reference_measures(std::span<const SphereId> wanted, std::vector<NumberedBall> near,
                            std::span<SphereMeasures> per_sphere) {
  std::ranges::sort(near, {}, &NumberedBall::id);
  const auto repeated = std::ranges::unique(near, {}, &NumberedBall::id);
  near.erase(repeated.begin(), repeated.end());
  std::vector<Sphere> balls;
  balls.reserve(near.size());
  for (const NumberedBall& n : near) balls.push_back(n.ball);
  const std::vector<SphereMeasures> measures = reference_measures(SphereSet(std::move(balls)));
  for (const SphereId id : wanted) {
    const auto place = std::ranges::lower_bound(near, id, {}, &NumberedBall::id) - near.begin();
    per_sphere[id] = measures[static_cast<std::size_t>(place)];
  }
}

}  // namespace vdwmesh
