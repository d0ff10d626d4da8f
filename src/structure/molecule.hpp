// A molecule as the readers return it: the atoms in use with their radii, and an account of all
// atoms of the file that were not used, of guesses and of warnings.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "structure/polarity.hpp"
#include "structure/short_text.hpp"

namespace vdwmesh {

inline constexpr std::int32_t kNoGroup = -1;

struct Atom {
  Vec3d position;                 // Å
  double radius = 0;              // Å; from the file (PQR, XYZR) or from a radius set
  ShortText element;              // symbol as in the periodic table ("C", "Zn"; "D" for deuterium)
  ShortText name;                 // "CA"
  ShortText residue_name;         // "ALA"
  ShortText chain;                // in an assembly with the number of the copy: "A1"
  ShortText residue_number;       // with insertion code: "52A"; empty if the file has none
  std::int64_t serial = 0;        // as in the file
  std::int32_t model = 1;         // 0 if the file names the model by something else than a number
  bool hetero = false;            // the record is HETATM
  bool measured = true;           // false: covers others, and is not measured itself
  std::int32_t group = kNoGroup;  // the last one of ReadOptions::groups that contains the atom
  Polarity polarity = Polarity::unknown;  // by the radius set; sets by element have none
  std::uint32_t residue = 0;  // tells the residues of the file apart, which may have equal numbers
  float b_factor = 0;         // as in the file; 20 where an atom or the format has none
  ShortText segment;          // id of a segment (PDB, columns 73-76), empty in other formats
};

// Maps a reason why atoms of the file were not used to the number of these atoms. The reasons are
// the keys of `skipped` in the JSON report: other_models, waters, virtual_sites, hydrogens,
// hetatm, alternate_locations, microheterogeneity, not_selected, zero_radius, not_in_assembly.
using SkippedAtoms = std::map<std::string, std::uint64_t>;

// An element that the chosen radius set lacks and whose radius comes from the set that completes it
// (Alvarez for Bondi). Of a set of united atoms: an atom that it lacks, with the radius that
// Bondi's set has for the element.
struct AssumedRadius {
  std::string element;
  double radius;                        // Å
  std::uint64_t count;                  // atoms with this radius
  std::string residue_name, atom_name;  // empty for sets by element
};

// An element that the file does not give and that was derived from the names of atom and residue.
// H, C, N, O, P and S are too common to be listed. Users can check the others here.
struct GuessedElement {
  std::string element, residue_name, atom_name;
  std::uint64_t count;  // atoms with these three names
};

// Used atoms of the file of one kind: "protein", "nucleic acid", "water", or the name of a residue
// of any other kind.
struct KeptAtoms {
  std::string kind;
  std::uint64_t atoms = 0;
};

struct Molecule {
  std::vector<Atom> atoms;
  // `path` may be "standard input" or "sample ubiquitin"; `format` is "pdb", "mmcif", "cif" (of a
  // small molecule), "bcif", "pqr", "xyzr", "gro", "mol2", "sdf" or "xyz".
  std::string path, format;
  std::string model;             // the name of the model ("1"), or "all"
  std::string assembly;          // "asymmetric", or the name of an assembly in the file
  std::string radius_set;        // a built-in set, "file", or the path of a radius file
  bool has_polarity = false;     // the radius set says which atoms are polar
  std::uint64_t atoms_read = 0;  // all atoms of the file, in all of its models
  // Atoms of the file that are in `atoms`, each counted once. An assembly may hold several copies
  // of an atom; otherwise this is atoms.size().
  std::uint64_t atoms_used = 0;
  std::vector<KeptAtoms> kept;  // in the order of their first atoms; none of atoms without residues
  SkippedAtoms skipped;         // atoms_read is atoms_used plus the sum of these numbers
  std::vector<AssumedRadius> radii_assumed;
  std::uint64_t elements_guessed = 0;  // used atoms of the file whose element comes from names
  std::vector<GuessedElement> unusual_elements_guessed;
  std::vector<std::string> notes;     // what was chosen or guessed
  std::vector<std::string> warnings;  // what may be wrong with the file
};

}  // namespace vdwmesh
