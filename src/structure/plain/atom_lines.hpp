// What the readers of formats with an atom in each line share: lines with their numbers, and the
// ParsedFile that grows by an atom at a time. Internal header of this folder and of `read`.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/vec3.hpp"
#include "structure/read/parsed_file.hpp"

namespace gemmi {
struct Chain;
}

namespace vdwmesh {

// The lines of a text, one after another. The text and the path must outlive it.
class NumberedLines {
 public:
  NumberedLines(std::string_view text, const std::string& path, Monitor* monitor)
      : rest_(text), path_(path), monitor_(monitor) {}

  // Goes to the next line; false behind the last one. Asks the monitor now and then.
  bool next();
  // The same where there must be one. Throws FileFormatError where there is none; `what` is what
  // the line should hold.
  std::string_view expect(std::string_view what);
  // Whether only white space is left.
  bool is_at_end() const;

  std::string_view line() const { return line_; }
  std::uint32_t number() const { return number_; }  // of the line, from 1; 0 before the first
  const std::string& path() const { return path_; }

  // Throws FileFormatError, with the path and the number of the line.
  [[noreturn]] void refuse(const std::string& what) const;
  // The field as a whole number that is not negative; throws where it is none. `what` is its name.
  std::uint64_t count_in(std::string_view field, std::string_view what) const;
  // Three fields as a position; throws where one is no finite number.
  Vec3d position_in(std::string_view x, std::string_view y, std::string_view z) const;

 private:
  std::string_view rest_, line_;
  const std::string& path_;
  Monitor* monitor_;
  std::uint32_t number_ = 0;
};

// The residue of an atom, as the file calls it. `number` may end with an insertion code.
struct ResidueLabel {
  std::string_view chain, name, number;
  bool hetero = false;
};

// Builds the ParsedFile atom by atom. A new chain begins when the chain id changes, and a new
// residue when the chain, the residue's number or its name changes.
class StructureBuilder {
 public:
  StructureBuilder(const std::string& path, const char* format);

  // Call this before the first atom of each model. No two may have one name.
  void begin_model(const std::string& name);

  // Adds an atom without element. Its serial number is its place in the file, from 1.
  AtomRecord& add(const ResidueLabel& residue, const Vec3d& position, std::uint32_t line);

  ParsedFile& file() { return file_; }
  // Throws FileFormatError if the file has no atoms.
  ParsedFile finish();

 private:
  std::uint32_t enter_residue(const ResidueLabel& residue);

  ParsedFile file_;
  std::uint32_t residues_ = 0;     // begun so far
  gemmi::Chain* chain_ = nullptr;  // the current chain; null at the beginning of a model
  std::string number_;             // of the current residue, as in the file
};

// The residue to which atoms belong in formats that have none.
inline constexpr ResidueLabel kOnlyResidue{"A", "UNL", "1"};

// Decides atom.element by a symbol, in formats that have no other names, and calls the atom by it.
// Digits and a charge may stand behind the symbol. Signs for any atom, as "X", "Q" and "R#", leave
// the element unknown. Throws FileFormatError for a word that is no symbol, and for one that may as
// well be a name: "CA" in capitals, which is no calcium where names stand.
void read_symbol(std::string_view word, const NumberedLines& at, AtomRecord& atom);

}  // namespace vdwmesh
