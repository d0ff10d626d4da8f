// One atom with where it stands in the file. Inside the room only; needs gemmi's headers.
#pragma once

#include <string>
#include <vector>

#include "structure/molecule.hpp"

namespace gemmi {
struct Atom;
struct Chain;
struct Model;
struct Residue;
}  // namespace gemmi

namespace vdwmesh {

struct Site {
  const gemmi::Model* model;
  const gemmi::Chain* chain;
  const gemmi::Residue* residue;
  const gemmi::Atom* atom;
  double radius = 0;  // Å
};

using Sites = std::vector<Site>;

// Keeps one alternate location per residue: `label`, or if that is "highest" the one of highest
// mean occupancy in the residue (ties: the first in the file); if several residues share a place
// (microheterogeneity), the one of highest mean occupancy of them all. Atoms without a label stay.
// With "highest", so do atoms whose names the label kept does not have, of the label of the next
// highest mean that has them, because no conformation lacks an atom: files give hydrogens and
// parts of side chains a label of their own. An atom without a label and of an occupancy below 1
// goes if the label kept has one of its name. "all" keeps everything. Throws InvalidInput if no
// atom has `label`.
void choose_alternate_locations(Sites& sites, const std::string& label, const std::string& path,
                                SkippedAtoms& skipped);

}  // namespace vdwmesh
