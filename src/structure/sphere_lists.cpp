// Reads PQR and XYZR files: lists of atoms or spheres with radii of their own.
//
// XYZR has one sphere per line: x y z radius. PQR is PDB-like: ATOM and HETATM records whose last
// fields are charge and radius (PDB2PQR, APBS). PQR fields are separated by blanks, but some
// programs write the columns of PDB, where neighbouring numbers may touch; pqr_row() reads both.
// gemmi has no parser for these formats. Builder creates the gemmi::Structure.
//
// Lists of spheres may be large, so the lines of XYZR are read on all cores: the text is cut into
// pieces at line ends, the lines and spheres of each are counted, and each piece is read to where
// its first sphere belongs. Which line is at fault does not depend on the pieces: the first one is.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <gemmi/model.hpp>
#include <optional>
#include <system_error>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "structure/elements.hpp"
#include "structure/lines.hpp"
#include "structure/parsed_file.hpp"
#include "structure/pdb_records.hpp"
#include "structure/unexpanded.hpp"

namespace vdwmesh {
namespace {

// The contents of one line. The views point into the text of the file. `number` is the residue's
// number, and `residue` its name.
struct Row {
  std::array<double, 3> position{};  // Å
  double radius = 0;                 // Å
  std::string_view serial, name, residue, chain, number;
  bool hetero = false;
};

// Builds the ParsedFile atom by atom. A new chain begins when the chain id changes, and a new
// residue when the chain, the residue's number or its name changes. Call begin_model() before the
// first atom.
class Builder {
 public:
  explicit Builder(const std::string& path, const char* format) {
    file_.path = path;
    file_.format = format;
    file_.own_radii = true;
    file_.structure = std::make_shared<gemmi::Structure>();
  }

  void begin_model(const std::string& name) {
    file_.structure->models.emplace_back(name);
    chain_ = nullptr;
  }

  void add(const Row& row, const char* element, std::uint32_t line) {
    const std::uint32_t residue = residue_of(row);
    AtomRecord& record = file_.atoms.emplace_back();
    record.position = {row.position[0], row.position[1], row.position[2]};
    record.name = row.name;
    record.element = gemmi::Element(element).elem;
    record.residue = residue;
    record.line = line;
    record.serial =
        whole_number(row.serial).value_or(static_cast<std::int64_t>(file_.atoms.size()));
    record.hetero = row.hetero;
    record.radius = row.radius;
    record.element_guessed = !row.name.empty();
  }

  // Makes atoms without names, in one residue, which the caller completes.
  std::vector<AtomRecord>& add_nameless(std::size_t count) {
    residue_of({});
    file_.atoms.reserve(count);
    advise_large_pages(file_.atoms.data(), count);
    file_.atoms.resize(count);
    return file_.atoms;
  }

  std::size_t atom_count() const { return file_.atoms.size(); }

  ParsedFile finish() { return std::move(file_); }

 private:
  // The number of the residue that the row belongs to; begins a new one if necessary.
  std::uint32_t residue_of(const Row& row) {
    if (!chain_ || chain_->name != row.chain) {
      std::vector<gemmi::Chain>& chains = file_.structure->models.back().chains;
      chains.emplace_back(std::string(row.chain));
      chain_ = &chains.back();
      number_.clear();
    }
    std::vector<gemmi::Residue>& residues = chain_->residues;
    if (residues.empty() || number_ != row.number || residues.back().name != row.residue) {
      number_ = row.number;
      gemmi::Residue residue;
      residue.name = std::string(row.residue);
      residue.seqid = sequence_id(number_);
      residue.het_flag = row.hetero ? 'H' : 'A';
      residues.push_back(std::move(residue));
      ++residues_;
    }
    return residues_ - 1;
  }

  // Splits "52A" into the number 52 and the insertion code A.
  static gemmi::SeqId sequence_id(std::string_view number) {
    gemmi::SeqId id;
    int value = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
    if (error != std::errc()) return id;
    id.num = value;
    if (end != number.data() + number.size()) id.icode = *end;
    return id;
  }

