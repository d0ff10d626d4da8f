// Reads PQR files: ATOM and HETATM records like those of PDB, whose last fields are charge and
// radius (PDB2PQR, APBS). Fields are separated by blanks, but some programs write fixed columns,
// where neighbouring fields may touch; add_pqr_record() reads both. gemmi has no parser for the
// format.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <gemmi/model.hpp>
#include <span>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/plain/atom_lines.hpp"
#include "structure/read/lines.hpp"
#include "structure/read/parsed_file.hpp"
#include "structure/read/pdb_records.hpp"

namespace vdwmesh {
namespace {

// The contents of one line. The views point into the text of the file. `number` is the residue's
// number, and `residue` its name.
struct PqrRow {
  std::array<double, 3> position{};  // Å
  double radius = 0;                 // Å
  std::string_view serial, name, residue, chain, number;
  bool hetero = false;
};

[[noreturn]] void refuse(const std::string& path, std::uint32_t line, const std::string& what) {
  throw FileFormatError(fmt::format("{}:{}: {}", path, line, what));
}

bool is_number(std::string_view field) { return finite_number(field).has_value(); }

// Whether the field is a whole number, with at most one letter behind it for the insertion code.
bool is_residue_number(std::string_view field) {
  if (!field.empty() && is_letter(field.back())) field.remove_suffix(1);
  return whole_number(field).has_value();
}

// The columns of a program that writes PQR with fixed ones, where neighbouring fields may touch.
// The residue's name has as many columns as no other field claims.
struct PqrColumns {
  std::size_t residue, chain, number, number_width;
  std::array<std::size_t, 3> position;  // first columns of x, y and z, each of eight columns
};
constexpr std::size_t kCoordinateWidth = 8, kDecimals = 3;
constexpr std::array kLayouts{
    PqrColumns{16, 21, 22, 5, {30, 38, 46}},   // PDB's, as PDB2PQR, AMBER and MEAD write them
    PqrColumns{16, 20, 21, 4, {26, 35, 44}}};  // of GROMACS

// Reads the names of the row by columns, and puts x, y, z and the fields behind them into
// `numbers`. False if the line does not keep to the layout: the coordinates must be numbers of
// three decimals in their columns, only blanks may stand between them and the residue's number, and
// no name may have a blank in it, as pieces of two words have.
bool take_columns(std::string_view line, const PqrColumns& layout, PqrRow& row,
                  std::vector<std::string_view>& numbers) {
  numbers.clear();
  for (const std::size_t first : layout.position) {
    const std::string_view field = columns(line, first, kCoordinateWidth);
    if (field.size() < kCoordinateWidth || field[kCoordinateWidth - kDecimals - 1] != '.' ||
        !is_number(field))
      return false;
    numbers.push_back(trimmed(field));
  }
  const std::size_t behind = layout.number + layout.number_width;
  if (!trimmed(columns(line, behind, layout.position[0] - behind)).empty()) return false;
  row.number = trimmed(columns(line, layout.number, layout.number_width));
  row.name = trimmed(columns(line, 12, 4));
  if (row.name.empty() || !is_residue_number(row.number)) return false;
  row.serial = columns(line, 6, 5);
  row.residue = trimmed(columns(line, layout.residue, layout.chain - layout.residue));
  if (row.name.find(' ') != std::string_view::npos ||
      row.residue.find(' ') != std::string_view::npos)
    return false;
  row.chain = trimmed(columns(line, layout.chain, 1));
  const std::size_t end = layout.position[2] + kCoordinateWidth;
  for (const std::string_view field : split_at_blanks(columns(line, end, line.size())))
    numbers.push_back(field);
  return true;
}

// The fields between blanks: record, serial, name, residue and what follows. The serial number may
// touch the record's name.
std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words = split_at_blanks(line);
  const std::size_t name = starts_with_record(line, "HETATM") ? 6 : 4;
  if (words[0].size() > name) {
    words.insert(words.begin() + 1, words[0].substr(name));
    words[0] = words[0].substr(0, name);
  }
  return words;
}

// The index of the residue's number among the words. Five numbers stand behind it. A chain may
// stand before it, as one word or as a letter that touches the number ("A1000"). Of lines that fit
// neither way the number of words decides, and the checks of the caller name the word at fault.
std::size_t place_of_number(const std::vector<std::string_view>& words) {
  const auto fits = [&words](std::size_t place) {
    if (words.size() < place + 6) return false;
    std::string_view number = words[place];
    if (place == 4 && is_letter(number.front())) number.remove_prefix(1);
    return is_residue_number(number) &&
           std::all_of(words.begin() + static_cast<std::ptrdiff_t>(place) + 1,
                       words.begin() + static_cast<std::ptrdiff_t>(place) + 6, is_number);
  };
  const bool has_long_number = words[4].size() > 1 && whole_number(words[4]);
  if (!has_long_number && fits(5)) return 5;
  return fits(4) || words.size() == 10 ? 4 : 5;
}

// The same for fields that are separated by blanks, in any columns.
void take_words(std::string_view line, PqrRow& row, std::vector<std::string_view>& numbers,
                const std::string& path, std::uint32_t number) {
  const std::vector<std::string_view> words = words_of(line);
  if (words.size() < 10)
    refuse(path, number,
           fmt::format("has {} fields; PQR needs at least 10: ATOM serial name "
                       "residue [chain] number x y z charge radius",
                       words.size()));
  const std::size_t place = place_of_number(words);
  row.serial = words[1];
  row.name = words[2];
  row.residue = words[3];
  row.number = words[place];
  row.chain = place == 5 ? words[4] : std::string_view();
  if (place == 4 && is_letter(row.number.front())) {
    row.chain = row.number.substr(0, 1);
    row.number.remove_prefix(1);
  }
  numbers.assign(words.begin() + static_cast<std::ptrdiff_t>(place) + 1, words.end());
  if (!is_residue_number(row.number))
    refuse(path, number,
           fmt::format("{} stands where the residue number should be: a field is missing{}",
                       in_quotes(words[place]), words.size() > 10 ? ", or one too many" : ""));
}

// What the records of a PQR file tell together.
class PqrAccount {
 public:
  explicit PqrAccount(const std::string& path) : path_(path) {}

