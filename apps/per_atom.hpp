// Radius, exact area, mesh area and exact volume by atom, residue or chain, as CSV.
#pragma once

#include <string>
#include <vector>

#include "arrangement/exact_union.hpp"
#include "options.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// One row per atom, residue or chain, in the order of the file. Columns that have no value for a
// row, or were not computed, are empty: the measures of a row without an atom that --measure chose.
// Sums are over the chosen atoms of a row, which its last column counts. `mesh_area` is empty or
// has one entry per atom.
std::string per_atom_csv(const Molecule& molecule, double probe, const ExactUnion& exact,
                         const std::vector<double>& mesh_area, AtomGroup group);

}  // namespace vdwmesh::apps