  ParsedFile file_;
  std::uint32_t residues_ = 0;     // begun so far
  gemmi::Chain* chain_ = nullptr;  // the current chain; null at the beginning of a model
  std::string number_;             // of the current residue, as in the file
};

[[noreturn]] void refuse(const std::string& path, std::uint32_t line, const std::string& what) {
  throw FileFormatError(fmt::format("{}:{}: {}", path, line, what));
}

// The field as a finite number. Throws otherwise; `what` names the field in the message.
double number_or_refuse(std::string_view field, std::string_view what, const std::string& path,
                        std::uint32_t line) {
  const auto value = finite_number(field);
  if (!value)
    refuse(path, line, fmt::format("{} is {}, not a finite number", what, in_quotes(field)));
  return *value;
}

// Reads x, y and z from fields[first] on, and the radius from fields[radius].
void read_sphere(const std::vector<std::string_view>& fields, std::size_t first, std::size_t radius,
                 Row& row, const std::string& path, std::uint32_t line) {
  static constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis)
    row.position[axis] = number_or_refuse(fields[first + axis], kAxes[axis], path, line);
  row.radius = number_or_refuse(fields[radius], "the radius", path, line);
  if (row.radius < 0)
    refuse(path, line, fmt::format("the radius is {}; it cannot be negative", row.radius));
}

bool is_number(std::string_view field) { return finite_number(field).has_value(); }

// Splits a PQR record by the columns of PDB: record name, serial, atom name, residue name, chain,
// residue number, x, y, z. These fields may be empty. Charge and radius follow in no fixed columns,
// so blanks separate them. A full record gives 11 fields, even if its chain is empty.
std::vector<std::string_view> fields_by_column(std::string_view line) {
  std::vector<std::string_view> fields{
      columns(line, 0, 6),  columns(line, 6, 5),  columns(line, 12, 4),
      columns(line, 17, 3), columns(line, 21, 1), columns(line, 22, 5),
      columns(line, 30, 8), columns(line, 38, 8), columns(line, 46, 8)};
  for (const std::string_view field : split_at_blanks(columns(line, 54, 80)))
    fields.push_back(field);
  for (std::string_view& field : fields) field = trimmed(field);
  return fields;
}

// Reads one record: ATOM serial name residue [chain] number x y z charge radius.
//
// Splitting at blanks is right if it gives 10 or 11 fields of which the fifth to third from the end
// are numbers (x, y, z). Otherwise the columns of PDB are tried. If they do not fit either, the
// first eleven fields between blanks are kept, and the checks below name the one that is wrong.
Row pqr_row(std::string_view line, const std::string& path, std::uint32_t number) {
  std::vector<std::string_view> fields = split_at_blanks(line);
  const std::size_t count = fields.size();
  const bool by_blanks = (count == 10 || count == 11) && is_number(fields[count - 5]) &&
                         is_number(fields[count - 4]) && is_number(fields[count - 3]);
  if (!by_blanks) {
    std::vector<std::string_view> aligned = fields_by_column(line);
    const bool fits = aligned.size() >= 11 && is_number(aligned[6]) && is_number(aligned[7]) &&
                      is_number(aligned[8]);
    if (fits)
      fields.assign(aligned.begin(), aligned.begin() + 11);
    else if (count < 10)
      refuse(path, number,
             fmt::format("has {} fields; PQR needs at least 10: ATOM serial name "
                         "residue [chain] number x y z charge radius",
                         count));
    else if (count > 11)
      fields.resize(11);
  }
  // The chain is optional, so everything behind it is counted from the end: radius, charge, z, y,
  // x, residue number.
  const std::size_t last = fields.size() - 1;
  Row row;
  row.hetero = fields[0].starts_with("HETATM");
  row.serial = fields[1];
  row.name = fields[2];
  row.residue = fields[3];
  if (fields.size() == 11) row.chain = fields[4];
  row.number = fields[last - 5];
  // The chain id and the number may touch: "A1000".
  if (row.chain.empty() && row.number.size() > 1 &&
      std::isalpha(static_cast<unsigned char>(row.number[0]))) {
    row.chain = row.number.substr(0, 1);
    row.number.remove_prefix(1);
  }
  if (row.number.find_first_of("0123456789") == std::string_view::npos)
    refuse(path, number,
           fmt::format("{} stands where the residue number should be: a field is missing",
                       in_quotes(row.number)));
  number_or_refuse(fields[last - 1], "the charge", path, number);
  read_sphere(fields, last - 4, last, row, path, number);
  return row;
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

// Lines of XYZR that one thread reads at a time.
struct Piece {
  std::string_view text;
  std::size_t first_line = 0, first_sphere = 0;  // in the file, from 0
  std::size_t faulty_line = kNoLine;             // the first of its lines that is at fault, from 0
  static constexpr std::size_t kNoLine = ~std::size_t{0};
};

std::vector<Piece> cut(std::string_view text) {
  std::vector<Piece> pieces;
  for (const std::string_view piece : pieces_of_spheres(text)) pieces.push_back({piece});
  return pieces;
}

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

// Moves the next word from the front of the line; empty behind the last one.
std::string_view next_word(std::string_view& line) {
  std::size_t first = 0;
  while (first < line.size() && is_blank(line[first])) ++first;
  std::size_t last = first;
  while (last < line.size() && !is_blank(line[last])) ++last;
  const std::string_view word = line.substr(first, last - first);
  line.remove_prefix(last);
  return word;
}

// Reads a sphere from a line without a comment. False if the line is at fault.
bool take_sphere(std::string_view line, AtomRecord& record) {
  std::array<double, 4> values{};
  for (double& value : values) {
    const std::optional<double> number = finite_number(next_word(line));
    if (!number) return false;
    value = *number;
  }
  record.position = {values[0], values[1], values[2]};
  record.radius = values[3];
  return record.radius >= 0;
}

// Calls visit(index, line) for each line with a sphere, with its index in the piece and without its
// comment. Returns the number of all lines.
template <class Visit>
std::size_t for_each_sphere(std::string_view piece, const Visit& visit) {
  std::size_t count = 0;
  for (std::string_view line; next_line(piece, line); ++count) {
    line = without_comment(line);
    if (!std::all_of(line.begin(), line.end(), is_blank)) visit(count, line);
  }
  return count;
}

// Throws, and says what is wrong with the line.
[[noreturn]] void refuse_sphere(std::string_view text, std::size_t index, const std::string& path) {
  std::string_view line;
  for (std::size_t i = 0; i <= index; ++i) next_line(text, line);
  const auto number = static_cast<std::uint32_t>(index + 1);
  const std::vector<std::string_view> fields = split_at_blanks(without_comment(line));
  if (fields.size() < 4)
    refuse(path, number, fmt::format("has {} fields; XYZR needs x y z radius", fields.size()));
  Row row;
  read_sphere(fields, 0, 3, row, path, number);
  throw InternalError("a line of XYZR was at fault, and is not when it is read again");
}

// Counts the lines and spheres of the pieces, so that each knows its first ones. Returns the number
// of spheres.
std::size_t number_pieces(std::vector<Piece>& pieces) {
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&pieces](std::size_t i) {
    std::size_t spheres = 0;
    const auto count = [&spheres](std::size_t, std::string_view) { ++spheres; };
    pieces[i].first_line = for_each_sphere(pieces[i].text, count);
    pieces[i].first_sphere = spheres;
  });
  std::size_t lines = 0, spheres = 0;
  for (Piece& piece : pieces) {
    lines += std::exchange(piece.first_line, lines);
    spheres += std::exchange(piece.first_sphere, spheres);
  }
  return spheres;
}

