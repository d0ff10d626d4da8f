// The names that the PDB gives to residues and atoms which simulation programs and old files call
// otherwise. Internal header of this folder.
#pragma once

#include <string>
#include <string_view>

namespace vdwmesh {

// The standard residue that `residue` is a protonation state, an end of a chain or another spelling
// of: "HIS" for "HID", "CYS" for "CYX", "ALA" for AMBER's "NALA", "DA" for "DA5", "HOH" for "WAT".
// Any other name is returned in capitals.
std::string standard_residue_name(std::string_view residue);

// The name of the atom in the PDB, for a residue with a standard name: "CD1" for "CD" of "ILE",
// "OXT" for "OT2" of an amino acid, "OP1" for "O1P" and "C1'" for "C1*" of a nucleotide, "C7" for
// "C5M" of thymine. Any other name is returned in capitals.
std::string standard_atom_name(std::string_view residue, std::string_view atom);

}  // namespace vdwmesh
