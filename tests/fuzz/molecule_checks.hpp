// What holds for every molecule that was read, whatever the file.
#pragma once

#include <cmath>

#include "fuzz/fuzz_target.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::fuzz {

inline void check_molecule(const Molecule& molecule) {
  require(!molecule.atoms.empty(), "a molecule has atoms");
  for (const Atom& atom : molecule.atoms) {
    const Vec3d& p = atom.position;
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "positions are finite");
    require(std::isfinite(atom.radius) && atom.radius > 0, "radii are finite and positive");
  }
  std::uint64_t skipped = 0;
  for (const auto& [reason, count] : molecule.skipped) skipped += count;
  require(molecule.atoms_read == molecule.atoms_used + skipped, "no atom is lost in silence");
  require(molecule.assembly != "asymmetric" || molecule.atoms.size() == molecule.atoms_used,
          "each used atom is there once");
}

}  // namespace vdwmesh::fuzz
