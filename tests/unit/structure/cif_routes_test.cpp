// Odd mmCIF files on two routes: the reader of this library, which looks at the tables that it
// needs alone, and gemmi's document of the whole file with the structure that gemmi makes of it.
#include <gmock/gmock.h>

#include <algorithm>
#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

namespace cif = gemmi::cif;

const std::vector<std::string> kTags{
    "id",           "group_PDB",     "type_symbol",       "label_atom_id",     "label_alt_id",
    "auth_atom_id", "label_comp_id", "label_asym_id",     "auth_asym_id",      "label_entity_id",
    "label_seq_id", "auth_seq_id",   "pdbx_PDB_ins_code", "Cartn_x",           "Cartn_y",
    "Cartn_z",      "occupancy",     "B_iso_or_equiv",    "pdbx_PDB_model_num"};

using Row = std::vector<std::string>;

// A row of the table. Its other values are the same in all rows.
struct Values {
  std::string id, name = "CA", sequence = "1", x = "0.5", model = "1", symbol = "C";
  std::string residue = "ALA", chain = "A", insertion = "?", altloc = ".", group = "ATOM";
};
Row row(const Values& v) {
  return {v.id,          v.group, v.symbol, v.name,     v.altloc,   v.name,      v.residue,
          "L" + v.chain, v.chain, "1",      v.sequence, v.sequence, v.insertion, v.x,
          "-2.125",      "13.07", "0.5",    "20",       v.model};
}

std::vector<Row> some_rows() {
  return {row({.id = "1", .name = "N", .symbol = "N"}), row({.id = "2", .x = "-7.003"}),
          row({.id = "3",
               .name = "ZN",
               .sequence = "9",
               .x = "+4.",
               .symbol = "ZN",
               .residue = "ZN",
               .chain = "B",
               .group = "HETATM"}),
          row({.id = "4",
               .name = "O",
               .sequence = "12",
               .x = "1.25e1",
               .symbol = "O",
               .residue = "GLY",
               .insertion = "A"})};
}

std::string header(const std::string& prefix = "_atom_site.") {
  std::string text = "loop_\n";
  for (const std::string& tag : kTags) text += prefix + tag + "\n";
  return text;
}

std::string joined(const std::vector<Row>& rows, const std::string& blank = " ") {
  std::string text;
  for (const Row& values : rows) {
    for (const std::string& value : values) text += value + blank;
    text += "\n";
  }
  return text;
}

