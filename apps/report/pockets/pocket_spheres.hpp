// The spheres of pockets as files for molecular viewers.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "report/pockets/pocket_report.hpp"

namespace vdwmesh::apps {

// The kinds of files, by extension: .pdb, .pml, .bild.
enum class SphereFormat { pdb, pymol, bild };

// Empty for other extensions.
std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path);

// Pocket::alpha_spheres of all pockets, each with the radius of the largest probe that its balls
// let in (the atoms are smaller by the probe than the balls). Pockets are numbered by rank.
//   PDB: as fpocket, HETATM records with the residue name STP, the pocket's rank as residue number
//        and the radius in the column of B factors.
//   PyMOL: a script that makes an object of that PDB, with the radii, and a group for each pocket.
//   BILD: spheres in a colour for each pocket, for ChimeraX.
// Throws InvalidInput where a PDB record has no room for a coordinate or rank.
std::string pocket_spheres(const PocketReport& report, SphereFormat format);

}  // namespace vdwmesh::apps
