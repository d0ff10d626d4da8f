// Which element an atom is, if the file does not say. Inside the room only.
//
// Programs agree on names of atoms, not on where they stand: a name says "CA" for the alpha carbon
// and for calcium. What decides is the residue first (ions, standard residues under the names of
// force fields, ligands with a metal), then the column in which the name begins.
#pragma once

#include <string_view>

namespace vdwmesh {

// From the atom name as it stands in columns 13-16 of a PDB record: an element of two letters
// starts in column 13, one of a single letter in column 14, so "CA  " is calcium and " CA " a
// carbon. In residues that are known, a name that has slipped is still read right. "X": cannot be
// told.
const char* element_of_aligned_name(std::string_view four_columns, std::string_view residue);

// From the bare name, of which it is not known where it stood.
const char* element_of_bare_name(std::string_view name, std::string_view residue);

// The symbol with its usual capitals ("ZN", "zn", "Zn2+" -> "Zn"); "X" where there is no such
// element.
const char* element_of_symbol(std::string_view symbol);

// Whether an atom of that name is a bead of the coarse-grained Martini force fields: several atoms
// in one, and of no element. True for names that no atom bears alone: the beads of amino acids
// (BB, SC1, ...) and the first glycerol bead of lipids (GL1). A file with one of them holds beads
// throughout.
bool is_martini_bead(std::string_view name, std::string_view residue);

}  // namespace vdwmesh
