// Reads GROMACS's .gro: a title, the number of atoms, an atom in each line, and the box; and so on
// for each frame. Columns are fixed, and those of coordinates as wide as their decimal points are
// apart, so that files of any precision are read. Velocities are passed over.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <gemmi/model.hpp>
#include <vector>

#include "core/letters.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/plain/atom_lines.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kFirstColumn = 20;  // of x, counted from 0
constexpr std::size_t kFirstPoint = 24;   // column of the decimal point of x, in any precision

class GroReader {
 public:
  GroReader(std::string_view text, const std::string& path, Monitor* monitor)
      : lines_(text, path, monitor), builder_(path, "gro") {}

  ParsedFile run() {
    for (int frame = 1; frame == 1 || !lines_.is_at_end(); ++frame) {
      lines_.expect("the title of a frame");
      const std::uint64_t count =
          lines_.count_in(lines_.expect("the number of atoms"), "the number of atoms of a frame");
      builder_.begin_model(std::to_string(frame));
      const std::size_t first = builder_.file().atoms.size();
      width_ = 0;
      for (std::uint64_t i = 0; i < count; ++i) {
        lines_.expect(fmt::format("atom {} of {}", i + 1, count));
        take_atom();
      }
      take_box(first);
    }
    if (broken_ > 0)
      builder_.file().warnings.push_back(fmt::format(
          "atoms of {} residues are more than half of the periodic box apart: the box cuts them, "
          "and their surface is not that of whole molecules; gmx trjconv -pbc mol makes them whole",
          broken_));
    if (is_coarse_grained_) forget_elements();
    return builder_.finish();
  }

 private:
  void take_atom() {
    const std::string_view line = lines_.line();
    if (width_ == 0) width_ = width_of_coordinates();
    std::array<std::string_view, 3> fields;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      fields[axis] = columns(line, kFirstColumn + axis * width_, width_);
      if (columns(line, kFirstPoint + axis * width_, 1) != ".") refuse_columns();
    }
    const ResidueLabel residue{"", trimmed(line.substr(5, 5)), trimmed(line.substr(0, 5))};
    if (!whole_number(residue.number))
      lines_.refuse(fmt::format("{} in columns 1-5 is no residue number; .gro has fixed columns",
                                in_quotes(residue.number)));
    AtomRecord& atom =
        builder_.add(residue, lines_.position_in(fields[0], fields[1], fields[2]), lines_.number());
    atom.name = trimmed(line.substr(10, 5));
    atom.serial = whole_number(line.substr(15, 5)).value_or(atom.serial);
    read_element("", atom.name, NamePlace::word, residue.name, atom);
    is_coarse_grained_ |= is_martini_bead(atom.name, residue.name);
  }

  std::size_t width_of_coordinates() const {
    const std::string_view line = lines_.line();
    const std::size_t second = line.find('.', kFirstPoint + 1);
    if (columns(line, kFirstPoint, 1) != "." || second == line.npos) refuse_columns();
    return second - kFirstPoint;
  }

  [[noreturn]] void refuse_columns() const {
    lines_.refuse(
        ".gro needs x, y and z in fixed columns from 21 on, with decimal points that are equally "
        "far apart in all lines of a frame");
  }

  // The line behind the atoms, from number `first` on, of this frame.
  void take_box(std::size_t first) {
    if (lines_.is_at_end() || !lines_.next()) {
      builder_.file().warnings.push_back(
          "there is no box behind the last atom: the file may have been cut off");
      return;
    }
    const std::vector<std::string_view> words = split_at_blanks(lines_.line());
    const bool are_numbers = std::all_of(words.begin(), words.end(), [](std::string_view word) {
      return finite_number(word).has_value();
    });
    if (!are_numbers || (words.size() != 3 && words.size() != 9))
      lines_.refuse(
          "the box, 3 or 9 numbers, should stand here: are there more atoms than the second line "
          "of the frame says?");
    const Vec3d box = lines_.position_in(words[0], words[1], words[2]);
    if (std::min({box.x, box.y, box.z}) <= 0) return;
    if (!has_box_)
      builder_.file().notes.push_back(fmt::format(
          "the periodic box of {} is not applied: molecules that it cuts are measured in pieces",
          fmt::join(words.begin(), words.begin() + 3, " × ")));
    has_box_ = true;
    count_broken(first, box);
  }

  // Counts residues of which the box has moved atoms to its other side. Those of water are left
  // out, since nearly all files have some, and few measure them.
  void count_broken(std::size_t first, const Vec3d& box) {
    const std::vector<AtomRecord>& atoms = builder_.file().atoms;
    const std::vector<gemmi::Chain>& chains = builder_.file().structure->models.back().chains;
    if (chains.empty()) return;
    std::size_t end = first;
    for (const gemmi::Residue& residue : chains.front().residues) {
      const std::size_t begin = end;
      while (end < atoms.size() && atoms[end].residue == atoms[begin].residue) ++end;
      if (is_named_as_water(upper_case(residue.name))) continue;
      for (int axis = 0; axis < 3; ++axis) {
        const auto [low, high] =
            std::minmax_element(atoms.begin() + static_cast<std::ptrdiff_t>(begin),
                                atoms.begin() + static_cast<std::ptrdiff_t>(end),
                                [axis](const AtomRecord& a, const AtomRecord& b) {
                                  return a.position[axis] < b.position[axis];
                                });
        if (high->position[axis] - low->position[axis] <= box[axis] / 2) continue;
        ++broken_;
        break;
      }
    }
  }

  // Beads have no elements, and one of them tells that all are beads.
  void forget_elements() {
    builder_.file().coarse_grained = true;
    for (AtomRecord& atom : builder_.file().atoms) {
      atom.element = gemmi::El::X;
      atom.element_guessed = true;
      atom.is_virtual = false;
    }
  }

  NumberedLines lines_;
  StructureBuilder builder_;
  std::size_t width_ = 0;   // columns of a coordinate; 0 before the first atom of a frame
  std::size_t broken_ = 0;  // residues
  bool has_box_ = false, is_coarse_grained_ = false;
};

}  // namespace

ParsedFile parse_gro(std::string_view text, const std::string& path, Monitor* monitor) {
  return GroReader(text, path, monitor).run();
}

}  // namespace vdwmesh
