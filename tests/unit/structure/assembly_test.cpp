// Biological assemblies of mmCIF and PDB files: both formats against each other, and what must be
// refused.
#include <gmock/gmock.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "structure/assembly_files.hpp"
#include "structure/temp_file.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(MmCifAssembly, RowsAddUp) {
  const std::string text = kThreeAtoms +
                           generators({{"1", "1,2", "A,C"}, {"1", "2", "B"}, {"2", "1", "B"}}) +
                           operator_list(shifts(2));
  const Molecule molecule = read_text_as("a.cif", text, assembly("1"));
  std::vector<std::string> atoms;
  for (const Atom& atom : molecule.atoms)
    atoms.push_back(atom.chain + " " + atom.name + " " +
                    std::to_string(static_cast<int>(atom.position.x)));
  EXPECT_THAT(atoms, ElementsAre("A1 CA 3", "A1 O 6", "A2 CA 5", "A2 O 8", "B1 N 11"));
  EXPECT_EQ(molecule.atoms_used, 3U);
  const Molecule second = read_text_as("a.cif", text, assembly("2"));
  EXPECT_EQ(second.atoms.size(), 1U);
  EXPECT_EQ(second.skipped, (SkippedAtoms{{"not_in_assembly", 2}}));
}

// All copies of an atom are measured, and one that the assembly lacks cannot be.
TEST(MmCifAssembly, CopiesOfAMeasuredAtomAreMeasured) {
  const std::string text =
      kThreeAtoms + generators({{"1", "1,2", "A,C"}}) + operator_list(shifts(2));
  ReadOptions options = assembly("1");
  options.measure = "A//CA";
  std::vector<std::string> measured;
  for (const Atom& atom : read_text_as("a.cif", text, options).atoms)
    if (atom.measured) measured.push_back(atom.chain + " " + atom.name);
  EXPECT_THAT(measured, ElementsAre("A1 CA", "A2 CA"));
  options.measure = "B";
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.cif", text, options),
              HasSubstr("none of the 4 atoms"));
}

// Two rows that move parts of one chain by the same operator make one copy of the chain.
TEST(MmCifAssembly, CopiesOfAChainAreNamedByTheirOperator) {
  const Molecule molecule = read_text_as(
      "a.cif",
      kThreeAtoms + generators({{"1", "1,2", "A"}, {"1", "2", "C"}}) + operator_list(shifts(2)),
      assembly("1"));
  std::vector<std::string> chains;
  for (const Atom& atom : molecule.atoms) chains.push_back(atom.chain + " " + atom.name);
  EXPECT_THAT(chains, ElementsAre("A1 CA", "A2 CA", "A2 O"));
}

// Ids may have a minus: "1-x" is one operator, and "(1)(x)" another by the same letters.
TEST(MmCifAssembly, CopiesByDifferentOperatorsHaveDifferentNames) {
  const std::vector<Operator> operators{shift_by("1", 1), shift_by("x", 2), shift_by("1-x", 4)};
  const Molecule molecule = read_text_as(
      "a.cif", kOneAtom + generators({{"1", "1-x,(1)(x)", "A"}}) + operator_list(operators),
      assembly("1"));
  std::vector<std::string> chains;
  for (const Atom& atom : molecule.atoms) chains.push_back(atom.chain);
  EXPECT_THAT(chains, ElementsAre("A1", "A2"));
}

// No limit on atoms bounds the copies of a chain that has none: 100¹² of them would never end.
TEST(MmCifAssembly, CopiesOfNothingAreNotGoneThrough) {
  std::vector<Operator> hundred;
  std::string product;
  for (int i = 1; i <= 100; ++i) hundred.push_back(shift_by(std::to_string(i), i));
  for (int i = 0; i < 12; ++i) product += "(1-100)";
  const Molecule molecule = read_text_as(
      "a.cif",
      kOneAtom + generators({{"1", "1", "A"}, {"1", product, "Z"}}) + operator_list(hundred),
      assembly("1"));
  EXPECT_EQ(molecule.atoms.size(), 1U);
}

