// The table of the voids of the exact union, as CSV.
#pragma once

#include <string>
#include <vector>

#include "measures/exact_union.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// One row per void, by falling volume; Å, Å², Å³. The lining atoms stand in one field, separated by
// spaces, as chain/residue number/atom name, and as index (from 1) where the file has no names.
std::string void_table_csv(const Molecule& molecule, const std::vector<Void>& voids);

}  // namespace vdwmesh::apps
