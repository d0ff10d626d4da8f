// Reads PDB files: normalises the text and hands the result to gemmi's parser.
//
// gemmi expects records that follow the format strictly. Real files do not: old files carry entry
// ids in columns 73-80, simulation programs leave out elements, models have no end, serial numbers
// pass 99,999. Therefore:
// 1. layout_of() scans the file once and finds out how it uses the disputed columns.
// 2. Normaliser rewrites each record that gemmi needs, and checks it with messages that name the
//    line. It renumbers atoms from 0, so that gemmi::Atom::serial is the index of an AtomRecord.
// 3. gemmi parses the rewritten text, the models get the names that the file gives them, and the
//    AtomRecords what gemmi has read.
// REMARK 350 (assemblies) does not go to gemmi but to BiomoleculeReader.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <gemmi/pdb.hpp>
#include <map>
#include <optional>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/biomolecules.hpp"
#include "structure/elements.hpp"
#include "structure/hierarchy.hpp"
#include "structure/lines.hpp"
#include "structure/parsed_file.hpp"
#include "structure/pdb_records.hpp"
#include "structure/residue_elements.hpp"
#include "structure/standard_names.hpp"

namespace vdwmesh {
namespace {

// The rewritten text must hold every number in the columns that gemmi reads. Models have four
// columns. Atoms have five columns of hybrid-36 (see serial_number() below), of which only the
// capitals are used: the values from 0 to 100,000 + 26 * 36^4 - 1, which is kMaxAtoms.
constexpr std::size_t kMaxModels = 9999;
constexpr std::uint64_t kMaxAtoms = 43'770'015;
// Columns count from 0, while the manual of the format counts them from 1.
constexpr std::size_t kFourthLetter = 20;   // of a residue name, or blank
constexpr std::size_t kTagColumn = 72;      // entry tag or segment id
constexpr std::size_t kChargeColumn = 70;   // of PDBQT
constexpr std::size_t kElementColumn = 76;  // two columns, right-aligned
constexpr std::size_t kLastColumn = 78;     // end of the element; the charge behind it is not used
// Residue names of four letters for gemmi; see four_columns_of().
constexpr char kWideName = '\1';
constexpr std::size_t kDigits = 94;  // the printable characters
constexpr std::string_view kDigits36 = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ";

// Whether the eight characters from column 73 on are the entry tag of files from before 1996: the
// entry id, possibly a revision letter, and the line number ("4PTI  75", "4INSB 12", "1ABC1234").
bool is_entry_tag(std::string_view tag) {
  if (tag.size() < 8 || !is_digit(tag[0]) || !is_digit(tag[7])) return false;
  const auto id = tag.substr(1, 3), number = tag.substr(5, 3);
  return std::all_of(id.begin(), id.end(), [](char c) { return is_digit(c) || is_letter(c); }) &&
         std::all_of(number.begin(), number.end(), [](char c) { return is_digit(c) || c == ' '; });
}

// How the file uses the columns on which programs disagree.
struct Layout {
  bool entry_tags = false;     // columns 73-80 hold entry tags, so there is no element in them
  bool names_at_left = false;  // atom names begin in column 13 even if the element has one letter
  bool pdbqt = false;          // AutoDock's: a charge in columns 71-76, the atom type from 78 on
  bool beads = false;          // the atoms are beads of a coarse-grained (Martini) model
  bool wide_names = false;     // residue names may have four letters, to column 21
};

// Whether the name, without blanks, is C, N, O or P with nothing but digits behind it.
bool is_short_name(std::string_view name) {
  return !name.empty() && std::string_view("CNOP").find(name[0]) != std::string_view::npos &&
         std::all_of(name.begin() + 1, name.end(), is_digit);
}

// Whether columns 71-76 hold a number with three digits behind its point.
bool has_charge(std::string_view line) {
  const std::string_view charge = columns(line, kChargeColumn, 6);
  return charge.size() == 6 && charge[2] == '.' && finite_number(charge);
}

// Whether column 21, which has no use in the format, holds the fourth letter of a residue name
// ("POPE" and "NALA" of CHARMM and AMBER), rather than the first of a chain id of two. Positive for
// a name, negative for a chain id, 0 if the line alone cannot tell.
int vote_for_wide_names(std::string_view line) {
  const std::string_view four = columns(line, 17, 4), three = columns(line, 17, 3);
  const std::string name = upper_case(trimmed(four)), shorter = upper_case(trimmed(three));
  const auto is_known = [](const std::string& residue) {
    return is_standard_residue(residue) || standard_residue_name(residue) == "HOH" ||
           residue == "HOH";
  };
  if (is_known(name) && is_known(shorter)) return 0;  // "HISA" of GROMOS, or HIS of a chain "AA"
  if (is_known(name)) return 1;
  if (is_known(shorter) || four[0] == ' ' || three.find(' ') != std::string_view::npos) return -1;
  return 1;
}

// Looks at all atom records of the file. Single records are ambiguous, so the majority decides:
// names are at the left if more names such as N, C1, O or P begin in column 13 than in column 14,
// where the format puts elements of one letter. Entry tags must show one and the same entry id in
// more than half of the atoms; a single match could be chance. One bead is enough for `beads`,
// because no real atom has the name of a bead.
Layout layout_of(std::string_view text) {
  Layout layout;
  std::size_t atoms = 0, aligned = 0, at_left = 0, charges = 0;
  std::int64_t wide = 0;                           // votes for wide names, less those against them
  bool in_use = false;                             // whether column 21 holds anything
  std::map<std::string_view, std::size_t> tagged;  // atoms with an entry tag, by entry id
  std::string_view line;
  while (next_line(text, line)) {
    if (!is_atom_record(line)) continue;
    ++atoms;
    const std::string_view tag = columns(line, kTagColumn, 8), name = columns(line, 12, 4);
    if (line.size() > kFourthLetter && line[kFourthLetter] != ' ') {
      wide += vote_for_wide_names(line);
      in_use = true;
    }
    if (is_entry_tag(tag)) ++tagged[tag.substr(0, 4)];
    layout.beads = layout.beads || is_martini_bead(name, columns(line, 17, 3));
    if (is_short_name(trimmed(name)) && name.size() == 4) ++(name[0] != ' ' ? at_left : aligned);
    charges += has_charge(line) ? 1 : 0;
  }
  layout.pdbqt = 2 * charges > atoms;
  layout.names_at_left = at_left > aligned;
  layout.wide_names = wide > 0 || (wide == 0 && in_use);
  layout.entry_tags = std::any_of(tagged.begin(), tagged.end(),
                                  [atoms](const auto& entry) { return 2 * entry.second > atoms; });
  return layout;
}

// Reads a serial number in hybrid-36 (R. W. Grosse-Kunstleve, cci.lbl.gov/hybrid_36), which extends
// five decimal columns: 0 to 99999 as usual, then A0000 to ZZZZZ and a0000 to zzzzz in base 36. The
// letters continue the count, so A0000 is 100,000 and a0000 is 100,000 + 26 * 36^4.
std::optional<std::int64_t> serial_number(std::string_view field) {
  const std::string_view digits = trimmed(field);
  if (digits.size() == 5 && is_letter(digits[0])) {
    // What to add to the value in base 36. from_chars() reads capitals and small letters alike, so
    // A0000 and a0000 both are 10 * 36^4 there.
    constexpr std::int64_t kUpper = 100'000 - std::int64_t{10} * 36 * 36 * 36 * 36;
    constexpr std::int64_t kLower = kUpper + std::int64_t{26} * 36 * 36 * 36 * 36;
    std::int64_t value = 0;
    const bool lower = std::islower(static_cast<unsigned char>(digits[0])) != 0;
    const char* begin = digits.data();
    const auto [end, error] = std::from_chars(begin, begin + 5, value, 36);
    if (error != std::errc() || end != begin + 5) return std::nullopt;
    return value + (lower ? kLower : kUpper);
  }
  return whole_number(digits);
}

// Writes an index as a serial number in hybrid-36: the inverse of serial_number() for capitals.
std::string five_columns(std::uint64_t index) {
  std::string field(5, ' ');
  if (index < 100'000) {
    std::size_t place = field.size();
    do {
      field[--place] = kDigits36[index % 10];
    } while ((index /= 10) != 0);
    return field;
  }
  std::uint64_t rest = index - 100'000 + std::uint64_t{10} * 36 * 36 * 36 * 36;
  for (std::size_t i = field.size(); i-- > 0; rest /= 36) field[i] = kDigits36[rest % 36];
  return field;
}

// The symbol of an atom type of AutoDock: A is carbon, and a capital A, D or S behind N, O, S or H
// says something of hydrogen bonds. The carbons that close rings are CG0, CG1 and so on.
std::string_view symbol_of_autodock(std::string_view type) {
  if (type == "A" || type.starts_with("CG")) return "C";
  const bool marked = type.size() == 2 && std::string_view("NOSH").find(type[0]) != type.npos &&
                      std::string_view("ADS").find(type[1]) != type.npos;
  return marked ? type.substr(0, 1) : type;
}

// Whether the text is the symbol of two letters by which the name begins.
bool is_symbol_of(std::string_view text, std::string_view name) {
  return text.size() == 2 && is_letter(text[0]) && is_letter(text[1]) &&
         element_of_symbol(text) != std::string_view("X") &&
         upper_case(trimmed(name)).starts_with(upper_case(text));
}

// Rewrites the text of a PDB file for gemmi, and collects what gemmi does not take: an AtomRecord
// for each atom, the names of the models, and the assemblies. Call run() once, then the accessors.
class Normaliser {
 public:
  Normaliser(std::string_view text, const std::string& path)
      : path_(path), rest_(text), layout_(layout_of(text)) {}