TEST(MmCifAssembly, OperatorsThatLeadNowhereAreNamed) {
  const Operator nowhere{"1", "1 0 0 0 1e308 -1e308 0 0 0 0 1 0"};
  const std::string atom = kAtomColumns + "ATOM 1 C CA ALA A 1 A 1 100 100 0\n";
  EXPECT_THAT(
      refusal_of_text<FileFormatError>(
          "a.cif", atom + generators({{"1", "1", "A"}}) + operator_list({nowhere}), assembly("1")),
      HasSubstr("operator 1 moves an atom to"));
}

TEST(MmCifAssembly, NeedsNoTableOfAssembliesAndNoneOfItsColumns) {
  const std::string rows =
      generators({{"1", "(1-2)", "A"}, {"PAU", "P", "A"}, {"XAU", "X0", "A"}}) +
      operator_list(shifts(2));
  const std::vector<std::string> tables{
      "", "loop_\n_pdbx_struct_assembly.id\n1\nPAU\nXAU\n",
      "loop_\n_pdbx_struct_assembly.id\n_pdbx_struct_assembly.details\n"
      "1 'complete icosahedral assembly'\nPAU 'icosahedral pentamer'\n"
      "XAU 'crystal asymmetric unit, crystal frame'\n",
      "_pdbx_struct_assembly.id 1\n_pdbx_struct_assembly.details ?\n"};
  for (const std::string& table : tables) {
    SCOPED_TRACE(table);
    EXPECT_EQ(read_text_as("a.cif", kOneAtom + table + rows, assembly("1")).atoms.size(), 2U);
    EXPECT_EQ(read_text_as("a.cif", kOneAtom + table + rows, assembly("PAU")).atoms.size(), 1U);
    EXPECT_EQ(
        read_text_as("a.cif", kOneAtom + table + rows, assembly("XAU")).atoms.at(0).position.x,
        2049);
    EXPECT_THAT(refusal_of_text<InvalidInput>("a.cif", kOneAtom + table + rows, assembly("2")),
                HasSubstr("asymmetric and 1 PAU XAU"));
  }
}

TEST(MmCifAssembly, ListsOfChainsMayRunOverLines) {
  const std::string rows =
      "loop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n"
      "_pdbx_struct_assembly_gen.asym_id_list\n1 1\n;A,\nB , C\n;\n";
  EXPECT_EQ(read_text_as("a.cif", kThreeAtoms + rows + operator_list(shifts(1)), assembly("1"))
                .atoms.size(),
            3U);
}

TEST(MmCifAssembly, OperatorsThatAreNoNumbersAreRefusedWithTheirRow) {
  for (const char* bad : {"?", "nan", "inf", "abc"}) {
    const std::string text =
        kOneAtom + generators({{"1", "1", "A"}, {"2", "2", "A"}}) +
        operator_list({shift_by("1", 0), {"2", std::string("1 0 0 0 0 1 ") + bad + " 0 0 0 1 0"}});
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", text, assembly("2")),
                HasSubstr("a.cif: row 2 of _pdbx_struct_oper_list: matrix[2][3] of operator '2'"));
    EXPECT_EQ(read_text_as("a.cif", text, assembly("1")).atoms.size(), 1U);
  }
  EXPECT_THAT(
      refusal_of_text<FileFormatError>("a.cif",
                                       kOneAtom + generators({{"1", "1", "A"}}) +
                                           operator_list({shift_by("1", 0), shift_by("1", 5)}),
                                       assembly("1")),
      HasSubstr("listed more than once"));
}

