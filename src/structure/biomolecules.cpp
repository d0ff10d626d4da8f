#include "structure/biomolecules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>

#include "structure/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kText = 11;    // columns before the text of a remark
constexpr std::size_t kMatrix = 13;  // columns before BIOMT
constexpr std::string_view kBiomolecule = "BIOMOLECULE:";
constexpr std::array<std::string_view, 4> kNames{"x", "y", "z", "the shift"};

std::string upper_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return result;
}

// What follows `word` in the text; nothing without the word.
std::optional<std::string_view> text_after(std::string_view text, std::string_view word) {
  const std::size_t found = upper_case(text).find(word);
  if (found == std::string::npos) return std::nullopt;
  return text.substr(found + word.size());
}

// "A, B, C," and "A B C"; old files write NULL for a chain without a name.
std::vector<std::string> listed_names(std::string_view list) {
  std::string text(list);
  std::replace(text.begin(), text.end(), ',', ' ');
  std::vector<std::string> names;
  for (const std::string_view name : split_at_blanks(text))
    names.emplace_back(name == "NULL" ? std::string_view() : name);
  return names;
}

// "BIOMT1   1  1.000000  0.000000  0.000000        0.00000": the fields by blanks, which every
// program writes; by columns where numbers touch.
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
  const std::size_t row = fields[0].size() == 6 ? static_cast<std::size_t>(fields[0][5] - '1') : 3;
  if (row == 0 || row >= 3) close_operator();
  if (matrix_rows_ == 0) operator_.where = fmt::format("line {}", number);
  if (row != matrix_rows_ && operator_.fault.empty())
    operator_.fault =
        fmt::format("{} is out of its order: BIOMT1, BIOMT2, BIOMT3", in_quotes(fields[0]));
  ++matrix_rows_;
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

// Every program numbers them anew somewhere, so they are called by their place in the file.
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
