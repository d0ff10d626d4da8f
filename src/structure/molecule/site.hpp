// An atom together with its residue, chain and model, and the choice among alternate locations.
// Internal header of this folder; sources that use the members include gemmi's headers, and
// parsed_file.hpp, themselves.
#pragma once

#include <string>
#include <vector>

#include "structure/molecule.hpp"

namespace gemmi {
struct Chain;
struct Model;
struct Residue;
}  // namespace gemmi

namespace vdwmesh {

struct AtomRecord;

// A residue, and where it stands in the gemmi::Structure of a ParsedFile.
struct ResiduePlace {
  gemmi::Model* model;
  gemmi::Chain* chain;
  gemmi::Residue* residue;
};

// An atom site: pointers to what must outlive the site.
struct Site {
  const ResiduePlace* place;
  AtomRecord* atom;
};

// The atoms of a residue stand together, as in gemmi's hierarchy.
using Sites = std::vector<Site>;

// Removes alternate locations from `sites`, so that one conformation per sequence position remains.
//
// - `label` is "all": nothing is removed.
// - `label` is one character: atoms with this label stay, atoms with another label go. Positions
//   that have other labels alone are chosen as "highest" does; a note of the molecule counts these
//   atoms. Throws InvalidInput if no atom of `sites` has the label.
// - `label` is "highest": each position keeps the label of highest mean occupancy; the first label
//   in the file wins ties. Then every atom name that the residue lacks is taken from the label of
//   the next highest mean that has it. Real files need this step: they give a hydrogen or a part of
//   a side chain a label that the other atoms of the same conformation do not have.
// - If several residues share the position (microheterogeneity), only one of them stays: the one
//   with the highest mean occupancy under the label kept.
// - Atoms without a label stay. The exception is an atom with an occupancy below 1 if an atom of
//   the same name stays with a label: some files leave the label of one conformation blank.
//
// `molecule.skipped` counts what was removed, under "alternate_locations" and "microheterogeneity".
void choose_alternate_locations(Sites& sites, const std::string& label, Molecule& molecule);

}  // namespace vdwmesh
