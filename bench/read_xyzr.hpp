// Spheres from a file with x, y, z and radius in each line, Å.
#pragma once

#include <filesystem>
#include <fstream>
#include <vector>

#include "core/errors.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// `probe` is added to every radius.
inline std::vector<Sphere> read_xyzr(const std::filesystem::path& path, double probe = 0) {
  std::ifstream file(path);
  if (!file) throw InvalidInput("cannot open " + path.string());
  std::vector<Sphere> spheres;
  for (double x, y, z, r; file >> x >> y >> z >> r;) spheres.push_back({{x, y, z}, r + probe});
  return spheres;
}

}  // namespace vdwmesh
