// Selections in words: what each selects of a small file is written beside it.
#include <gmock/gmock.h>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

// One atom of each: the atom's name and element, residue, chain and number.
std::string small_file() {
  struct Row {
    const char *record, *name, *residue;
    char chain;
    int number;
    char insertion;
    const char* element;
  };
  std::string text;
  int serial = 0;
  for (const Row& r : std::initializer_list<Row>{{"ATOM  ", " N  ", "ALA", 'A', -3, ' ', "N"},
                                                 {"ATOM  ", " H  ", "ALA", 'A', -3, ' ', "H"},
                                                 {"ATOM  ", " CA ", "GLY", 'A', 10, ' ', "C"},
                                                 {"ATOM  ", " CA ", "GLY", 'A', 10, 'B', "C"},
                                                 {"HETATM", "SE  ", "MSE", 'A', 11, ' ', "SE"},
                                                 {"ATOM  ", " CA ", "HID", 'B', 40, ' ', "C"},
                                                 {"ATOM  ", " P  ", " DA", 'C', 1, ' ', "P"},
                                                 {"HETATM", "FE  ", "HEM", 'B', 200, ' ', "FE"},
                                                 {"HETATM", "MG  ", " MG", 'B', 201, ' ', "MG"},
                                                 {"HETATM", " O  ", "HOH", 'B', 300, ' ', "O"}}) {
    ++serial;
    char line[96];
    std::snprintf(line, sizeof line,
                  "%s%5d %s %s %c%4d%c   %8.3f%8.3f%8.3f  1.00  0.00          %2s\n", r.record,
                  serial, r.name, r.residue, r.chain, r.number, r.insertion, 5.0 * serial, 0.0, 0.0,
                  r.element);
    text += line;
  }
  return text;
}

// The serial numbers of the selected atoms, as text.
std::string selected(const std::string& selection) {
  ReadOptions options;
  options.waters = Inclusion::keep;
  options.select = selection;
  std::string serials;
  for (const Atom& atom : read_text_as("a.pdb", small_file(), options).atoms)
    serials += std::to_string(atom.serial) + " ";
  return serials;
}

TEST(WordSelection, Kinds) {
  EXPECT_EQ(selected("protein"), "1 2 3 4 5 6 ");
  EXPECT_EQ(selected("nucleic"), "7 ");
  EXPECT_EQ(selected("ligand"), "8 9 ");
  EXPECT_EQ(selected("water"), "10 ");
  EXPECT_EQ(selected("hydrogen"), "2 ");
  EXPECT_EQ(selected("hetatm"), "5 8 9 10 ");
  EXPECT_EQ(selected("polymer"), "1 2 3 4 5 6 7 ");
  EXPECT_EQ(selected("backbone"), "1 3 4 6 ");
  EXPECT_EQ(selected("all"), "1 2 3 4 5 6 7 8 9 10 ");
}

TEST(WordSelection, Values) {
  EXPECT_EQ(selected("chain A"), "1 2 3 4 5 ");
  EXPECT_EQ(selected("chain C,A"), "1 2 3 4 5 7 ");
  EXPECT_EQ(selected("chain C A"), "1 2 3 4 5 7 ");
  EXPECT_EQ(selected("resn HEM+MG"), "8 9 ");
  EXPECT_EQ(selected("name CA"), "3 4 6 ");
  EXPECT_EQ(selected("name C*"), "3 4 6 ");
  EXPECT_EQ(selected("resn H*M *D"), "6 8 ");
  EXPECT_EQ(selected("element Mg"), "9 ");
  EXPECT_EQ(selected("element SE FE"), "5 8 ");
}

TEST(WordSelection, Numbers) {
  EXPECT_EQ(selected("resi 10"), "3 ");
  EXPECT_EQ(selected("resi 10B"), "4 ");
  EXPECT_EQ(selected("resi 10-40"), "3 4 5 6 ");
  EXPECT_EQ(selected("resid 10 to 40"), "3 4 5 6 ");
  EXPECT_EQ(selected("resid 10:11 200"), "3 4 5 8 ");
  EXPECT_EQ(selected("resi -3"), "1 2 ");
  EXPECT_EQ(selected("resi -3-1"), "1 2 7 ");
  EXPECT_EQ(selected("resi -5--1"), "1 2 ");
}

TEST(WordSelection, NotBindsClosestThenAnd) {
  EXPECT_EQ(selected("not protein and chain B"), "8 9 10 ");
  EXPECT_EQ(selected("not (protein and chain B)"), "1 2 3 4 5 7 8 9 10 ");
  EXPECT_EQ(selected("nucleic or protein and chain B"), "6 7 ");
  EXPECT_EQ(selected("(nucleic or protein) and chain B"), "6 ");
  EXPECT_EQ(selected("NOT Protein AND not hetatm"), "7 ");
  EXPECT_EQ(selected("not not water"), "10 ");
}

// Words that gemmi's syntax has keep its meaning.
TEST(WordSelection, SyntaxOfGemmiStays) {
  EXPECT_EQ(selected("B/40"), "6 ");
  EXPECT_EQ(selected("(HEM)"), "8 ");
  EXPECT_EQ(selected("A"), "1 2 3 4 5 ");
}

TEST(WordSelection, WhatIsNoSelection) {
  for (const char* bad :
       {"chain", "protein and", "(protein", "protein)", "resi ten", "chain A or", "resi 10-", "not",
        "chain A resi 10", "protein water", "name CA or or name N"}) {
    ReadOptions options;
    options.select = bad;
    EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", small_file(), options),
                HasSubstr("chain A and resi 10-40"))
        << bad;
  }
}

TEST(WordSelection, WhatThereIsIsListed) {
  ReadOptions options;
  options.select = "chain Z";
  const std::string refusal = refusal_of_text<InvalidInput>("a.pdb", small_file(), options);
  EXPECT_THAT(refusal, HasSubstr("'chain Z' matches none of the 9 atoms"));
  EXPECT_THAT(refusal, HasSubstr("chains A (-3-11), B (40), C (1); residues HEM, MG"));
  EXPECT_THAT(refusal, HasSubstr("--waters"));
  options.select = "name ca";
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", small_file(), options),
              HasSubstr("'NAME CA' matches some; there are"));
}

}  // namespace
}  // namespace vdwmesh::testing
