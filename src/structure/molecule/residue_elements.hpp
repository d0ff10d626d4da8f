// What the name of a residue says about the elements of its atoms. All names are passed in capitals
// and without blanks. elements.cpp calls these functions. Internal header of this folder.
#pragma once

#include <cstdint>
#include <gemmi/elem.hpp>
#include <string_view>

namespace vdwmesh {

// The element of a monatomic ion; X if the names are not those of an ion. The atom and its residue
// have the same name up to digits and charge. The name is a symbol ("CA" in residue "CA", "ZN" in
// "ZN2", "CL-" in "CL-", "AL3P" in "AL3P") or a force field's name of an ion ("SOD" in "SOD" is
// sodium). In a residue ION the name of the atom is enough.
gemmi::El element_of_ion(std::string_view name, std::string_view residue);

// Whether the residue is an amino acid, a nucleotide or an end group of a chain. Names are
// recognised from the PDB and from AMBER, CHARMM and GROMACS, which have names of their own for
// protonation states and for the ends of chains. Such residues contain only H, C, N, O, P, S and
// Se.
bool is_standard_residue(std::string_view residue);
bool is_amino_acid(std::string_view residue);

// Whether a name with D in front is that of a hydrogen of the residue with D for H, as deuterium
// has it: "D", "DA", "DH11" or "2DB" of ARG, "DO5'" of DA, "D1" of DOD. Amino acids, end groups,
// nucleotides and waters alone have known hydrogens.
bool is_deuterium_name(std::string_view name, std::string_view residue);

// What kind of molecule a residue is part of, by its name in any case: of the PDB, or of a force
// field. Modified amino acids and nucleotides, and the caps of chains, are of the kind of their
// chain.
enum class ResidueKind : std::uint8_t { protein, nucleic, water, other };
ResidueKind kind_of_residue(std::string_view residue);

// Whose name of water the residue has. Other molecules have some of the names that are not of the
// PDB.
enum class WaterName : std::uint8_t { none, of_the_pdb, of_a_program, of_a_bead, of_charged_sites };
WaterName water_name(std::string_view residue);
inline bool is_named_as_water(std::string_view residue) {  // and is no bead
  const WaterName name = water_name(residue);
  return name != WaterName::none && name != WaterName::of_a_bead;
}

// The element of a metal atom in a known ligand: "FE" in "HEM" is iron, "CA1" in "OEX" is calcium.
// X if the atom is not a metal of the ligand, or if the ligand is not known.
gemmi::El metal_of_ligand(std::string_view name, std::string_view residue);

// Whether metal_of_ligand() knows this ligand. Then all its other atoms are not metals: "NA" in
// "HEM" is a nitrogen.
bool is_ligand_with_metals(std::string_view residue);

}  // namespace vdwmesh
