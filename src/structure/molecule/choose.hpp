// Turns everything that a file holds (ParsedFile) into the atoms in use (Molecule). Internal header
// of this folder.
#pragma once

#include "structure/molecule.hpp"
#include "structure/radii.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/read/unexpanded.hpp"
#include "structure/reader.hpp"

namespace vdwmesh {

// Applies the options in this order: model, waters, hydrogens, HETATM, alternate locations,
// selection, radii, assembly. Counts every atom that is dropped in Molecule::skipped. `table` gives
// the radii, unless the file has its own. Throws InvalidInput if an option does not suit the file,
// if no atom is left, none is to be measured or a group has none, or if an atom has no known
// radius. Throws FileFormatError for an assembly that cannot be made, and LimitExceeded for one
// with too many atoms.
// The copies of an assembly are counted and listed, and not made.
UnexpandedMolecule choose_atoms(ParsedFile&& file, const ReadOptions& options,
                                const RadiusTable& table);

}  // namespace vdwmesh
