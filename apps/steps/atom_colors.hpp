// What pictures show of atoms: a colour or a value for each.
#pragma once

#include <string>
#include <vector>

#include "core/monitor.hpp"
#include "render/color_map.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

struct AtomColors {
  std::vector<Rgb> colors;  // by atom
  std::string key;          // "A #56b4e9, B #e69f00"; empty where everybody knows the colours
};

// CPK colours.
AtomColors colors_of_elements(const Molecule& molecule);
// Colours that chains take in turn.
AtomColors colors_of_chains(const Molecule& molecule);
// A colour for each ResidueClass.
AtomColors colors_of_residues(const Molecule& molecule);

// hydropathy() of each atom's residue; NaN where it has none.
std::vector<float> atom_hydropathies(const Molecule& molecule);
// The accessible area of each atom's residue in % of that in an extended tripeptide; NaN where that
// is not known.
std::vector<float> atom_exposures(const Molecule& molecule, Monitor* monitor);
// The B factors of the file. Throws InvalidInput where its format has none.
std::vector<float> atom_b_factors(const Molecule& molecule);

}  // namespace vdwmesh::apps
