// Atoms as read, chosen and given radii, with the account of what was not used.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/vec3.hpp"

namespace vdwmesh {

struct Atom {
  Vec3d position;            // Å
  double radius = 0;         // Å; of the file (PQR, XYZR) or assigned from a radius set
  std::string element;       // symbol as in the periodic table ("C", "Zn"; "D" for deuterium)
  std::string name;          // "CA"
  std::string residue_name;  // "ALA"
  std::string chain;
  std::string residue_number;  // with insertion code: "52A"
  std::int64_t serial = 0;
  std::int32_t model = 1;
  bool hetero = false;  // HETATM
};

// Why atoms of the file were not used -> how many. Keys are those of the report's `skipped`:
// other_models, waters, hydrogens, hetatm, alternate_locations, microheterogeneity, not_selected,
// zero_radius, not_in_assembly.
using SkippedAtoms = std::map<std::string, std::uint64_t>;

// A radius that no table gives for this very atom but that was taken for its element.
struct AssumedRadius {
  std::string element;
  double radius;  // Å
  std::uint64_t count;
};

// An element other than H, C, N, O, P and S that the file does not give but that was told from the
// names of atom and residue.
struct GuessedElement {
  std::string element, residue_name, atom_name;
  std::uint64_t count;
};

struct Molecule {
  std::vector<Atom> atoms;
  std::string path, format;
  std::string model;       // "1", "all"
  std::string assembly;    // "asymmetric" or the name
  std::string radius_set;  // "bondi", "alvarez", "file", or the path of a radius file
  std::uint64_t atoms_read = 0;
  std::uint64_t atoms_used = 0;  // atoms of the file in `atoms`, each counted once: an assembly
                                 // holds copies, otherwise it is atoms.size()
  SkippedAtoms skipped;          // atoms_read = atoms_used + sum of skipped
  std::vector<AssumedRadius> radii_assumed;
  std::uint64_t elements_guessed = 0;  // of the atoms used: told from their names
  std::vector<GuessedElement> unusual_elements_guessed;
  std::vector<std::string> notes;     // what was chosen or guessed
  std::vector<std::string> warnings;  // what may be wrong with the file
};

}  // namespace vdwmesh
