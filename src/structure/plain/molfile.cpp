// Reads molfiles and SDF (MDL, BIOVIA), V2000 and V3000: three lines of header, the counts, atoms,
// bonds, and further lines to "M  END"; in SDF data to "$$$$", and the next molecule. Each molecule
// is a model of its own. V2000 has fixed columns, V3000 words.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "structure/plain/atom_lines.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::string_view kLast = "$$$$";  // begins the last line of a molecule

class MolfileReader {
 public:
  MolfileReader(std::string_view text, const std::string& path, Monitor* monitor)
      : lines_(text, path, monitor), builder_(path, "sdf") {}

  ParsedFile run() {
    for (int molecule = 1; molecule == 1 || !lines_.is_at_end(); ++molecule)
      read_molecule(std::to_string(molecule));
    for (const auto& [fault, molecules] : faults_)
      builder_.file().warnings.push_back(
          fmt::format("{} of the molecules {}; the first is model {}", molecules.first, fault,
                      molecules.second));
    return builder_.finish();
  }

 private:
  void read_molecule(const std::string& name) {
    if (lines_.expect("the title of a molecule").starts_with('$'))
      lines_.refuse("is a reaction or a query, not a molecule");
    const bool says_2d = columns(lines_.expect("the second line of a header"), 20, 2) == "2D";
    lines_.expect("the third line of a header");
    const std::string_view counts = lines_.expect("the numbers of atoms and bonds");
    first_atom_ = builder_.file().atoms.size();
    name_ = name;
    has_model_ = has_end_ = false;
    if (trimmed(columns(counts, 33, 6)) == "V3000")
      read_v3000();
    else
      read_v2000();
    while (!lines_.line().starts_with(kLast) && lines_.next())
      has_end_ |= lines_.line().starts_with("M  END");
    if (!has_end_) note("have no M  END: the file may have been cut off");
    if (!has_model_) return note("have no atoms");
    const auto& atoms = builder_.file().atoms;
    const bool is_flat =
        std::all_of(atoms.begin() + static_cast<std::ptrdiff_t>(first_atom_), atoms.end(),
                    [](const AtomRecord& atom) { return atom.position.z == 0; });
    if (says_2d && is_flat)
      note("are drawings, not structures: line 2 says 2D, for two dimensions, and all z are 0");
  }

  void read_v2000() {
    const std::string_view line = lines_.line();
    const std::uint64_t atoms = lines_.count_in(columns(line, 0, 3), "the number of atoms");
    const std::uint64_t bonds = lines_.count_in(columns(line, 3, 3), "the number of bonds");
    for (std::uint64_t i = 0; i < atoms; ++i) {
      const std::string_view atom = lines_.expect(fmt::format("atom {} of {}", i + 1, atoms));
      add(trimmed(columns(atom, 31, 3)),
          lines_.position_in(columns(atom, 0, 10), columns(atom, 10, 10), columns(atom, 20, 10)));
    }
    const auto is_atom_number = [atoms](std::string_view field) {
      const std::optional<std::int64_t> number = whole_number(field);
      return number && *number > 0 && static_cast<std::uint64_t>(*number) <= atoms;
    };
    for (std::uint64_t i = 0; i < bonds; ++i) {
      const std::string_view bond = lines_.expect(fmt::format("bond {} of {}", i + 1, bonds));
      if (!is_atom_number(columns(bond, 0, 3)) || !is_atom_number(columns(bond, 3, 3)))
        lines_.refuse(
            fmt::format("bond {} of {} should stand here, between two of {} atoms: do "
                        "the numbers in line 4 of the molecule fit?",
                        i + 1, bonds, atoms));
    }
  }

  // A line that ends with a minus goes on in the next one.
  void read_v3000() {
    constexpr std::string_view kPrefix = "M  V30 ";
    std::uint64_t wanted = 0, found = 0;
    bool is_inside = false, goes_on = false;
    for (;;) {
      std::string_view line = lines_.expect("M  END");
      has_end_ = line.starts_with("M  END");
      if (has_end_ || line.starts_with(kLast)) break;
      if (!line.starts_with(kPrefix)) continue;
      line = trimmed(line.substr(kPrefix.size()));
      const bool is_continued = std::exchange(goes_on, line.ends_with('-'));
      if (is_continued) continue;
      if (line == "BEGIN ATOM" || line == "END ATOM") {
        is_inside = line == "BEGIN ATOM";
      } else if (line.starts_with("COUNTS")) {
        const std::vector<std::string_view> words = split_at_blanks(line);
        wanted = lines_.count_in(words.size() > 1 ? words[1] : "", "the number of atoms");
      } else if (is_inside) {
        add_v3000(split_at_blanks(line));
        ++found;
      }
    }
    if (found != wanted)
      lines_.refuse(fmt::format("here ends a molecule with {} atoms, of which COUNTS says {}",
                                found, wanted));
  }

  void add_v3000(const std::vector<std::string_view>& words) {
    if (words.size() < 5)
      lines_.refuse(
          fmt::format("has {} fields; an atom has at least 5: index symbol x y z", words.size()));
    add(words[1], lines_.position_in(words[2], words[3], words[4]));
  }

  void add(std::string_view symbol, const Vec3d& position) {
    if (!has_model_) builder_.begin_model(name_);
    has_model_ = true;
    AtomRecord& atom = builder_.add(kOnlyResidue, position, lines_.number());
    atom.serial = static_cast<std::int64_t>(builder_.file().atoms.size() - first_atom_);
    read_symbol(symbol, lines_, atom);
  }

  // Counts the molecule among those that have the fault.
  void note(const std::string& fault) {
    auto& [count, first] = faults_[fault];
    if (count++ == 0) first = name_;
  }

  NumberedLines lines_;
  StructureBuilder builder_;
  std::size_t first_atom_ = 0;  // of the molecule, in the file
  std::string name_;            // of its model: its place in the file, from 1
  bool has_model_ = false, has_end_ = false;
  std::map<std::string, std::pair<std::size_t, std::string>> faults_;  // number, name of the first
};

}  // namespace

ParsedFile parse_sdf(std::string_view text, const std::string& path, Monitor* monitor) {
  return MolfileReader(text, path, monitor).run();
}

}  // namespace vdwmesh