// Fills the records of the spheres in the piece, and notes the first line that is at fault.
void read_piece(Piece& piece, std::vector<AtomRecord>& atoms) {
  std::size_t next = piece.first_sphere;
  for_each_sphere(piece.text, [&](std::size_t index, std::string_view line) {
    const std::size_t in_file = piece.first_line + index;
    AtomRecord& record = atoms[next++];
    record.line = static_cast<std::uint32_t>(in_file + 1);
    record.serial = static_cast<std::int64_t>(next);
    if (!take_sphere(line, record)) piece.faulty_line = std::min(piece.faulty_line, in_file);
  });
}

// Throws if a line of the first piece is at fault. A file of something else shows it here mostly,
// before records are made for all of its lines: these take 72 bytes each, and a line may have two.
void check_first(const Piece& piece, std::string_view text, const std::string& path) {
  std::size_t faulty = Piece::kNoLine;
  for_each_sphere(piece.text, [&](std::size_t index, std::string_view line) {
    AtomRecord record;
    if (faulty == Piece::kNoLine && !take_sphere(line, record)) faulty = index;
  });
  if (faulty != Piece::kNoLine) refuse_sphere(text, faulty, path);
}

}  // namespace

// Cuts the text behind line feeds. A text without them is one piece.
std::vector<std::string_view> pieces_of_spheres(std::string_view text) {
  constexpr std::size_t kLength = std::size_t{1} << 18;  // bytes
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const std::size_t feed = text.find('\n', std::min(kLength, text.size() - 1));
    const std::size_t length = feed == text.npos ? text.size() : feed + 1;
    pieces.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  return pieces;
}

