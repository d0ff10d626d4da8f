// Van der Waals radii by element, or by residue and atom name. The built-in sets by element are
// - "bondi": A. Bondi, J. Phys. Chem. 68 (1964) 441, with 1.20 Å for hydrogen. Elements that Bondi
//   does not list come from Alvarez.
// - "alvarez": S. Alvarez, Dalton Trans. 42 (2013) 8617.
// The built-in sets of united atoms, whose radii include the bonded hydrogens, are
// - "protor": J. Tsai, R. Taylor, C. Chothia and M. Gerstein, J. Mol. Biol. 290 (1999) 253.
// - "naccess": S. Hubbard and J. Thornton, the program NACCESS (1993).
// - "oons": T. Ooi, M. Oobatake, G. Némethy and H. Scheraga, PNAS 84 (1987) 3086.
// They have proteins and nucleotides; any other atom gets the radius that "bondi" has for its
// element. A file of the user replaces them all.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "structure/polarity.hpp"

namespace vdwmesh {

class UnitedAtoms;

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

  struct Entry {
    double radius;  // Å
    bool assumed;   // the set lacks the element or atom; the radius comes from another set
    Polarity polarity = Polarity::unknown;  // united atoms have one
    // The set has the atom by another name: that of the PDB for a protonation state ("HID"), an end
    // of a chain ("NALA") or an old spelling ("O1P").
    bool renamed = false;
  };
  // The radius of an atom; nothing if it is unknown. Names and element must be spelled as in the
  // table ("Zn", not "ZN"). Deuterium (D) gets the radius of hydrogen if the table has none for it.
  // Sets of united atoms have none for hydrogen and deuterium.
  std::optional<Entry> find(std::string_view residue, std::string_view atom,
                            std::string_view element) const;

  // Whether find() looks at nothing but the element.
  bool is_by_element() const { return by_atom_.empty() && united_ == nullptr; }
  // Whether the radii are those of united atoms, for structures without their hydrogens.
  bool has_united_atoms() const { return united_ != nullptr; }

 private:
  std::map<std::string, Entry, std::less<>> by_element_;
  std::map<std::pair<std::string, std::string>, double> by_atom_;  // (residue, atom) -> Å
  std::shared_ptr<const UnitedAtoms> united_;                      // null in sets by element
};

}  // namespace vdwmesh
