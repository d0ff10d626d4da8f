// Copies the two tables of assemblies, kGenerators and kOperators, into AssemblyTables, row by row.
// Nothing is refused here. If an entry of a matrix is not a number, the operator gets a fault,
// which make_recipe() reports if the operator is used.
#include "structure/cif/mmcif_assembly.hpp"

#include <fmt/format.h>

#include <cmath>
#include <gemmi/cifdoc.hpp>
#include <gemmi/numb.hpp>

#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

namespace cif = gemmi::cif;

constexpr const char* kGenerators = "_pdbx_struct_assembly_gen.";
constexpr const char* kOperators = "_pdbx_struct_oper_list.";

// The value in a column of the row; empty if the table lacks the column.
std::string value(cif::Table::Row row, std::size_t column) {
  return row.has(column) ? row.str(static_cast<int>(column)) : std::string();
}

// The names in a comma-separated list. Long lists of chains have blanks and line breaks in them.
std::vector<std::string> names_between_commas(std::string_view list) {
  std::vector<std::string> names;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    const std::string_view name = trimmed(list.substr(0, comma));
    if (!name.empty()) names.emplace_back(name);
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  return names;
}

// The columns that are read: the id, then for each row of the matrix three entries and the shift.
// "?" marks a column as optional for gemmi; an empty value becomes a fault later.
std::vector<std::string> matrix_tags() {
  std::vector<std::string> tags{"id"};
  for (const char row : {'1', '2', '3'}) {
    for (const char column : {'1', '2', '3'})
      tags.push_back(fmt::format("?matrix[{}][{}]", row, column));
    tags.push_back(fmt::format("?vector[{}]", row));
  }
  return tags;
}

// The operator in one row of the table. `tags` is matrix_tags().
SymmetryOperator operator_of(cif::Table::Row row, const std::vector<std::string>& tags) {
  SymmetryOperator listed;
  listed.id = row.str(0);
  for (std::size_t column = 1; column < tags.size(); ++column) {
    const std::string text = value(row, column);
    const double number = cif::as_number(text);
    if (!std::isfinite(number) && listed.fault.empty())
      listed.fault = fmt::format("{} of operator {} is {}, not a finite number",
                                 tags[column].substr(1), in_quotes(listed.id), in_quotes(text));
    // Four columns for each matrix row: `place` is 0 to 2 for its entries and 3 for the shift.
    const std::size_t axis = (column - 1) / 4;
    const int place = static_cast<int>((column - 1) % 4);
    (place < 3 ? listed.map.rows[axis][place] : listed.map.shift[static_cast<int>(axis)]) = number;
  }
  return listed;
}

}  // namespace

AssemblyTables take_assembly_tables(cif::Block& block) {
  AssemblyTables tables;
  tables.chain_names = AssemblyTables::ChainNames::label;
  std::size_t number = 0;  // of the row in the table, from 1
  for (cif::Table::Row row :
       block.find(kGenerators, {"assembly_id", "?oper_expression", "?asym_id_list"}))
    tables.rows.push_back({row.str(0), fmt::format("row {} of _pdbx_struct_assembly_gen", ++number),
                           value(row, 1), names_between_commas(value(row, 2))});
  const std::vector<std::string> tags = matrix_tags();
  number = 0;
  for (cif::Table::Row row : block.find(kOperators, tags)) {
    tables.operators.push_back(operator_of(row, tags));
    tables.operators.back().where = fmt::format("row {} of _pdbx_struct_oper_list", ++number);
  }
  for (cif::Item& item : block.items)
    if (item.has_prefix("_pdbx_struct_assembly") || item.has_prefix(kOperators)) item.erase();
  return tables;
}

}  // namespace vdwmesh
