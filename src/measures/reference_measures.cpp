// reference_measures(): triangulation, dual complex, inclusion-exclusion, and back to the order and
// the units of the SphereSet. The triangulation's lengths are divided by 2^scale_exponent; the
// power of two makes the way back exact, short of overflow and underflow.
#include "measures/reference_measures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "complex/dual_complex.hpp"
#include "measures/arcs/doubts.hpp"
#include "measures/measures.hpp"

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

std::vector<NumberedBall> balls_near(const CellListView& list, const SphereSet& spheres,
                                     std::span<const SphereId> wanted) {
  std::vector<NumberedBall> near;
  std::vector<std::uint8_t> is_taken(list.size, 0);  // by list place
  for (const SphereId id : wanted) {
    if (near.size() == list.size) break;
    const Sphere& s = spheres[id];
    const Vec3d reach{s.radius, s.radius, s.radius};
    // The other ball's radius is its reach in the list.
    visit_near_box(list, s.center - reach, s.center + reach, [&](ListPlace place) {
      if (is_taken[to_index(place)]) return false;
      const Sphere& other = list.spheres[place];
      const Vec3d to = other.center - s.center;
      const double sum = (1 + arcs::kTouching) * (s.radius + other.radius);
      if (dot(to, to) <= sum * sum) {
        near.push_back({list.id[place], other});
        is_taken[to_index(place)] = 1;
      }
      return false;  // go on with the search
    });
  }
  return near;
}

// The measures of a ball depend on the balls that overlap it alone, and `near` has these of all
// wanted balls. So a triangulation of `near` gives the wanted balls the measures that they have in
// the whole set. Other balls get wrong ones, which are not read.
std::vector<SphereMeasures> reference_measures(std::span<const SphereId> wanted,
                                               std::vector<NumberedBall> near) {
  std::ranges::sort(near, {}, &NumberedBall::id);
  const auto repeated = std::ranges::unique(near, {}, &NumberedBall::id);
  near.erase(repeated.begin(), repeated.end());
  std::vector<Sphere> balls;
  balls.reserve(near.size());
  for (const NumberedBall& n : near) balls.push_back(n.ball);
  const std::vector<SphereMeasures> measures = reference_measures(SphereSet(std::move(balls)));
  std::vector<SphereMeasures> of_wanted;
  of_wanted.reserve(wanted.size());
  for (const SphereId id : wanted) {
    const auto place = std::ranges::lower_bound(near, id, {}, &NumberedBall::id) - near.begin();
    of_wanted.push_back(measures[static_cast<std::size_t>(place)]);
  }
  return of_wanted;
}

void set_reference_measures(std::span<const SphereId> wanted, std::vector<NumberedBall> near,
                            std::span<SphereMeasures> per_sphere) {
  const std::vector<SphereMeasures> measures = reference_measures(wanted, std::move(near));
  for (std::size_t i = 0; i < wanted.size(); ++i) per_sphere[wanted[i]] = measures[i];
}

}  // namespace vdwmesh