TEST(MmCifAssembly, OperatorsThatAreNoRotationsAreNamed) {
  const std::string text =
      kOneAtom + generators({{"1", "(1,M,S)", "A"}, {"2", "1,R", "A"}}) +
      operator_list({shift_by("1", 0),
                     {"M", "1 0 0 0 0 1 0 0 0 0 -1 0"},
                     {"S", "1 0 0 0 0 1.1 0 0 0 0 1 0"},
                     {"R", "0.8660 -0.5000 0 1 0.5000 0.8660 0 0 0 0 1 0"}});  // four decimals
  const Molecule deformed = read_text_as("a.cif", text, assembly("1"));
  ASSERT_EQ(deformed.warnings.size(), 1U);
  EXPECT_THAT(deformed.warnings[0], HasSubstr("operator M (row 2 of _pdbx_struct_oper_list) makes "
                                              "mirror images"));
  EXPECT_THAT(deformed.warnings[0], HasSubstr("operator S (row 3"));
  EXPECT_TRUE(read_text_as("a.cif", text, assembly("2")).warnings.empty());
  EXPECT_TRUE(read_text_as("a.cif", text).warnings.empty());
}

TEST(MmCifAssembly, CopiesTooFarAwayAreRefused) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif",
                                               kOneAtom + generators({{"1", "1", "A"}}) +
                                                   operator_list({shift_by("1", 2'000'000)}),
                                               assembly("1")),
              HasSubstr("operator 1 moves an atom to"));
}

// The files that showed what was wrong.
TEST(MmCifAssembly, FilesOfTraps) {
  VDWMESH_NEEDS_SHARED("molecules/traps");
  const std::vector<std::pair<std::string, std::size_t>> files{
      {"product", 8}, {"X0", 4}, {"mixed_list", 6}, {"space", 4}};
  for (const auto& [name, atoms] : files)
    EXPECT_EQ(
        read_structure(shared_path("molecules/traps/assembly_" + name + ".cif"), assembly("1"))
            .atoms.size(),
        atoms)
        << name;
  EXPECT_THAT(refusal_of<FileFormatError>(
                  shared_path("molecules/traps/assembly_missing_operator.cif"), assembly("1")),
              HasSubstr("there is no operator '9'"));
  EXPECT_THAT(
      refusal_of<FileFormatError>(shared_path("molecules/traps/biomt_stars.pdb"), assembly("1")),
      HasSubstr("'*******'"));
}

std::string atom_record(char chain, double x) {
  char line[96];
  std::snprintf(line, sizeof line, "ATOM      1  CA  ALA %c   1    %8.3f%8.3f%8.3f  1.00 10.00\n",
                chain, x, 2.0, 3.0);
  return line;
}

std::string biomt(int number, const std::string& x_row) {
  const std::string n = std::to_string(number);
  return "REMARK 350   BIOMT1   " + n + x_row + "\n" +  //
         "REMARK 350   BIOMT2   " + n + "  0.000000  1.000000  0.000000        0.00000\n" +
         "REMARK 350   BIOMT3   " + n + "  0.000000  0.000000  1.000000        0.00000\n";
}

const std::string kIdentity = "  1.000000  0.000000  0.000000        0.00000";
const std::string kShifted = "  1.000000  0.000000  0.000000       10.00000";
const std::string kAtomsABC = atom_record('A', 1) + atom_record('B', 2) + atom_record('C', 3);

std::vector<std::string> copies(const std::string& remarks, const std::string& name) {
  std::vector<std::string> result;
  for (const Atom& atom : read_text_as("a.pdb", remarks + kAtomsABC, assembly(name)).atoms)
    result.push_back(atom.chain + " " + std::to_string(static_cast<int>(atom.position.x)));
  return result;
}

TEST(PdbAssembly, GroupsOfChainsHaveTheirOwnOperators) {
  const std::string remarks =
      "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A,\n"
      "REMARK 350                    AND CHAINS: B\n" +
      biomt(1, kIdentity) + biomt(2, kShifted) + "REMARK 350 APPLY THE FOLLOWING TO CHAINS: C\n" +
      biomt(1, kShifted) +
      "REMARK 350 BIOMOLECULE: 2, 3\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: C\n" +
      biomt(1, kIdentity);
  EXPECT_THAT(copies(remarks, "1"), ElementsAre("A1 1", "B1 2", "A2 11", "B2 12", "C1 13"));
  EXPECT_THAT(copies(remarks, "2"), ElementsAre("C1 3"));
  EXPECT_THAT(copies(remarks, "3"), ElementsAre("C1 3"));
}

