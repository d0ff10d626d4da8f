// Balls from the reference files, plain or compressed by gzip: x y z r per line, Å.
#pragma once

#include <zlib.h>

#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::testing {

inline SphereSet read_xyzr(const std::filesystem::path& path, double probe = 0) {
  const gzFile file = gzopen(path.c_str(), "rb");
  if (file == nullptr) throw std::runtime_error("cannot read " + path.string());
  std::vector<Sphere> spheres;
  char line[256];
  while (gzgets(file, line, sizeof line) != nullptr) {
    double x, y, z, r;
    if (!(std::istringstream(line) >> x >> y >> z >> r)) {
      throw std::runtime_error(path.string() + ": not four numbers: " + line);
    }
    spheres.push_back({{x, y, z}, r + probe});
  }
  gzclose(file);
  return SphereSet(spheres);
}

}  // namespace vdwmesh::testing
