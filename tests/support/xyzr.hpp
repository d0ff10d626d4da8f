// Balls from the plain reference files: x y z r per line, Å.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "extract/sphere_set.hpp"

namespace vdwmesh::testing {

inline SphereSet read_xyzr(const std::filesystem::path& path, double probe = 0) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::vector<Sphere> spheres;
  for (double x, y, z, r; file >> x >> y >> z >> r;) spheres.push_back({{x, y, z}, r + probe});
  return SphereSet(spheres);
}

}  // namespace vdwmesh::testing
