// Van der Waals radii. Bondi: A. Bondi, J. Phys. Chem. 68 (1964) 441, hydrogen 1.20 Å, completed
// from Alvarez for the elements it does not list. Alvarez: S. Alvarez, Dalton Trans. 42 (2013)
// 8617.
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
  // "bondi" or "alvarez". Throws InvalidInput for another name.
  static RadiusTable named(std::string_view name);

  // `ELEMENT RADIUS` or `RESIDUE ATOM RADIUS` per line, # comments; the latter win. Elements the
  // file does not name are unknown. Throws FileFormatError with the line number, also for two
  // different radii of one element or atom.
  static RadiusTable from_file(const std::filesystem::path& path);

  struct Entry {
    double radius;  // Å
    bool assumed;   // from the completion of the set, not from the set itself
  };
  std::optional<Entry> find(std::string_view residue, std::string_view atom,
                            std::string_view element) const;

 private:
  std::map<std::string, Entry, std::less<>> by_element_;
  std::map<std::pair<std::string, std::string>, double> by_atom_;
};

}  // namespace vdwmesh