  // `more` are the fields behind the radius. Programs write the element there, which is no news.
  void add(const PqrRow& row, double charge, const char* element, std::uint32_t line,
           std::span<const std::string_view> more) {
    if (more.size() > 1 || (more.size() == 1 && upper_case(more[0]) != upper_case(element)))
      note(more_, line, more[0]);
    static constexpr std::string_view kSized = " C N O S P ";
    if (kSized.find(fmt::format(" {} ", element)) == kSized.npos) return;
    ++(row.radius < kLeastRadius && charge >= kLeastRadius ? swapped_ : ordered_);
  }
  // A line that is no record of an atom.
  void pass_over(std::string_view text, std::uint32_t line) {
    static constexpr std::string_view kKnown =
        " REMARK TER HEADER TITLE COMPND SOURCE KEYWDS EXPDTA AUTHOR REVDAT JRNL CRYST1 CONECT "
        "MASTER SEQRES HET HETNAM FORMUL HELIX SHEET SSBOND LINK CISPEP SITE ANISOU DBREF NUMMDL ";
    text = trimmed(text);
    const std::string word = upper_case(text.substr(0, text.find(' ')));
    static constexpr std::string_view kComments = "#;*!";
    const bool is_known =
        text.empty() || kComments.find(text[0]) != kComments.npos || is_record(text, "TER") ||
        is_record(text, "REMARK") || is_record(text, "CONECT") || is_record(text, "ORIGX") ||
        is_record(text, "SCALE") || kKnown.find(fmt::format(" {} ", word)) != kKnown.npos;
    if (!is_known) note(others_, line, text);
  }

  // Throws if radii and charges look swapped. Returns what the user should know of.
  std::vector<std::string> warnings() const {
    if (swapped_ > 0 && ordered_ == 0)
      throw FileFormatError(fmt::format(
          "{}: its columns look swapped: as PQR has them, x y z charge radius, all atoms of C, N, "
          "O, S and P have charges of at least 1 and radii below 1; let the charge stand first",
          path_));
    std::vector<std::string> found;
    if (others_.count > 0)
      found.push_back(
          fmt::format("lines that are no records of PQR were passed over: {}, of which "
                      "line {} is the first: {}",
                      others_.count, others_.line, others_.text));
    if (more_.count > 0)
      found.push_back(
          fmt::format("fields behind the radius were not read, of {} atoms, of which line {} is "
                      "the first: {}",
                      more_.count, more_.line, more_.text));
    return found;
  }

 private:
  // No atom of these elements has a smaller radius, in Å, nor have all of them such charges, in e.
  static constexpr double kLeastRadius = 1;

  struct Lines {
    std::size_t count = 0;
    std::uint32_t line = 0;  // the first
    std::string text;
  };
  static void note(Lines& lines, std::uint32_t line, std::string_view text) {
    if (lines.count++ == 0) lines.line = line, lines.text = in_quotes(text);
  }