TEST(PdbAssembly, NumbersThatTouchAreReadByColumns) {
  const std::string remarks =
      "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n" +
      biomt(1, " -1.000000-0.000000 -0.000000      100.00000");
  EXPECT_THAT(copies(remarks, "1"), ElementsAre("A1 99"));
}

TEST(PdbAssembly, BrokenMatricesAreRefusedWithTheirLine) {
  const std::string head =
      "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n";
  const std::string whole = biomt(1, kIdentity);
  const std::size_t row = whole.size() / 3;
  const std::vector<std::array<std::string, 2>> cases{
      {head + biomt(1, "  1.000000  0.000000  0.000000        *******"),
       "line 3: the shift of BIOMT1"},
      {head + biomt(1, "  1.000000  nan       0.000000        0.00000"), "line 3: y of BIOMT1"},
      {head + whole.substr(0, 2 * row), "line 3: a matrix needs BIOMT1, BIOMT2 and BIOMT3"},
      {head + whole.substr(0, row) + whole.substr(2 * row), "line 3: 'BIOMT3' is out of its order"},
      {head + whole.substr(row), "line 3: 'BIOMT2' is out of its order"},
      {"REMARK 350 BIOMOLECULE: 1\n" + whole, "line 2: names no chains"}};
  for (const auto& [remarks, what] : cases) {
    SCOPED_TRACE(remarks);
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", remarks + kAtomsABC, assembly("1")),
                HasSubstr(std::string("a.pdb: ").append(what)));
    EXPECT_EQ(read_text_as("a.pdb", remarks + kAtomsABC).atoms.size(), 3U);
  }
}

// The operators of an entry, from the columns of its PDB file.
std::vector<Operator> operators_by_columns(const std::filesystem::path& path) {
  std::vector<Operator> operators;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("REMARK 350   BIOMT", 0) != 0) continue;
    if (line[18] == '1') operators.push_back({std::to_string(operators.size() + 1), ""});
    operators.back().numbers += line.substr(23, 45) + " ";
  }
  return operators;
}

TEST(Assembly, OfOneEntryIsTheSameInPdbAndMmCif) {
  VDWMESH_NEEDS_SHARED("molecules/special/1F2N.pdb");
  const auto path = shared_path("molecules/special/1F2N.pdb");
  std::ostringstream text;
  text << kAtomColumns;
  for (const Atom& atom : read_structure(path).atoms)
    text << "ATOM " << atom.serial << " " << atom.element << " \"" << atom.name << "\" "
         << atom.residue_name << " " << atom.chain << " . " << atom.chain << " "
         << atom.residue_number << " " << atom.position.x << " " << atom.position.y << " "
         << atom.position.z << "\n";
  const std::vector<Operator> operators = operators_by_columns(path);
  ASSERT_EQ(operators.size(), 60U);
  const Molecule of_pdb = read_structure(path, assembly("1"));
  const Molecule of_cif = read_text_as(
      "a.cif",
      text.str() + generators({{"1", "(1-60)", "A,B,C"}, {"2", "1-60", "A,B,C,D,E,F"}}) +
          operator_list(operators),
      assembly("1"));
  ASSERT_EQ(of_cif.atoms.size(), of_pdb.atoms.size());
  std::size_t equal = 0;
  for (std::size_t i = 0; i < of_pdb.atoms.size(); ++i)
    if (of_cif.atoms[i].position == of_pdb.atoms[i].position &&
        of_cif.atoms[i].chain == of_pdb.atoms[i].chain)
      ++equal;
  EXPECT_EQ(equal, of_pdb.atoms.size());
}

}  // namespace
}  // namespace vdwmesh::testing
