// Derives the element of an atom from names, for files that do not give it. Internal header of this
// folder.
//
// An atom name alone is ambiguous: "CA" is the alpha carbon of an amino acid, or calcium. The
// residue decides first if its name is known: ions, standard residues (also under the names that
// force fields use), ligands with a metal. Otherwise the column decides in which the name begins,
// if the format has columns and the file respects them.
//
// All functions return gemmi's symbols ("Zn"), as pointers to static strings; "X" means unknown.
#pragma once

#include <string_view>

namespace vdwmesh {

// The element from an atom name as it stands in columns 13-16 of a PDB record. An element of two
// letters begins in column 13, and one of a single letter in column 14: "CA  " is calcium, " CA "
// is a carbon. In known residues the columns do not matter, so a name that is shifted is still read
// correctly.
const char* element_of_aligned_name(std::string_view four_columns, std::string_view residue);

// The element from a name without blanks, for formats without fixed columns.
const char* element_of_bare_name(std::string_view name, std::string_view residue);

// The symbol in its usual spelling, without a charge: "ZN", "zn" and "Zn2+" become "Zn". "X" if
// there is no such element.
const char* element_of_symbol(std::string_view symbol);

// Whether an atom is a bead of the coarse-grained Martini force fields. A bead stands for several
// atoms and has no element. The function recognises only names that no real atom has: the beads of
// amino acids (BB, SC1, ...) in an amino acid, and the first glycerol bead of lipids (GL1). One
// such bead is enough to know that all atoms of the file are beads.
bool is_martini_bead(std::string_view name, std::string_view residue);

}  // namespace vdwmesh
