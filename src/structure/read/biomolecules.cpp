// A state machine over the records of REMARK 350, which look like this:
//
//   REMARK 350 BIOMOLECULE: 1
//   REMARK 350 APPLY THE FOLLOWING TO CHAINS: A, B,
//   REMARK 350                    AND CHAINS: C
//   REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000
//   REMARK 350   BIOMT2   1  ...
//
// Three BIOMT rows are one operator. The operators that follow a list of chains apply to it;
// together they are a group, that is, one AssemblyRow. A new list or a new biomolecule closes the
// group.
#include "structure/read/biomolecules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/letters.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kText = 11;    // columns before the text of a remark: "REMARK 350 "
constexpr std::size_t kMatrix = 13;  // columns before the word BIOMT1
constexpr std::string_view kBiomolecule = "BIOMOLECULE:";
// The four numbers of a matrix row, for messages.
constexpr std::array<std::string_view, 4> kNames{"x", "y", "z", "the shift"};

// The part of the text behind `word`, which is given in capitals. Nothing if the word is not there.
std::optional<std::string_view> text_after(std::string_view text, std::string_view word) {
  const std::size_t found = upper_case(text).find(word);
  if (found == std::string::npos) return std::nullopt;
  return text.substr(found + word.size());
}

// The names in a list such as "A, B, C," or "A B C". Old files write NULL for a chain without a
// name; its name is the empty string.
std::vector<std::string> listed_names(std::string_view list) {
  std::string text(list);
  std::replace(text.begin(), text.end(), ',', ' ');
  std::vector<std::string> names;
  for (const std::string_view name : split_at_blanks(text))
    names.emplace_back(name == "NULL" ? std::string_view() : name);
  return names;
}

// The six fields of a matrix row: BIOMTn, the serial number, three numbers of the matrix and the
// shift. Blanks separate them in nearly all files. If that does not give six fields, numbers touch,
// and the columns of the format separate them.
std::array<std::string_view, 6> matrix_fields(std::string_view record) {
  const std::string_view text = columns(record, kMatrix, record.size());
  const std::vector<std::string_view> fields = split_at_blanks(text);
  std::array<std::string_view, 6> result;
  if (fields.size() == result.size()) {
    std::copy(fields.begin(), fields.end(), result.begin());
    return result;
  }
  return {columns(text, 0, 6),   trimmed(columns(text, 6, 4)), columns(text, 10, 10),
          columns(text, 20, 10), columns(text, 30, 10),        columns(text, 45, 10)};
}

}  // namespace

void BiomoleculeReader::take(std::string_view record, std::uint32_t number) {
  const std::string_view text = trimmed(columns(record, kText, record.size()));
  const std::string words = upper_case(text);
  if (words.starts_with(kBiomolecule)) {
    take_names(text.substr(kBiomolecule.size()));
  } else if (words.starts_with("BIOMT")) {
    take_matrix_row(record, number);
  } else if (const auto chains = text_after(text, "CHAINS:")) {
    take_chains(*chains, words.find("APPLY") != std::string::npos, number);
  }
}

void BiomoleculeReader::take_names(std::string_view list) {
  close_group();
  names_ = listed_names(list);
}

// `first`: the record begins a list ("APPLY THE FOLLOWING"); others continue it ("AND CHAINS").
void BiomoleculeReader::take_chains(std::string_view list, bool first, std::uint32_t number) {
  if (first) {
    close_group();
    group_.where = fmt::format("line {}", number);
  }
  const std::vector<std::string> chains = listed_names(list);
  group_.chains.insert(group_.chains.end(), chains.begin(), chains.end());
}

void BiomoleculeReader::take_matrix_row(std::string_view record, std::uint32_t number) {
  const std::array<std::string_view, 6> fields = matrix_fields(record);
  // 0, 1 or 2 for BIOMT1 to BIOMT3; 3 or more for anything else (smaller characters than '1' wrap
  // round to huge numbers), which is a fault. BIOMT1 begins an operator, and so does a bad row.
  const std::size_t row = fields[0].size() == 6 ? static_cast<std::size_t>(fields[0][5] - '1') : 3;
  if (row == 0 || row >= 3) close_operator();
  if (matrix_rows_ == 0) operator_.where = fmt::format("line {}", number);
  if (row != matrix_rows_ && operator_.fault.empty())
    operator_.fault =
        fmt::format("{} is out of its order: BIOMT1, BIOMT2, BIOMT3", in_quotes(fields[0]));
  ++matrix_rows_;
  // Four numbers: three entries of the matrix, then the shift. A bad row has no place to store
  // them.
  for (std::size_t i = 0; i < kNames.size() && row < 3; ++i) {
    const auto value = finite_number(fields[i + 2]);
    if (!value && operator_.fault.empty())
      operator_.fault = fmt::format("{} of BIOMT{} is {}, not a finite number", kNames[i], row + 1,
                                    in_quotes(trimmed(fields[i + 2])));
    const int axis = static_cast<int>(i);
    (i < 3 ? operator_.map.rows[row][axis] : operator_.map.shift[static_cast<int>(row)]) =
        value.value_or(0);
  }
}

// Adds the current matrix, if there is one, to the tables and to the current group. Files number
// their matrices anew in each biomolecule or group, so the numbers are not unique. The id is the
// index among all matrices of the file instead, from 1.
void BiomoleculeReader::close_operator() {
  if (matrix_rows_ == 0) return;
  if (matrix_rows_ != 3 && operator_.fault.empty())
    operator_.fault = "a matrix needs BIOMT1, BIOMT2 and BIOMT3";
  operator_.id = std::to_string(tables_.operators.size() + 1);
  if (group_.where.empty()) group_.where = operator_.where;
  group_.expression += (group_.expression.empty() ? "" : ",") + operator_.id;
  tables_.operators.push_back(std::move(operator_));
  operator_ = {};
  matrix_rows_ = 0;
}

// Adds the current group to the tables, once for each biomolecule that it belongs to. A group
// without a line number has had no record.
void BiomoleculeReader::close_group() {
  close_operator();
  if (!group_.where.empty())
    for (const std::string& name : names_) {
      group_.assembly = name;
      tables_.rows.push_back(group_);
    }
  group_ = {};
}

AssemblyTables BiomoleculeReader::finish() {
  close_group();
  return std::move(tables_);
}

}  // namespace vdwmesh
