// Gives every atom in use a radius from a radius set, with an account of those that the set lacks.
// Internal header of this folder.
#pragma once

#include "structure/molecule.hpp"
#include "structure/molecule/site.hpp"
#include "structure/radii.hpp"
#include "structure/read/parsed_file.hpp"

namespace vdwmesh {

// Sets radius and polarity of the sites, which are of `file`. Appends to `molecule.radii_assumed`
// what the set itself lacks, and to `molecule.notes` which atoms it has by other names; sets
// `molecule.has_polarity`.
// `molecule.radius_set` is the name of the set. Throws InvalidInput for an atom without a radius;
// the message says which line of a radius file would give it one.
void assign_radii(Sites& sites, const ParsedFile& file, const RadiusTable& table,
                  Molecule& molecule);

}  // namespace vdwmesh
