// The atoms in use as a file that viewers open, with a figure of each atom as its B factor.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/letters.hpp"
#include "core/vec3.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// Å: whether eight columns of which three are decimals hold the coordinates.
inline bool fits_in_pdb(const Vec3d& p) {
  const auto fits = [](double x) { return x > -999.9995 && x < 9999.9995; };
  return fits(p.x) && fits(p.y) && fits(p.z);
}

// A residue number and its insertion code: "52" and 'A' of "52A", "52" and ' ' of "52".
inline std::pair<std::string_view, char> number_and_code(std::string_view text) {
  if (text.empty() || is_digit(text.back())) return {text, ' '};
  return {text.substr(0, text.size() - 1), text.back()};
}

// One figure for each atom, NaN where it has none.
struct AtomColumn {
  std::string_view name;  // "area", as the column vdwmesh_area of mmCIF
  std::vector<double> values;
};
// At least one; the first is in place of B factors.
using AtomColumns = std::vector<AtomColumn>;

// Records of PDB, with the first figures alone: two decimals, and -1.00 for an atom without one.
// Throws InvalidInput where the columns of PDB have no room for a name, a number, a coordinate or a
// figure.
std::string atoms_as_pdb(const Molecule& molecule, const AtomColumns& figures);
// mmCIF's _atom_site. The first figure is in B_iso_or_equiv, and each in a column of its own name.
std::string atoms_as_cif(const Molecule& molecule, const AtomColumns& figures);

// Which of the two a name asks for by its extension (.pdb .ent .cif .mmcif); null for others.
using AtomWriter = std::string (*)(const Molecule&, const AtomColumns&);
AtomWriter find_atom_writer(const std::filesystem::path& path);

}  // namespace vdwmesh::apps
