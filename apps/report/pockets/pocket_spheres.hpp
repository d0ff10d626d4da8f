// Spheres of pockets, places and ways as files for molecular viewers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "report/pockets/pocket_report.hpp"
#include "report/pockets/scan_report.hpp"

namespace vdwmesh::apps {

// The kinds of files, by extension: .pdb, .pml, .bild, .mvsj.
enum class SphereFormat { pdb, pymol, bild, molstar };

// Empty for other extensions.
std::optional<SphereFormat> find_sphere_format(const std::filesystem::path& path);

// Spheres that belong together, with the radii of probes, Å.
struct SphereGroup {
  std::string kind;  // "void", "way"
  std::uint64_t number;
  std::string figure;  // of the whole, with its unit
  std::vector<Sphere> spheres;
};

// Pocket::alpha_spheres of each pocket, with the radius of the largest probe that its balls let in:
// the atoms are smaller by the probe than the balls.
std::vector<SphereGroup> spheres_of(const PocketReport& report);
// The largest probe at each place, and at each point of a way.
std::vector<SphereGroup> spheres_of(const ScanReport& report);
std::vector<SphereGroup> spheres_of(const WayReport& report);

//   PDB: as fpocket, HETATM records with the residue name STP, the group's number as residue number
//        and the radius in the column of B factors.
//   PyMOL: a script that makes an object of that PDB, with the radii, and a selection for each
//   group. BILD: spheres in a colour for each group, for ChimeraX. MolViewSpec: the same for Mol*,
//   with the group's name and figure as tooltips.
// Throws InvalidInput where a PDB record has no room for a coordinate or number.
std::string sphere_file(const std::vector<SphereGroup>& groups, SphereFormat format);

}  // namespace vdwmesh::apps
