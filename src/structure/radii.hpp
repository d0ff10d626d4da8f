// Van der Waals radii by element, or by residue and atom name. There are two built-in sets:
// - "bondi": A. Bondi, J. Phys. Chem. 68 (1964) 441, with 1.20 Å for hydrogen. Elements that Bondi
//   does not list come from Alvarez.
// - "alvarez": S. Alvarez, Dalton Trans. 42 (2013) 8617.
// A file of the user replaces them.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace vdwmesh {

class RadiusTable {
 public:
  // The built-in set "bondi" or "alvarez". Throws InvalidInput for another name.
  static RadiusTable named(std::string_view name);

  // Reads a radius file. A line is "ELEMENT RADIUS" or "RESIDUE ATOM RADIUS", in Å; "#" begins a
  // comment. Lines for an atom take precedence over lines for an element. Elements that the file
  // does not name have no radius. Throws FileFormatError with the line number for a malformed line
  // and for two different radii of one element or atom.
  static RadiusTable from_file(const std::filesystem::path& path);

  struct Entry {
    double radius;  // Å
    bool assumed;   // the set lacks the element; the radius comes from Alvarez
  };
  // The radius of an atom; nothing if it is unknown. Names and element must be spelled as in the
  // table ("Zn", not "ZN"). Deuterium (D) gets the radius of hydrogen if the table has none for it.
  std::optional<Entry> find(std::string_view residue, std::string_view atom,
                            std::string_view element) const;

 private:
  std::map<std::string, Entry, std::less<>> by_element_;
  std::map<std::pair<std::string, std::string>, double> by_atom_;  // (residue, atom) -> Å
};

}  // namespace vdwmesh