  void run(Monitor* monitor) {
    // Short records grow when they are padded; an eighth more avoids most reallocations.
    text_.reserve(rest_.size() + rest_.size() / 8);
    std::string_view line;
    for (number_ = 1; next_line(rest_, line); ++number_) {
      if (number_ % kLinesPerCheck == 0) advance(monitor, 0);
      take(line);
    }
    if (atoms_.empty())
      throw FileFormatError(path_ + ": has no ATOM or HETATM record, so there is nothing to mesh");
  }

  const std::string& text() const { return text_; }
  std::vector<AtomRecord> take_atoms() { return std::move(atoms_); }
  AssemblyTables take_assemblies() { return biomolecules_.finish(); }
  bool coarse_grained() const { return layout_.beads; }
  bool elements_in_doubt() const { return in_doubt_; }
  const std::vector<std::string>& model_names() const { return models_.names(); }

  // Gives the residues that gemmi has read from text() their names of four letters.
  void restore_names(gemmi::Structure& structure) const {
    for (const ResiduePlace& place : numbered_residues(structure)) {
      std::string& name = place.residue->name;
      if (name.size() != 3 || name[0] != kWideName) continue;
      const auto digit = [&name](std::size_t i) { return static_cast<std::size_t>(name[i] - '!'); };
      name = wide_names_.at(digit(1) * kDigits + digit(2));
    }
  }

