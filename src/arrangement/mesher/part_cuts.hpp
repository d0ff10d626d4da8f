// Where a set of spheres is cut into parts for several processes: between keys of the curve through
// it (spheres/spatial_frame.hpp), so that the parts are about equal in work.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "arrangement/exact_mesher.hpp"
#include "spheres/spatial_frame.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class PartCuts {
 public:
  // Processes that have the same set and edge lengths make the same cuts. The work is estimated: so
  // much for each sphere, and so much for each triangle of its exposed area. Precondition: the set
  // is not empty.
  PartCuts(const SphereSet& spheres, const SpatialFrame& frame, const ExactMeshOptions& options,
           std::size_t parts);

  // The number of the part to which a sphere belongs; it rises with the key.
  std::uint32_t owner_of(const Sphere& s) const;

 private:
  SpatialFrame frame_;
  std::vector<std::uint64_t> begins_;  // the first key of each part but the first, ascending
};

}  // namespace vdwmesh
