// What tables call an atom: chain/residue number/atom name, or its index (from 1) where the file
// has no names.
#pragma once

#include <fmt/format.h>

#include <string>

#include "spheres/sphere_set.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

inline std::string name_of_atom(const Molecule& molecule, SphereId id) {
  const Atom& atom = molecule.atoms[id];
  if (atom.name.empty()) return fmt::format("{}", id + 1);
  return fmt::format("{}/{}/{}", atom.chain.view(), atom.residue_number.view(), atom.name.view());
}

}  // namespace vdwmesh::apps
