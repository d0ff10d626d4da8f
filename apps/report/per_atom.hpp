// The measures of atoms, residues or chains, as CSV: radius, exact area, mesh area and exact
// volume; polar and apolar area; and how exposed a residue is beside one in an extended tripeptide.
#pragma once

#include <string>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "interface/interfaces.hpp"
#include "measures/exact_union.hpp"
#include "measures/union_gradients.hpp"
#include "options.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// What the table is made of. `mesh_area` is empty or has one entry per atom, Å².
struct PerAtomTable {
  const Molecule& molecule;
  double probe;  // Å
  const ExactUnion& exact;
  const std::vector<double>& mesh_area;
  AtomGroup group;
};

// One row per atom, residue or chain, in the order of the file. Columns that have no value for a
// row, or were not computed, are empty: the measures of a row without an atom that --measure chose.
// Sums are over the chosen atoms of a row, which the column of the measured ones counts.
std::string per_atom_csv(const PerAtomTable& table);

// For each atom 100 times the relative area of its residue; NaN where the residue has none.
std::vector<double> residue_exposure(const PerAtomTable& table);

// Areas of residues, in all and by parts, and percentages of the reference, in the columns of
// NACCESS's .rsa files; then sums of chains. As in FreeSASA's files CA counts as main chain.
std::string residue_areas_text(const PerAtomTable& table);

// The shares of atoms, residues or chains in the excluded surface: area by kind of patch and whole,
// and volume.
std::string excluded_atoms_csv(const Molecule& molecule, const std::vector<ExcludedAtom>& shares,
                               AtomGroup group);

// How far each atom's centre lies below the solvent-excluded surface, Å: the complete one, whose
// cavities are outside, and the exterior one.
struct AtomDepths {
  std::vector<double> complete, exterior;
};

// Depths of atoms, or the means of residues or chains. Below the accessible surface an atom lies
// deeper than below the excluded one by the probe (Å): nearest points of both lie on one line.
std::string depth_csv(const Molecule& molecule, double probe, const AtomDepths& depths,
                      AtomGroup group);

// What the table of interfaces is made of.
struct InterfaceTable {
  const Molecule& molecule;
  double probe;  // Å
  const std::vector<std::string>& sides;
  const std::vector<std::int32_t>& side_of_atom;
  const Interfaces& found;
  AtomGroup group;
};

// The atoms, residues or chains of each interface, in the order of the interfaces and of the file:
// area alone, with the other side and among all, buried area, area of contacts. Rows that neither
// lose area nor touch an atom of the other side are left out.
std::string interface_csv(const InterfaceTable& table);

// The derivatives of area (Å) and volume (Å²) by each atom's centre and radius, a row for each atom
// in the order of the file.
std::string gradient_csv(const std::vector<BallGradient>& gradients);

}  // namespace vdwmesh::apps
