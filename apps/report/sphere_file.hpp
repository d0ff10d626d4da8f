// Groups of spheres, such as pockets and voids, as files for molecular viewers.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::apps {

// The kinds of files, by extension: .pdb, .pml, .bild.
enum class SphereFormat { pdb, pymol, bild };

// Empty for other extensions.
std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path);

// Spheres that are shown in one colour, in Å.
struct SphereGroup {
  std::string kind;   // "void"
  double volume = 0;  // Å³, which a comment says
  std::vector<Sphere> spheres;
};

// Groups are numbered from 1 in their order; `all` is what they are called together ("voids").
//   PDB: as fpocket, HETATM records with the residue name STP, the group as residue number and the
//        radius in the column of B factors.
//   PyMOL: a script that makes an object of that PDB, with the radii, and a selection for each
//        group.
//   BILD: spheres in a colour for each group, for ChimeraX.
// Throws InvalidInput where a PDB record has no room for a coordinate or a number.
std::string spheres_text(std::span<const SphereGroup> groups, std::string_view all,
                         SphereFormat format);

}  // namespace vdwmesh::apps
