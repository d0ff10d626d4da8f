// Groups of spheres, such as pockets and voids, as files for molecular viewers.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::apps {

// The kinds of files, by extension: .pdb, .pml, .bild, .mvsj.
enum class SphereFormat { pdb, pymol, bild, molstar };

// Empty for other extensions.
std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path);

// Spheres that are shown in one colour, with the radii of probes, Å.
struct SphereGroup {
  std::string kind;      // "void", "way"
  std::uint64_t number;  // from 1
  std::string figure;    // of the whole, with its unit
  std::vector<Sphere> spheres;
};

// The colour of the group of this number, from 1, in sRGB.
std::array<std::uint8_t, 3> group_color(std::uint64_t number);

// `all` is what the groups are called together ("pockets").
//   PDB: as fpocket, HETATM records with the residue name STP, the group's number as residue number
//        and the radius in the column of B factors.
//   PyMOL: a script that makes an object of that PDB, with the radii, and a selection for each
//        group.
//   BILD: spheres in a colour for each group, for ChimeraX.
//   MolViewSpec: the same for Mol*, with the group's name and figure as tooltips.
// Throws InvalidInput where a PDB record has no room for a coordinate or number.
std::string sphere_file(const std::vector<SphereGroup>& groups, std::string_view all,
                        SphereFormat format);

}  // namespace vdwmesh::apps