std::uint64_t count_spheres(std::string_view piece) {
  std::uint64_t spheres = 0;
  for_each_sphere(piece, [&spheres](std::size_t, std::string_view) { ++spheres; });
  return spheres;
}

bool read_spheres(std::string_view piece, const std::function<void(const Vec3d&, double)>& put) {
  bool is_sound = true;
  for_each_sphere(piece, [&](std::size_t, std::string_view line) {
    AtomRecord record;
    is_sound = is_sound && take_sphere(line, record) && record.radius > 0 &&
               record.radius <= kFarthest && !is_far(record.position);
    if (is_sound) put(record.position, record.radius);
  });
  return is_sound;
}

ParsedFile parse_pqr(std::string_view text, const std::string& path) {
  Builder builder(path, "pqr");
  refuse_pdb(text, path);
  ModelRecords models;
  std::string_view line;
  for (std::uint32_t number = 1; next_line(text, line); ++number) {
    // take() is true for records that separate models; they need nothing else.
    if (models.take(trimmed(line))) continue;
    // Blanks before the record name are harmless here, unlike in PDB files with fixed columns.
    if (is_atom_record(trimmed(line)) && !is_atom_record(line)) line = trimmed(line);
    if (!is_atom_record(line)) continue;
    if (models.begins_model()) builder.begin_model(models.names().back());
    const Row row = pqr_row(line, path, number);
    builder.add(row, element_of_bare_name(row.name, row.residue), number);
  }
  if (builder.atom_count() == 0)
    throw FileFormatError(path + ": has no ATOM or HETATM record, so there is nothing to mesh");
  return builder.finish();
}

ParsedFile parse_xyzr(std::string_view text, const std::string& path) {
  Builder builder(path, "xyzr");
  builder.begin_model("1");
  std::vector<Piece> pieces = cut(text);
  if (pieces.size() > 1) check_first(pieces.front(), text, path);  // one piece is read at once
  const std::size_t count = number_pieces(pieces);
  if (count == 0)
    throw FileFormatError(path + ": has no line with x y z radius, so there is nothing to mesh");
  std::vector<AtomRecord>& atoms = builder.add_nameless(count);
  tbb::parallel_for(std::size_t{0}, pieces.size(),
                    [&](std::size_t i) { read_piece(pieces[i], atoms); });
  for (const Piece& piece : pieces)
    if (piece.faulty_line != Piece::kNoLine) refuse_sphere(text, piece.faulty_line, path);
  return builder.finish();
}

}  // namespace vdwmesh
