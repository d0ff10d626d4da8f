// Which element an atom is, where the file does not say. Inside the room only.
#pragma once

#include <string_view>

namespace vdwmesh {

// From the atom name as it stands in columns 13-16 of a PDB record: an element of two letters
// starts in column 13, one of a single letter in column 14, so "CA  " is calcium and " CA " a
// carbon. In the standard residues only H, C, N, O, P, S and Se occur, so there a name that has
// slipped to the left is still read right. "X": cannot be told.
const char* element_of_aligned_name(std::string_view four_columns, std::string_view residue);

// From the bare name: an ion has the name of its residue, anything else its first letter.
const char* element_of_bare_name(std::string_view name, std::string_view residue);

// The symbol with its usual capitals ("ZN", "zn", "Zn2+" -> "Zn"); "X" where there is no such
// element.
const char* element_of_symbol(std::string_view symbol);

}  // namespace vdwmesh