 private:
  // Handles one line. TER and SEQRES are passed on because gemmi derives entity types (polymer,
  // ligand) from them, and selections can name these types; what stands behind column 72 may be an
  // entry tag and is cut off. open_model() writes MODEL and ENDMDL records anew. All other records
  // are left out.
  void take(std::string_view line) {
    if (is_atom_record(line)) {
      take_atom(line);
    } else if (models_.take(line)) {
      return;
    } else if (is_record(line, "TER") || starts_with_record(line, "SEQRES")) {
      text_.append(line.substr(0, kTagColumn)).append("\n");
    } else if (starts_with_record(line, "REMARK 350")) {
      biomolecules_.take(line.substr(0, kTagColumn), number_);
    } else if (line.starts_with(' ') && is_atom_record(trimmed(line))) {
      refuse("an atom's record begins behind a blank; it belongs in column 1");
    }
  }

  // Begins a model in the rewritten text, before its first atom. The models are numbered from 1,
  // because files leave numbers out or repeat them, and gemmi refuses repeated numbers.
  void open_model() {
    const std::size_t count = models_.names().size();
    if (count > kMaxModels)
      refuse(fmt::format("more than {} models; cut the file into smaller ones", kMaxModels));
    if (count > 1) text_ += "ENDMDL\n";
    text_ += fmt::format("MODEL     {:4}\n", count);
  }

