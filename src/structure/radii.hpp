// Van der Waals radii by element, or by residue and atom name. The built-in sets by element are
// - "bondi": A. Bondi, J. Phys. Chem. 68 (1964) 441, with 1.20 Å for hydrogen. Elements that Bondi
//   does not list come from Alvarez.
// - "alvarez": S. Alvarez, Dalton Trans. 42 (2013) 8617.
// The built-in sets of united atoms, whose radii include the bonded hydrogens, are
// - "protor": J. Tsai, R. Taylor, C. Chothia and M. Gerstein, J. Mol. Biol. 290 (1999) 253.
// - "naccess": S. Hubbard and J. Thornton, the program NACCESS (1993).
// - "oons": T. Ooi, M. Oobatake, G. Némethy and H. Scheraga, PNAS 84 (1987) 3086.
// They have proteins and nucleotides; any other atom gets the radius that "bondi" has for its
// element. A file of the user replaces them all, or adds to one of them ("bondi,mine.txt").
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "structure/polarity.hpp"

namespace vdwmesh {

class UnitedAtoms;

// What a table says of an atom.
struct AtomRadius {
  static constexpr int kNoLine = -1;
  double radius;  // Å
  bool assumed;   // the set lacks the element or atom; the radius comes from another set
  Polarity polarity = Polarity::unknown;  // united atoms have one
  // The set has the atom by another name: that of the PDB for a protonation state ("HID"), an end
  // of a chain ("NALA") or an old spelling ("O1P").
  bool renamed = false;
  int line = kNoLine;  // index in RadiusTable::lines(), of a radius from a file
};

class RadiusTable {
 public:
  // The names of the built-in sets.
  static const std::vector<std::string>& names();

  // The built-in set of that name. Throws InvalidInput, which lists the names, for another one.
  static RadiusTable named(std::string_view name);

  // Reads a radius file. A line is "ELEMENT RADIUS" or "RESIDUE ATOM RADIUS", in Å; "#" begins a
  // comment. Lines for an atom take precedence over lines for an element. Elements that the file
  // does not name have no radius. Throws FileFormatError with the line number for a malformed line
  // and for two different radii of one element or atom.
  static RadiusTable from_file(const std::filesystem::path& path);

  // What a user asks for: a set, a radius file, or a set or file and further files, with commas
  // ("bondi,mine.txt"). Every line of a later part precedes those of the parts before it. Throws
  // InvalidInput as well, for a part that is neither a set nor a file, and for a set behind another
  // part.
  static RadiusTable from_list(const std::string& list);
  // The parts of such a list. The name of a file that is there is one part even with commas in it.
  static std::vector<std::string> parts_of(const std::string& list);

  // The radius of an atom; nothing if it is unknown. Names and element must be spelled as in the
  // table ("Zn", not "ZN"). Deuterium (D) gets the radius of hydrogen if the table has none for it.
  // Sets of united atoms have none for hydrogen and deuterium.
  std::optional<AtomRadius> find(std::string_view residue, std::string_view atom,
                                 std::string_view element) const;

  // Whether find() looks at nothing but the element.
  bool is_by_element() const { return !has_atoms_ && united_ == nullptr; }
  // Whether the radii are those of united atoms, for structures without their hydrogens.
  bool has_united_atoms() const { return united_ != nullptr; }

  // The lines of the files that give radii, as messages call them: "mine.txt:3 (THR CA)".
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  // The radii of one file, or of a set by element. Those of atoms have the key "RESIDUE ATOM".
  using Entries = std::map<std::string, AtomRadius, std::less<>>;
  void add_file(const std::filesystem::path& path);

  std::vector<Entries> files_;  // the later ones precede
  bool has_atoms_ = false;      // some file has a line for an atom
  std::vector<std::string> lines_;
  std::shared_ptr<const UnitedAtoms> united_;  // null in sets by element
  Entries by_element_;                         // of the set
};

}  // namespace vdwmesh
