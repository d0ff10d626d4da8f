// The exposed areas of spheres by freesasa, with coordinates and radii in memory. The radii have
// the probe already, so that freesasa's own is next to nothing.
#include <freesasa.h>

#include <stdexcept>

#include "anchors/anchors.hpp"

namespace vdwmesh::anchors {
namespace {

std::uint64_t area(const std::vector<Sphere>& spheres, freesasa_algorithm algorithm) {
  std::vector<double> positions, radii;
  for (const Sphere& sphere : spheres) {
    positions.insert(positions.end(), {sphere.center.x, sphere.center.y, sphere.center.z});
    radii.push_back(sphere.radius);
  }
  freesasa_parameters parameters = freesasa_default_parameters;
  parameters.alg = algorithm;
  parameters.lee_richards_n_slices = 20;
  parameters.shrake_rupley_n_points = 100;
  parameters.n_threads = 1;
  parameters.probe_radius = 1e-9;  // Å; 0 is taken for the default
  freesasa_result* result = freesasa_calc_coord(positions.data(), radii.data(),
                                                static_cast<int>(radii.size()), &parameters);
  if (!result) throw std::runtime_error("freesasa_calc_coord failed");
  freesasa_result_free(result);
  return spheres.size();
}

}  // namespace

std::uint64_t lee_richards(const std::vector<Sphere>& spheres) {
  return area(spheres, FREESASA_LEE_RICHARDS);
}

std::uint64_t shrake_rupley(const std::vector<Sphere>& spheres) {
  return area(spheres, FREESASA_SHRAKE_RUPLEY);
}

}  // namespace vdwmesh::anchors
