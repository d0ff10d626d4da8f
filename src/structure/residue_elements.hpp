// What the name of a residue says about the elements of its atoms. Names come in capitals and
// without blanks. Inside the room only.
#pragma once

#include <gemmi/elem.hpp>
#include <string_view>

namespace vdwmesh {

// The element of a monatomic ion: the atom is called like its residue, which is called after the
// element (PDB, AMBER, GROMACS: "CA" in "CA", "ZN" in "ZN2", "CL-" in "CL-", "AL3P" in "AL3P") or
// has a name of CHARMM's ("SOD" in "SOD"). X: it is no such ion.
gemmi::El element_of_ion(std::string_view name, std::string_view residue);

// Amino acids, nucleotides and end groups of chains, under the names of the PDB and those that
// AMBER, CHARMM and GROMACS give to their states of charge and to ends of chains. They hold nothing
// but H, C, N, O, P, S and Se.
bool is_standard_residue(std::string_view residue);
bool is_amino_acid(std::string_view residue);

// In a ligand with metals, the element of the atom if it is one of them: "FE" in "HEM", "CA1" in
// "OEX". X: the atom is no metal, or the ligand is not known.
gemmi::El metal_of_ligand(std::string_view name, std::string_view residue);

// Whether metal_of_ligand() knows the metals of that ligand, so that "NA" in "HEM" is nitrogen.
bool is_ligand_with_metals(std::string_view residue);

}  // namespace vdwmesh
