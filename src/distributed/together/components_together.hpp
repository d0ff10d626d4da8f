// The components of a union of balls, counted by all ranks together: each joins the balls near its
// share, and the balls between shares say which of their sets are one.
#pragma once

#include <cstdint>
#include <functional>

#include "distributed/ranks.hpp"
#include "distributed/shares/sphere_shares.hpp"

namespace vdwmesh {

// The number of components, if each rank knows which spheres near its share are connected:
// set_of(i), which is less than their number, is the same for spheres i of share.near that are.
// The shares are those of share_of_spheres(). Collective; the result is that of the first rank.
std::uint64_t join_components(const Ranks& ranks, const SphereShare& share,
                              const std::function<std::uint32_t(SphereId)>& set_of);

// What count_components() says of the spheres, of which every rank has all. Precondition: the set
// is not empty. Collective; the result is that of the first rank.
std::uint64_t components_together(const Ranks& ranks, const SphereSet& spheres);

}  // namespace vdwmesh
