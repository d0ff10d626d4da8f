// Which atoms are of one residue where a file repeats the number and the name of a residue.
// Expected values follow from the molecules that the names and distances are those of.
#include <gmock/gmock.h>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

struct Listed {
  const char* name;  // in columns 13-16
  double x;          // Å
  char label = ' ';
};

std::string line(const Listed& atom, const char* residue, int number) {
  char text[96];
  std::snprintf(text, sizeof text, "ATOM      1 %-4s%c%3s A%4d    %8.3f%8.3f%8.3f  1.00 10.00\n",
                atom.name, atom.label, residue, number, atom.x, 0.0, 0.0);
  return text;
}

ReadOptions all_of_the_file() {
  ReadOptions options;
  options.waters = Inclusion::keep;
  options.altloc = "all";
  return options;
}

std::vector<std::uint32_t> residues_of(const std::string& file, const std::string& text) {
  std::vector<std::uint32_t> numbers;
  for (const Atom& atom : read_text_as(file, text, all_of_the_file()).atoms)
    numbers.push_back(atom.residue);
  return numbers;
}

// Of atoms that stand together in residues of this name, all with number 1.
std::vector<std::uint32_t> residues_of(const char* residue, const std::vector<Listed>& atoms) {
  std::string text;
  for (const Listed& atom : atoms) text += line(atom, residue, 1);
  return residues_of("a.pdb", text);
}

using Numbers = std::vector<std::uint32_t>;

TEST(Residues, OfOneNumberBeginWhereTheFirstNameComesAgain) {
  EXPECT_EQ(residues_of("HOH", {{" O  ", 0}, {" O  ", 3}, {" O  ", 6}}), (Numbers{0, 1, 2}));
  EXPECT_EQ(residues_of("HOH", {{" O  ", 0}, {" H1 ", 1}, {" H2 ", 2}, {" O  ", 3}, {" H1 ", 4}}),
            (Numbers{0, 0, 0, 1, 1}));
  EXPECT_EQ(residues_of("HOH", {{" O  ", 0}, {" H  ", 1}, {" H  ", 2}, {" O  ", 3}, {" H  ", 4}}),
            (Numbers{0, 0, 0, 1, 1}));
  EXPECT_EQ(residues_of("GLY", {{" N  ", 0},
                                {" CA ", 1.5},
                                {" C  ", 2.5},
                                {" N  ", 3.8},
                                {" CA ", 5.3},
                                {" C  ", 6.5},
                                {" OXT", 7.5}}),
            (Numbers{0, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(residues_of("ALA", {{" CA ", 0}, {" CA ", 3.8}}), (Numbers{0, 1}));
  EXPECT_EQ(residues_of("NA", {{"NA  ", 0}, {"NA  ", 5}}), (Numbers{0, 1}));
  EXPECT_EQ(residues_of("LIG", {{" C1 ", 0}, {" O1 ", 1.4}, {" C1 ", 9}, {" O1 ", 10.4}}),
            (Numbers{0, 0, 1, 1}));
}

// Programs that know no names call atoms by their elements.
TEST(Residues, OfMoleculesWhoseNamesAreNotUniqueAreOne) {
  EXPECT_EQ(residues_of("UNL", {{" C  ", 0}, {" C  ", 1.6}, {" H  ", 3}, {" H  ", 4}}),
            Numbers(4, 0));
  EXPECT_EQ(residues_of("UNL", {{" C  ", 0}, {" O  ", 1.3}, {" C  ", 2.6}, {" O  ", 4}}),
            Numbers(4, 0));
  EXPECT_EQ(residues_of("UNL", {{" C  ", 0}, {" C  ", 1.6}, {" C  ", 3.2}}), Numbers(3, 0));
  EXPECT_EQ(residues_of("LIG", {{" C1 ", 0}, {" C1 ", 2}, {" C1 ", 4}}), Numbers(3, 0));
  EXPECT_EQ(residues_of("UNK", {{" C  ", 0}, {" C  ", 2.1}}), Numbers(2, 0));
  EXPECT_EQ(residues_of("ALA", {{" C  ", 0}, {" N  ", 1.5}, {" C  ", 2.4}, {" O  ", 3.6}}),
            Numbers(4, 0));
  const Molecule spheres = read_text_as("a.xyzr", "0 0 0 1\n4 0 0 1\n8 0 0 1\n");
  for (const Atom& sphere : spheres.atoms) EXPECT_EQ(sphere.residue, spheres.atoms[0].residue);
}

TEST(Residues, WithSeveralLocationsAreOne) {
  EXPECT_EQ(residues_of("HOH", {{" O  ", 0, 'A'}, {" O  ", 3, 'B'}}), Numbers(2, 0));
  EXPECT_EQ(residues_of("GLY", {{" N  ", 0}, {" CA ", 1.5, 'A'}, {" CA ", 3.5, 'B'}}),
            Numbers(3, 0));
  // Without labels: a side chain in two places, and a whole residue in two.
  EXPECT_EQ(residues_of("SER", {{" N  ", 0}, {" CA ", 1.5}, {" OG ", 3}, {" OG ", 5.4}}),
            Numbers(4, 0));
  EXPECT_EQ(residues_of("GLY", {{" N  ", 0}, {" CA ", 1.5}, {" N  ", 0.4}, {" CA ", 1.9}}),
            Numbers(4, 0));
}

TEST(Residues, ThatStandTwiceInOnePlaceAreOneAndTold) {
  const std::string text = line({" O  ", 0}, "HOH", 1) + line({" O  ", 0}, "HOH", 1);
  const Molecule molecule = read_text_as("a.pdb", text, all_of_the_file());
  EXPECT_EQ(molecule.atoms.at(1).residue, molecule.atoms.at(0).residue);
  ASSERT_FALSE(molecule.warnings.empty());
  EXPECT_THAT(molecule.warnings[0], HasSubstr("1 atoms lie where another one does"));
}

TEST(Residues, ComeAgainNextToOthersAndBehindThem) {
  const Listed water{" O  ", 0}, next{" O  ", 3}, ion{"ZN  ", 6}, last{" O  ", 9};
  EXPECT_EQ(residues_of("a.pdb", line(water, "HOH", 1) + line(next, "HOH", 1) + line(ion, "ZN", 2) +
                                     line(last, "HOH", 1)),
            (Numbers{0, 1, 2, 3}));
}

TEST(Residues, OfOtherFormatsFollowTheSameRule) {
  EXPECT_EQ(residues_of("a.pqr", "ATOM 1 O WAT 1 0 0 0 0 1.5\nATOM 2 O WAT 1 3 0 0 0 1.5\n"),
            (Numbers{0, 1}));
  EXPECT_EQ(residues_of("a.cif",
                        "data_x\nloop_\n_atom_site.type_symbol\n_atom_site.label_atom_id\n"
                        "_atom_site.label_comp_id\n_atom_site.label_asym_id\n"
                        "_atom_site.label_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n"
                        "_atom_site.Cartn_z\nO O HOH A . 0 0 0\nO O HOH A . 3 0 0\n"),
            (Numbers{0, 1}));
}

}  // namespace
}  // namespace vdwmesh::testing