  const std::string& path_;
  std::size_t swapped_ = 0, ordered_ = 0;  // atoms
  Lines others_, more_;
};

// Reads one record: ATOM serial name residue [chain] number x y z charge radius. `line` is that of
// the file.
void add_pqr_record(std::string_view record, std::uint32_t line, const std::string& path,
                    StructureBuilder& builder, PqrAccount& account) {
  static constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  PqrRow row;
  std::vector<std::string_view> numbers;
  const bool is_aligned =
      std::any_of(kLayouts.begin(), kLayouts.end(), [&](const PqrColumns& layout) {
        return take_columns(record, layout, row, numbers) && numbers.size() >= 5;
      });
  if (!is_aligned) take_words(record, row, numbers, path, line);
  row.hetero = starts_with_record(record, "HETATM");
  const double charge = number_or_refuse(numbers[3], "the charge", path, line);
  for (std::size_t axis = 0; axis < 3; ++axis)
    row.position[axis] = number_or_refuse(numbers[axis], kAxes[axis], path, line);
  row.radius = number_or_refuse(numbers[4], "the radius", path, line);
  if (row.radius < 0)
    refuse(path, line,
           fmt::format("the radius is {}; it cannot be negative. Do charge and radius stand in "
                       "swapped columns? PQR has x y z charge radius",
                       row.radius));
  const char* element = element_of_bare_name(row.name, row.residue);
  account.add(row, charge, element, line, std::span(numbers).subspan(5));
  AtomRecord& atom = builder.add({row.chain, row.residue, row.number, row.hetero},
                                 {row.position[0], row.position[1], row.position[2]}, line);
  atom.name = row.name;
  atom.element = gemmi::find_element(element);
  atom.serial = whole_number(row.serial).value_or(atom.serial);
  atom.radius = row.radius;
  atom.element_guessed = true;
}

// Whether the line has an occupancy and a temperature factor in the columns of PDB, each with the
// two decimals that PDB prescribes.
bool has_pdb_factors(std::string_view line) {
  const auto has_two_decimals = [](std::string_view field) {
    return field.size() == 6 && field[3] == '.' && is_number(field);
  };
  return has_two_decimals(columns(line, 54, 6)) && has_two_decimals(columns(line, 60, 6));
}

// Throws if the text is a PDB file under the name of a PQR file: its occupancies would be read as
// charges and its temperature factors as radii. A file counts as PDB if every atom record has both,
// and some factor is positive, and in addition every record has an element in columns 77-78 or some
// factor is too large for the radius of an atom.
void refuse_pdb(std::string_view text, const std::string& path) {
  constexpr double kLargestOfAtoms = 5;  // Å; no atom has more: caesium, the largest, has 3.5
  bool pdb = true, elements = true;      // all records so far have both factors; have elements
  double largest = 0;                    // temperature factor, which would be a radius in Å
  std::string_view line;
  while (pdb && next_line(text, line)) {
    if (!is_atom_record(line)) continue;
    pdb = has_pdb_factors(line);
    elements = elements && !trimmed(columns(line, 76, 2)).empty();
    if (pdb) largest = std::max(largest, *finite_number(columns(line, 60, 6)));
  }
  if (pdb && largest > 0 && (elements || largest > kLargestOfAtoms))
    throw FileFormatError(path +
                          ": holds PDB, not PQR: where the radii should be, its atoms have "
                          "temperature factors; rename it to .pdb or say --format pdb");
}

}  // namespace

ParsedFile parse_pqr(std::string_view text, const std::string& path) {
  StructureBuilder builder(path, "pqr");
  builder.file().own_radii = true;
  PqrAccount account(path);
  refuse_pdb(text, path);
  ModelRecords models;
  std::string_view line;
  for (std::uint32_t number = 1; next_line(text, line); ++number) {
    // take() is true for records that separate models; they need nothing else.
    if (models.take(trimmed(line))) continue;
    // Blanks before the record name are harmless here, unlike in PDB files with fixed columns.
    if (is_atom_record(trimmed(line)) && !is_atom_record(line)) line = trimmed(line);
    if (!is_atom_record(line)) {
      account.pass_over(line, number);
      continue;
    }
    if (models.begins_model()) builder.begin_model(models.names().back());
    add_pqr_record(line, number, path, builder, account);
  }
  if (builder.file().atoms.empty())
    throw FileFormatError(path + ": has no ATOM or HETATM record, so there is nothing to mesh");
  ParsedFile file = builder.finish();
  file.warnings = account.warnings();
  file.elements_in_doubt = false;  // radii need none
  return file;
}

}  // namespace vdwmesh
