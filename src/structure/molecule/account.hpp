// What a reader tells of the atoms that were chosen: of which kinds they are, and what about them
// does not look like a molecule in Å with radii of the set. Internal header of this folder.
#pragma once

#include <string>
#include <vector>

#include "structure/molecule/site.hpp"
#include "structure/radii.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// The sites by kind, as Molecule::kept has them.
std::vector<KeptAtoms> kept_by_kind(const Sites& sites);

// Chains with their residue numbers, and the names of residues that are no polymer: what a
// selection could have named. "chains A (1-76), B (1-76); residues HEM, PO4".
std::string names_of_what_is_there(const Sites& sites);

// The elements that names told, of which users can check those that are no common ones.
std::string note_of_guesses(const Molecule& molecule);

// Adds notes and warnings, each with what to type against it:
// - distances between atoms of a residue that are those of nm, pm or fractions of a cell;
// - atoms that lie in one place;
// - residues that have a single atom of their chain each;
// - no hydrogens beside a set for atoms without theirs;
// - hetero atoms that are kept, by residue;
// - models that were not asked for.
// Spheres of lists (XYZR) have no residues, and get none.
void note_what_looks_odd(const Sites& sites, const ParsedFile& file, const ReadOptions& options,
                         const RadiusTable& table, Molecule& molecule);

}  // namespace vdwmesh
