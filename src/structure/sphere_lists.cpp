// PQR and XYZR: files that bring their own radii.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <gemmi/model.hpp>
#include <system_error>

#include "core/errors.hpp"
#include "structure/elements.hpp"
#include "structure/lines.hpp"
#include "structure/parsed_file.hpp"
#include "structure/pdb_records.hpp"

namespace vdwmesh {
namespace {

struct Row {
  std::array<double, 3> position{};  // Å
  double radius = 0;                 // Å
  std::string_view serial, name, residue, chain, number;
  bool hetero = false;
};

// Adds atoms one by one, opening chains and residues as their names change.
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
    gemmi::Atom atom;
    atom.name = std::string(row.name);
    atom.element = gemmi::Element(element);
    atom.serial = static_cast<int>(file_.atoms.size());
    atom.pos = gemmi::Position(row.position[0], row.position[1], row.position[2]);
    residue_of(row).atoms.push_back(std::move(atom));
    AtomRecord record;
    record.line = line;
    record.serial =
        whole_number(row.serial).value_or(static_cast<std::int64_t>(file_.atoms.size()) + 1);
    record.hetero = row.hetero;
    record.radius = row.radius;
    record.element_guessed = !row.name.empty();
    file_.atoms.push_back(record);
  }

  std::size_t atom_count() const { return file_.atoms.size(); }

  ParsedFile finish() { return std::move(file_); }

 private:
  gemmi::Residue& residue_of(const Row& row) {
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
    }
    return residues.back();
  }

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
  gemmi::Chain* chain_ = nullptr;
  std::string number_;
};

[[noreturn]] void refuse(const std::string& path, std::uint32_t line, const std::string& what) {
  throw FileFormatError(fmt::format("{}:{}: {}", path, line, what));
}

double number_or_refuse(std::string_view field, std::string_view what, const std::string& path,
                        std::uint32_t line) {
  const auto value = finite_number(field);
  if (!value)
    refuse(path, line, fmt::format("{} is {}, not a finite number", what, in_quotes(field)));
  return *value;
}

// x y z [charge] radius.
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

// The PDB's columns for the names and coordinates, then charge and radius: the layout whose
// numbers may touch.
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

// ATOM serial name residue [chain] number x y z charge radius.
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
  const std::size_t last = fields.size() - 1;
  Row row;
  row.hetero = fields[0].starts_with("HETATM");
  row.serial = fields[1];
  row.name = fields[2];
  row.residue = fields[3];
  if (fields.size() == 11) row.chain = fields[4];
  row.number = fields[last - 5];
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

// Occupancy and temperature factor where the PDB has them, with its two decimals.
bool has_pdb_factors(std::string_view line) {
  const auto has_two_decimals = [](std::string_view field) {
    return field.size() == 6 && field[3] == '.' && is_number(field);
  };
  return has_two_decimals(columns(line, 54, 6)) && has_two_decimals(columns(line, 60, 6));
}

// A PDB file under the name of a PQR file would give its temperature factors for radii.
void refuse_pdb(std::string_view text, const std::string& path) {
  constexpr double kLargestOfAtoms = 5;  // Å; caesium has 3.5
  bool pdb = true, elements = true;
  double largest = 0;  // Å, were it a PQR file
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
  Builder builder(path, "pqr");
  refuse_pdb(text, path);
  ModelRecords models;
  std::string_view line;
  for (std::uint32_t number = 1; next_line(text, line); ++number) {
    if (models.take(trimmed(line))) continue;
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
  std::string_view line;
  for (std::uint32_t number = 1; next_line(text, line); ++number) {
    const std::vector<std::string_view> fields = split_at_blanks(line.substr(0, line.find('#')));
    if (fields.empty()) continue;
    if (fields.size() < 4)
      refuse(path, number, fmt::format("has {} fields; XYZR needs x y z radius", fields.size()));
    Row row;
    read_sphere(fields, 0, 3, row, path, number);
    builder.add(row, "X", number);
  }
  if (builder.atom_count() == 0)
    throw FileFormatError(path + ": has no line with x y z radius, so there is nothing to mesh");
  return builder.finish();
}

}  // namespace vdwmesh
