// Residues of gemmi's hierarchy by number, and the atoms in them. Internal header of this folder.
//
// The parsers leave atoms in one array, ParsedFile::atoms, in the order of the file, and in
// gemmi::Structure models, chains and residues alone. An atom knows its residue by the number that
// it has in the hierarchy: model by model, chain by chain, from 0.
#pragma once

#include <cstdint>
#include <vector>

#include "structure/molecule/site.hpp"
#include "structure/read/parsed_file.hpp"

namespace gemmi {
struct Atom;
}

namespace vdwmesh {

// The residues of all models by their numbers.
std::vector<ResiduePlace> numbered_residues(gemmi::Structure& structure);

// Completes file.atoms by what gemmi::Atom has, for parsers that fill gemmi's residues with atoms.
// gemmi::Atom::serial is the index in file.atoms.
void take_gemmi_atoms(ParsedFile& file);

// Fills gemmi's residues with the atoms, if they have none. gemmi looks at atoms to tell polymers
// from other residues.
void give_gemmi_atoms(ParsedFile& file);

// The atom as gemmi has it, for its selections.
void copy_to_gemmi(const AtomRecord& record, gemmi::Atom& atom);

// All atoms of the file, residue by residue, those of a residue in the order of the file. `places`
// are those of its residues by number, and must outlast the sites.
Sites all_sites(ParsedFile& file, const std::vector<ResiduePlace>& places);

// The residue of each atom, by a number in the order of the file. gemmi tells residues by model,
// chain, segment, number and name. These come again where a file counts past 9999 or has several
// chains without ids: an atom that its residue has already, behind atoms of other residues, begins
// another residue. So does the first atom of a residue that comes again right behind it, as of two
// waters with one number, unless the atoms look like one molecule without unique names or like
// locations without labels. And a residue may be spread over two chains of one name. Empty: the
// atoms' numbers in the hierarchy say it all, as in nearly all files.
std::vector<std::uint32_t> residue_numbers(const ParsedFile& file,
                                           const std::vector<ResiduePlace>& places);

}  // namespace vdwmesh
