// What programs write into each column, and what is read from it: the table dialects.csv. Its rows
// of one program, format and file are the atoms of one file. The element is "-" for what is no
// atom, and "?" for an atom that no built-in radius set can have.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <gemmi/model.hpp>
#include <map>
#include <tuple>

#include "structure/molecule/elements.hpp"
#include "structure/molecule/site.hpp"
#include "structure/read/hierarchy.hpp"
#include "structure/read/parsed_file.hpp"

namespace vdwmesh::testing {
namespace {

constexpr const char* kCifHead =
    "data_x\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
    "_atom_site.label_atom_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n"
    "_atom_site.label_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";

// What stands before and behind the records of a file, of which there are so many.
std::string head_of(const std::string& format, std::size_t records) {
  const std::string count = std::to_string(records) + "\n";
  if (format == "cif") return kCifHead;
  if (format == "gro") return "title\n" + count;
  return format == "mol2" ? "@<TRIPOS>MOLECULE\nx\n" + count + "@<TRIPOS>ATOM\n" : "";
}
std::string foot_of(const std::string& format) { return format == "gro" ? " 9 9 9\n" : ""; }

using Row = std::map<std::string, std::string>;  // by the name of the column

// The fields of a line of CSV. A field with commas stands in quotes.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  return fields;
}

std::vector<std::vector<Row>> files_of_table() {
  std::ifstream table(VDWMESH_DIALECTS);
  std::string line;
  std::getline(table, line);
  const std::vector<std::string> names = fields_of(line);
  std::map<std::tuple<std::string, std::string, std::string>, std::vector<Row>> files;
  while (std::getline(table, line)) {
    const std::vector<std::string> fields = fields_of(line);
    Row row;
    for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = fields.at(i);
    files[{row["program"], row["format"], row["file"]}].push_back(row);
  }
  std::vector<std::vector<Row>> result;
  for (auto& [key, rows] : files) result.push_back(rows);
  return result;
}

ParsedFile parsed(const std::vector<Row>& rows) {
  const std::string format = rows.front().at("format");
  std::string text = head_of(format, rows.size());
  for (const Row& row : rows) text += row.at("record") + "\n";
  text += foot_of(format);
  ParsedFile file = format == "cif"    ? parse_mmcif(text, "a.cif")
                    : format == "pqr"  ? parse_pqr(text, "a.pqr")
                    : format == "xyzr" ? parse_xyzr(text, "a.xyzr")
                    : format == "gro"  ? parse_gro(text, "a.gro")
                    : format == "mol2" ? parse_mol2(text, "a.mol2")
                                       : parse_pdb(text, "a.pdb");
  settle_elements(file);
  return file;
}

class Dialects : public ::testing::TestWithParam<std::vector<Row>> {};

TEST_P(Dialects, EachColumnIsReadAsItsProgramMeansIt) {
  ParsedFile file = parsed(GetParam());
  ASSERT_EQ(file.atoms.size(), GetParam().size());
  const std::vector<ResiduePlace> places = numbered_residues(*file.structure);
  for (std::size_t i = 0; i < file.atoms.size(); ++i) {
    const Row& row = GetParam()[i];
    const AtomRecord& atom = file.atoms[i];
    const ResiduePlace& place = places.at(atom.residue);
    const std::string symbol = gemmi::element_name(atom.element);
    EXPECT_EQ(atom.is_virtual ? "-"
              : symbol == "X" ? "?"
                              : symbol,
              row.at("element"))
        << row.at("program") << ": " << row.at("record");
    EXPECT_EQ(place.residue->name, row.at("residue")) << row.at("record");
    EXPECT_EQ(place.chain->name, row.at("chain")) << row.at("record");
    EXPECT_EQ(place.residue->segment, row.at("segment")) << row.at("record");
    if (!row.at("radius").empty()) {
      EXPECT_EQ(atom.radius, std::stod(row.at("radius"))) << row.at("record");
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Table, Dialects, ::testing::ValuesIn(files_of_table()),
                         [](const auto& info) {
                           std::string name = info.param.front().at("program") +
                                              info.param.front().at("format") +
                                              info.param.front().at("file");
                           std::erase_if(name, [](char c) {
                             return std::isalnum(static_cast<unsigned char>(c)) == 0 || c < 0;
                           });
                           return name;
                         });

}  // namespace
}  // namespace vdwmesh::testing
