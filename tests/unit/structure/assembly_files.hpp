// Texts of mmCIF files with tables of assemblies, written part by part.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "structure/reader.hpp"

namespace vdwmesh::testing {

// Asks for the assembly of that name, all else as usual.
inline ReadOptions assembly(const std::string& name) {
  ReadOptions options;
  options.assembly = name;
  return options;
}

// The head of a file: its rows of atoms follow directly, and tables of assemblies after those.
inline const std::string kAtomColumns =
    "data_t\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
    "_atom_site.label_atom_id\n_atom_site.label_comp_id\n_atom_site.label_asym_id\n"
    "_atom_site.label_seq_id\n_atom_site.auth_asym_id\n_atom_site.auth_seq_id\n"
    "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n";

// Protein chain A, its ligand C, which is of the author's chain A too, and protein chain B.
inline const std::string kThreeAtoms = kAtomColumns +
                                       "ATOM 1 C CA ALA A 1 A 1 1 2 3\n"
                                       "HETATM 2 O O LIG C . A 101 4 5 6\n"
                                       "ATOM 3 N N ALA B 1 B 1 7 8 9\n";
// Chain A alone, for tests that ask only which copies are made.
inline const std::string kOneAtom = kAtomColumns + "ATOM 1 C CA ALA A 1 A 1 1 2 3\n";

// The table that makes assemblies: for each row the assembly, the expression and the chains that it
// copies.
inline std::string generators(const std::vector<std::array<std::string, 3>>& rows) {
  std::string text =
      "loop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n"
      "_pdbx_struct_assembly_gen.asym_id_list\n";
  for (const auto& [assembly, expression, chains] : rows)
    text += assembly + " '" + expression + "' '" + chains + "'\n";
  return text;
}

// "x -> rows x + shift", row after row: twelve numbers, as text, for there are tests of bad ones.
struct Operator {
  std::string id;
  std::string numbers;
};

// The table of operators that expressions name.
inline std::string operator_list(const std::vector<Operator>& operators) {
  std::string text = "loop_\n_pdbx_struct_oper_list.id\n";
  for (const char row : {'1', '2', '3'}) {
    for (const char column : {'1', '2', '3'})
      text += std::string("_pdbx_struct_oper_list.matrix[") + row + "][" + column + "]\n";
    text += std::string("_pdbx_struct_oper_list.vector[") + row + "]\n";
  }
  for (const Operator& listed : operators) text += listed.id + " " + listed.numbers + "\n";
  return text;
}

// Moves by whole Å along x alone, so that where an atom lies tells its operator.
inline Operator shift_by(const std::string& id, int x) {
  return {id, "1 0 0 " + std::to_string(x) + " 0 1 0 0 0 0 1 0"};
}

// Operator i shifts along x by 2^i, so a sum of shifts tells which operators it is made of; P and
// X0 shift by 1024 and 2048.
inline std::vector<Operator> shifts(int count) {
  std::vector<Operator> result{shift_by("P", 1024), shift_by("X0", 2048)};
  for (int i = 1; i <= count; ++i) result.push_back(shift_by(std::to_string(i), 1 << i));
  return result;
}

}  // namespace vdwmesh::testing