// The values of the column, of all rows, rewritten.
template <class Rewrite>
std::vector<Row> with_column(const std::string& tag, const Rewrite& rewrite) {
  std::vector<Row> rows = some_rows();
  const auto column = std::find(kTags.begin(), kTags.end(), tag) - kTags.begin();
  for (Row& values : rows) {
    std::string& value = values[static_cast<std::size_t>(column)];
    value = rewrite(value);
  }
  return rows;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

// An atom as a line of text; positions with all digits.
template <class Position>
std::string line(std::int64_t serial, const std::string& model, const std::string& chain,
                 const std::string& residue, const std::string& number, const std::string& name,
                 const std::string& element, const Position& p) {
  std::ostringstream text;
  text << serial << " /" << model << "/" << chain << "/" << residue << number << "/" << name << " "
       << element << std::hexfloat << " " << p.x << " " << p.y << " " << p.z;
  return text.str();
}

std::vector<std::string> by_library(const std::string& text) {
  ReadOptions options;
  options.model = options.altloc = "all";
  options.waters = Inclusion::keep;
  std::vector<std::string> lines;
  for (const Atom& a : read_text_as("a.cif", text, options).atoms)
    lines.push_back(line(a.serial, std::to_string(a.model), a.chain, a.residue_name,
                         a.residue_number, a.name, a.element, a.position));
  return lines;
}

// The atoms of the block that has any, in the order of their serial numbers.
std::vector<std::string> by_gemmi(const std::string& text) {
  cif::Document document = cif::read_memory(text.data(), text.size(), "a.cif");
  std::vector<std::pair<int, std::string>> atoms;
  for (cif::Block& block : document.blocks) {
    const gemmi::Structure structure = gemmi::make_structure_from_block(block);
    for (const gemmi::Model& model : structure.models)
      for (const gemmi::Chain& chain : model.chains)
        for (const gemmi::Residue& residue : chain.residues)
          for (const gemmi::Atom& a : residue.atoms)
            atoms.emplace_back(
                a.serial, line(a.serial, model.name, chain.name, residue.name, residue.seqid.str(),
                               a.name, a.element.name(), a.pos));
  }
  std::sort(atoms.begin(), atoms.end());
  std::vector<std::string> lines;
  for (const auto& atom : atoms) lines.push_back(atom.second);
  return lines;
}

void expect_same(const std::string& text, std::size_t atoms = 4) {
  const std::vector<std::string> expected = by_gemmi(text);
  EXPECT_EQ(expected.size(), atoms) << text;
  EXPECT_EQ(by_library(text), expected) << text;
}

TEST(CifRoutes, PlainTables) {
  const std::string table = header() + joined(some_rows());
  expect_same("data_a\n" + table);
  expect_same("DATA_a\n" + replaced(table, "loop_", "LOOP_"));
  expect_same("data_a\n" + header("_ATOM_SITE.") + joined(some_rows()));
  expect_same(replaced("data_a\n" + table, "\n", "\r\n"));
  expect_same("data_a\n" + header() + joined(some_rows(), "\t  \n "));
  expect_same("data_a\n" + table + "_entry.id x");
}

TEST(CifRoutes, ColumnsInAnotherOrder) {
  std::string text = "data_a\nloop_\n";
  for (auto tag = kTags.rbegin(); tag != kTags.rend(); ++tag)
    text += "_atom_site." + *tag + "\n_atom_site.more_" + *tag + "\n";
  for (const Row& values : some_rows())
    for (auto value = values.rbegin(); value != values.rend(); ++value) text += *value + " 'x y'\n";
  expect_same(text);
}

TEST(CifRoutes, QuotedValues) {
  const auto table = [](const auto& rewrite) {
    return "data_a\n" + header() + joined(with_column("auth_atom_id", rewrite));
  };
  expect_same(table([](const std::string& name) { return "'" + name + "'"; }));
  expect_same(table([](const std::string& name) { return '"' + name + "'\""; }));
  expect_same(table([](const std::string& name) { return "'" + name + " it's'"; }));
  expect_same(table([](const std::string& name) { return name + "'"; }));
  expect_same(table([](const std::string& name) { return name + "#;_"; }));
  expect_same(table([](const std::string& name) { return "'_" + name + "'"; }));
}

TEST(CifRoutes, TextFieldsAndComments) {
  const auto in_field = [](const std::string& name) { return "\n;" + name + "\n; "; };
  const std::string fields = "data_a\n" + header() + joined(with_column("auth_atom_id", in_field));
  expect_same(fields);
  expect_same(replaced(fields, "\n", "\r\n"));
  const auto with_comment = [](const std::string& name) { return name + " # ATOM 'x \"y\n#\n  "; };
  expect_same("#\ndata_a # x\n" + header() + "#\n" + joined(with_column("id", with_comment)));
}

TEST(CifRoutes, WordsThatBeginLikeReservedOnes) {
  for (const char* word : {"data", "loop", "save", "stop", "global", "D", "G", "L", "S", "Stop"})
    expect_same("data_a\n" + header() +
                joined(with_column("label_comp_id", [&](const std::string&) { return word; })));
}

TEST(CifRoutes, OtherTablesAndBlocks) {
  const std::string table = header() + joined(some_rows());
  const std::string others =
      "_cell.length_a 5\nloop_\n_entity.id\n_entity.type\n1 polymer\n2 "
      "'non-polymer'\nloop_\n_a.b\n_a.c\n"
      "1\n;ATOM 1 C\n_atom_site.id\nloop_\n;\n\"x y\" 'it's'\n";
  expect_same("data_a\n" + others + table);
  expect_same("data_a\n" + table + others);
  expect_same("data_b\n" + others + "data_a\n" + table + "data_c\n" + others);
  expect_same("data_a\n" + table + "save_f\n_atom_site.id 7\nsave_\n");
}

TEST(CifRoutes, RowsApart) {
  const std::vector<Row> rows{row({.id = "1"}),
                              row({.id = "2", .sequence = "2"}),
                              row({.id = "3", .name = "CB"}),
                              row({.id = "4", .model = "2"}),
                              row({.id = "5", .name = "CG", .sequence = "2"}),
                              row({.id = "6", .name = "CD", .model = "2"}),
                              row({.id = "7", .model = "2", .chain = "B"}),
                              row({.id = "8", .name = "CD", .model = "1"})};
  expect_same("data_a\n" + header() + joined(rows), rows.size());
}

TEST(CifRoutes, WhatBothRefuse) {
  const std::string table = header() + joined(some_rows());
  for (const std::string& text :
       {"data_a\n" + table + table, "data_a\n" + table + "7", "data_a\n" + table + "_a.b 'c\n",
        "data_a\n" + table + "_a.b\n;c\n", "data_a\n" + table + "_a.b\n", "data_a\n7\n" + table,
        "data_a\nloop_\n" + table}) {
    EXPECT_ANY_THROW(by_gemmi(text)) << text;
    refusal_of_text<FileFormatError>("a.cif", text);
  }
  // gemmi reads both blocks. Which of them is meant, nobody knows.
  refusal_of_text<FileFormatError>("a.cif", "data_a\n" + table + "data_b\n" + table);
}

}  // namespace
}  // namespace vdwmesh::testing