  // Checks an atom record, rewrites it to exactly kLastColumn columns, and adds its AtomRecord. A
  // serial number that cannot be read is replaced by the number of the atom in the file, from 1.
  void take_atom(std::string_view line) {
    if (models_.begins_model()) open_model();
    if (atoms_.size() >= kMaxAtoms)
      refuse(fmt::format("more than {} atoms; write it as mmCIF", kMaxAtoms));
    check_coordinates(line);
    const std::size_t begin = text_.size();
    const std::string_view symbol = symbol_field(line);
    text_.append(line.substr(0, width_of(line, symbol)));
    text_.resize(begin + kLastColumn, ' ');
    const std::string_view record = std::string_view(text_).substr(begin);
    const auto replace = [&](std::size_t column, std::string_view field) {
      field.copy(text_.data() + begin + column, field.size());
    };
    AtomRecord atom;
    atom.line = number_;
    atom.hetero = starts_with_record(line, "HETATM");
    atom.serial =
        serial_number(columns(record, 6, 5)).value_or(static_cast<std::int64_t>(atoms_.size()) + 1);
    replace(0, atom.hetero ? "HETATM" : "ATOM  ");
    replace(6, five_columns(atoms_.size()));
    const std::string residue(trimmed(columns(record, 17, layout_.wide_names ? 4 : 3)));
    if (layout_.wide_names) replace(17, four_columns_of(residue));
    if (is_decimal(columns(record, kTagColumn, 4))) replace(kTagColumn, "    ");
    // gemmi reads a blank occupancy as 0; the atom is meant to be there in full.
    if (trimmed(columns(record, 54, 6)).empty()) replace(54, "  1.00");
    set_element(symbol, record, residue, atom);
    const std::string_view element = gemmi::element_name(atom.element);
    replace(kElementColumn, "  ");
    replace(kLastColumn - element.size(), element);
    atoms_.push_back(atom);
    text_ += '\n';
  }

  // How many columns of the record gemmi may see. An entry tag would be read as an element, and a
  // charge or a symbol too far to the left as a segment.
  std::size_t width_of(std::string_view line, std::string_view symbol) const {
    if (layout_.pdbqt) return kChargeColumn - 4;
    if (layout_.entry_tags) return kTagColumn;
    return symbol.data() < line.data() + kElementColumn ? kElementColumn - 1 : kLastColumn;
  }

  // The symbol of the element. It belongs in columns 77-78. A symbol of two letters that stands one
  // column further left or right is read there if the name begins by it.
  std::string_view symbol_field(std::string_view line) const {
    if (layout_.entry_tags || line.size() <= kElementColumn) return line.substr(line.size());
    if (layout_.pdbqt) return symbol_of_autodock(trimmed(columns(line, kElementColumn, 4)));
    const bool is_one_letter = line[kElementColumn] == ' ' && line.size() > kElementColumn + 1 &&
                               is_letter(line[kElementColumn + 1]) &&
                               (line.size() == kLastColumn || !is_letter(line[kLastColumn]));
    if (is_one_letter) return line.substr(kElementColumn + 1, 1);
    const std::string_view name = columns(line, 12, 4);
    const bool ends_early = line[kElementColumn - 2] == ' ',
               begins_late = line[kElementColumn] == ' ';
    const std::string_view left = columns(line, kElementColumn - 1, 2),
                           right = columns(line, kElementColumn + 1, 2);
    if (ends_early && trimmed(columns(line, kElementColumn, 2)).size() == 1 &&
        line[kElementColumn] != ' ' && is_symbol_of(left, name))
      return left;
    return begins_late && is_symbol_of(right, name) ? right
                                                    : trimmed(columns(line, kElementColumn, 2));
  }

