// Spheres in a form that can be compared with the reference files (x y z r, Å).
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "structure/molecule.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh::testing {

using Spheres = std::vector<std::array<double, 4>>;

// Sorted, since the references group chains where files do not.
inline Spheres spheres(const Molecule& molecule) {
  Spheres result;
  for (const Atom& atom : molecule.atoms)
    result.push_back({atom.position.x, atom.position.y, atom.position.z, atom.radius});
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace vdwmesh::testing
