// From everything in a file to the atoms in use. Inside the room only.
#pragma once

#include "structure/molecule.hpp"
#include "structure/parsed_file.hpp"
#include "structure/radii.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// Applies, in this order: model, waters, hydrogens, HETATM, alternate locations, selection, radii,
// assembly. `table` is not used for files with their own radii. Throws InvalidInput.
Molecule choose_atoms(const ParsedFile& file, const ReadOptions& options, const RadiusTable& table);

}  // namespace vdwmesh