  // Beads have no element.
  void set_element(std::string_view symbol, std::string_view record, std::string_view residue,
                   AtomRecord& atom) {
    atom.element = gemmi::find_element(element_of_symbol(symbol));
    if (layout_.beads) {
      atom.element_guessed = atom.element == gemmi::El::X;
      return;
    }
    read_element(symbol, columns(record, 12, 4),
                 layout_.names_at_left ? NamePlace::word : NamePlace::columns, residue, atom);
    in_doubt_ |= atom.element_guessed || atom.symbol_overruled || atom.is_virtual ||
                 atom.element == gemmi::El::D;
  }

  // A residue name for gemmi, which reads three columns: a longer one is replaced by a number of
  // two digits behind a character that no name has. restore_names() takes it back.
  std::string four_columns_of(const std::string& residue) {
    if (residue.size() < 4) return fmt::format("{:<4}", residue);
    const auto [name, is_new] = wide_numbers_.try_emplace(residue, wide_names_.size());
    if (is_new) wide_names_.push_back(residue);
    if (name->second >= kDigits * kDigits)
      refuse(fmt::format("more than {} residue names of four letters", kDigits * kDigits));
    const auto digit = [](std::size_t value) { return static_cast<char>('!' + value); };
    return {kWideName, digit(name->second / kDigits), digit(name->second % kDigits), ' '};
  }

  // A number with a point is a charge or a factor, and no segment id.
  static bool is_decimal(std::string_view field) {
    return field.find('.') != std::string_view::npos && finite_number(field).has_value();
  }

  // gemmi reads whatever digits it finds, so shifted columns would become a wrong position.
  void check_coordinates(std::string_view line) const {
    static constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const std::size_t first = 30 + 8 * axis;
      const std::string_view field = columns(line, first, 8);
      if (finite_number(field)) continue;
      refuse(
          fmt::format("{} in columns {}-{} is {}, not a finite number; "
                      "PDB needs fixed columns (whitespace-separated: --format pqr or xyzr)",
                      kAxes[axis], first + 1, first + 8, in_quotes(field)));
    }
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw FileFormatError(fmt::format("{}:{}: {}", path_, number_, what));
  }

  std::string path_;
  std::string_view rest_;  // the lines that are still to be read
  Layout layout_;
  std::string text_;          // the rewritten file
  std::uint32_t number_ = 0;  // of the current line, from 1
  bool in_doubt_ = false;     // as in ParsedFile
  ModelRecords models_;
  std::vector<AtomRecord> atoms_;
  BiomoleculeReader biomolecules_;
  std::vector<std::string> wide_names_;              // of four letters
  std::map<std::string, std::size_t> wide_numbers_;  // their indices
};

}  // namespace

ParsedFile parse_pdb(std::string_view text, const std::string& path, Monitor* monitor) {
  Normaliser normaliser(text, path);
  normaliser.run(monitor);
  ParsedFile file;
  try {
    file.structure = std::make_shared<gemmi::Structure>(
        gemmi::read_pdb_from_memory(normaliser.text().data(), normaliser.text().size(), path));
  } catch (const std::runtime_error& error) {
    throw FileFormatError(fmt::format("{}: {}", path, one_line(error.what())));
  }
  for (std::size_t i = 0; i < file.structure->models.size(); ++i)
    file.structure->models[i].name = normaliser.model_names().at(i);
  normaliser.restore_names(*file.structure);
  file.atoms = normaliser.take_atoms();
  take_gemmi_atoms(file);
  file.assemblies = normaliser.take_assemblies();
  file.path = path;
  file.format = "pdb";
  file.coarse_grained = normaliser.coarse_grained();
  file.elements_in_doubt = normaliser.elements_in_doubt();
  return file;
}

}  // namespace vdwmesh
