// Edge lengths of the crease-exact mesher that differ from atom to atom.
#pragma once

#include <vector>

#include "command_line/command_line.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {

// SurfaceOptions::edge_lengths of these atoms, whose balls are `spheres`; empty if all are alike.
// An atom has the length that the table gives it; else that of its group; else the shorter one of
// the length for all and its share of the radius. Throws InvalidInput, naming file and line, for a
// table that is none of these atoms.
std::vector<double> edge_lengths_of(const SurfaceOptions& surface, const Molecule& molecule,
                                    const SphereSet& spheres);
// The options with these lengths.
Options with_edge_lengths(Options options, const Structure& structure);

}  // namespace vdwmesh::apps
