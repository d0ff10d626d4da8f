#include "structure/radii.hpp"

#include <gmock/gmock.h>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> kElements{
    "H",  "He", "Li", "Be", "B",  "C",  "N",  "O",  "F",  "Ne", "Na", "Mg", "Al", "Si", "P",
    "S",  "Cl", "Ar", "K",  "Ca", "Sc", "Ti", "V",  "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn",
    "Ga", "Ge", "As", "Se", "Br", "Kr", "Rb", "Sr", "Y",  "Zr", "Nb", "Mo", "Tc", "Ru", "Rh",
    "Pd", "Ag", "Cd", "In", "Sn", "Sb", "Te", "I",  "Xe", "Cs", "Ba", "La", "Ce", "Pr", "Nd",
    "Pm", "Sm", "Eu", "Gd", "Tb", "Dy", "Ho", "Er", "Tm", "Yb", "Lu", "Hf", "Ta", "W",  "Re",
    "Os", "Ir", "Pt", "Au", "Hg", "Tl", "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra", "Ac", "Th",
    "Pa", "U",  "Np", "Pu", "Am", "Cm", "Bk", "Cf", "Es", "Fm", "Md", "No", "Lr"};

double radius(const RadiusTable& table, const char* element) {
  const auto entry = table.find("", "", element);
  return entry ? entry->radius : -1;
}

// Mantina et al., J. Phys. Chem. A 113 (2009) 5806: "Bondi recommended radius values for only 28
// of the 44 main-group elements"; with Ni Cu Zn Pd Ag Cd Pt Au Hg U of his Table XIV, 38.
TEST(RadiusTable, BondiListsThirtyEightElements) {
  const RadiusTable bondi = RadiusTable::named("bondi");
  int listed = 0;
  for (const std::string& element : kElements) {
    const auto entry = bondi.find("", "", element);
    if (entry && !entry->assumed) ++listed;
  }
  EXPECT_EQ(listed, 38);
}

// The abstract of the paper: "93 elements".
TEST(RadiusTable, AlvarezListsNinetyThreeElements) {
  const RadiusTable alvarez = RadiusTable::named("alvarez");
  int listed = 0;
  for (const std::string& element : kElements) {
    const auto entry = alvarez.find("", "", element);
    if (!entry) continue;
    EXPECT_FALSE(entry->assumed);
    ++listed;
  }
  EXPECT_EQ(listed, 93);
}

TEST(RadiusTable, ValuesOfThePapers) {
  const RadiusTable bondi = RadiusTable::named("bondi"), alvarez = RadiusTable::named("alvarez");
  EXPECT_EQ(radius(bondi, "H"), 1.20);
  EXPECT_EQ(radius(bondi, "C"), 1.70);
  EXPECT_EQ(radius(bondi, "N"), 1.55);
  EXPECT_EQ(radius(bondi, "O"), 1.52);
  EXPECT_EQ(radius(bondi, "P"), 1.80);
  EXPECT_EQ(radius(bondi, "S"), 1.80);
  EXPECT_EQ(radius(bondi, "Mg"), 1.73);
  EXPECT_EQ(radius(bondi, "Zn"), 1.39);
  EXPECT_EQ(radius(bondi, "Se"), 1.90);
  EXPECT_EQ(radius(alvarez, "H"), 1.20);
  EXPECT_EQ(radius(alvarez, "He"), 1.43);
  EXPECT_EQ(radius(alvarez, "C"), 1.77);
  EXPECT_EQ(radius(alvarez, "Zn"), 2.39);
  EXPECT_EQ(radius(alvarez, "Cs"), 3.48);
  EXPECT_EQ(radius(alvarez, "Es"), 2.70);
  for (const char* unlisted : {"Pm", "Po", "At", "Rn", "Fr", "Ra", "Fm"})
    EXPECT_FALSE(alvarez.find("", "", unlisted)) << unlisted;
}

TEST(RadiusTable, BondiIsCompletedFromAlvarez) {
  const RadiusTable bondi = RadiusTable::named("bondi"), alvarez = RadiusTable::named("alvarez");
  for (const char* element : {"Be", "Al", "Ca", "Mn", "Fe", "Co", "Cs", "Gd", "W"}) {
    ASSERT_TRUE(bondi.find("", "", element)) << element;
    EXPECT_TRUE(bondi.find("", "", element)->assumed) << element;
    EXPECT_EQ(radius(bondi, element), radius(alvarez, element)) << element;
  }
}

TEST(RadiusTable, DeuteriumIsHydrogenUnlessGiven) {
  EXPECT_EQ(radius(RadiusTable::named("bondi"), "D"), 1.20);
  const TemporaryDirectory dir;
  EXPECT_EQ(radius(RadiusTable::from_file(dir.write("r", "H 1.1\nD 1.3\n")), "D"), 1.3);
  EXPECT_EQ(radius(RadiusTable::from_file(dir.write("r", "H 1.1\n")), "D"), 1.1);
}

TEST(RadiusTable, AtomLinesWin) {
  const TemporaryDirectory dir;
  const RadiusTable table = RadiusTable::from_file(
      dir.write("r", "# mine\nALA CA 2.0  # this one\r\nC 1.7\n\nzn 1.1\nALA CA 2.0\n"));
  EXPECT_EQ(table.find("ALA", "CA", "C")->radius, 2.0);
  EXPECT_EQ(table.find("GLY", "CA", "C")->radius, 1.7);
  EXPECT_EQ(table.find("ZN", "ZN", "Zn")->radius, 1.1);
  EXPECT_FALSE(table.find("ALA", "N", "N"));
}

TEST(RadiusTable, BadLinesAreRefusedWithTheirNumber) {
  const TemporaryDirectory dir;
  for (const char* bad : {"C", "C x", "C -1", "C nan", "Qq 1.5", "ALA CA CB 1", "ALA CA 1.5x"}) {
    const auto path = dir.write("r", std::string("# radii\nC 1.7\n") + bad + "\n");
    try {
      RadiusTable::from_file(path);
      ADD_FAILURE() << bad;
    } catch (const FileFormatError& error) {
      EXPECT_THAT(error.what(), HasSubstr("r:3: ")) << bad;
    }
  }
  EXPECT_THROW(RadiusTable::from_file(dir.write("r", "# nothing\n")), FileFormatError);
  for (const char* twice : {"C 1.7\nN 1.5\nc 1.8\n", "ALA CA 1.7\nC 1.6\nALA CA 1.8\n"}) {
    try {
      RadiusTable::from_file(dir.write("r", twice));
      ADD_FAILURE() << twice;
    } catch (const FileFormatError& error) {
      EXPECT_THAT(error.what(), HasSubstr("has radius 1.8 here and 1.7 in line 1")) << twice;
      EXPECT_THAT(error.what(), HasSubstr("r:3: ")) << twice;
    }
  }
  EXPECT_THROW(RadiusTable::named("pauling"), InvalidInput);
}

TEST(RadiusTable, UnitedAtomsGoByResidueAndAtom) {
  for (const char* name : {"protor", "naccess", "oons"}) {
    const RadiusTable table = RadiusTable::named(name);
    EXPECT_TRUE(table.has_united_atoms());
    EXPECT_FALSE(table.find("ALA", "HA", "H")) << name;  // part of CA
    EXPECT_FALSE(table.find("ALA", "DA", "D")) << name;
    const auto listed = table.find("ALA", "O", "O"), renamed = table.find("HIE", "CG", "C"),
               lacking = table.find("HEM", "CHA", "C"), unknown = table.find("", "", "C");
    ASSERT_TRUE(listed && renamed && lacking && unknown) << name;
    EXPECT_EQ(listed->polarity, Polarity::polar);
    EXPECT_FALSE(listed->assumed || listed->renamed);
    EXPECT_TRUE(renamed->renamed);
    EXPECT_EQ(renamed->radius, table.find("HIS", "CG", "C")->radius);
    for (const auto& entry : {lacking, unknown}) {
      EXPECT_EQ(entry->radius, 1.70) << name;  // Bondi 1964
      EXPECT_TRUE(entry->assumed);
      EXPECT_EQ(entry->polarity, Polarity::unknown);
    }
  }
  for (const char* name : {"bondi", "alvarez"}) {
    const RadiusTable table = RadiusTable::named(name);
    EXPECT_FALSE(table.has_united_atoms());
    EXPECT_EQ(table.find("ALA", "O", "O")->polarity, Polarity::unknown);
  }
}

// Table 2 of Tsai et al. 1999.
TEST(RadiusTable, ProtOrOfThePaper) {
  const RadiusTable table = RadiusTable::named("protor");
  EXPECT_EQ(table.find("TYR", "CZ", "C")->radius, 1.61);   // C3H0
  EXPECT_EQ(table.find("TYR", "CE1", "C")->radius, 1.76);  // C3H1
  EXPECT_EQ(table.find("LEU", "CD1", "C")->radius, 1.88);  // C4H3
  EXPECT_EQ(table.find("LYS", "NZ", "N")->radius, 1.64);   // N4H3
  EXPECT_EQ(table.find("GLY", "O", "O")->radius, 1.42);    // O1H0
  EXPECT_EQ(table.find("SER", "OG", "O")->radius, 1.46);   // O2H1
  EXPECT_EQ(table.find("MET", "SD", "S")->radius, 1.77);   // S2H0
}

TEST(RadiusTable, TheNamesAreThoseOfTheSets) {
  EXPECT_THAT(RadiusTable::names(),
              ::testing::ElementsAre("bondi", "alvarez", "protor", "naccess", "oons"));
  for (const std::string& name : RadiusTable::names())
    EXPECT_NO_THROW(RadiusTable::named(name)) << name;
}

TEST(RadiusTable, FilesAddToASetAndTheLaterOneWins) {
  const TemporaryDirectory dir;
  const std::string first = dir.write("a", "\xEF\xBB\xBFZN 2.5\nALA CA 3\n").string(),
                    second = dir.write("b", "C 1.9\n").string();
  const RadiusTable table = RadiusTable::from_list("bondi," + first);
  EXPECT_EQ(radius(table, "Zn"), 2.5);
  EXPECT_EQ(radius(table, "C"), 1.70);
  EXPECT_EQ(table.find("ALA", "CA", "C")->radius, 3);
  const RadiusTable both = RadiusTable::from_list("protor," + first + "," + second);
  EXPECT_EQ(both.find("ALA", "CA", "C")->radius, 1.9);
  EXPECT_EQ(both.find("ALA", "N", "N")->radius,
            RadiusTable::named("protor").find("ALA", "N", "N")->radius);
  EXPECT_THROW(RadiusTable::from_list(first + ",bondi"), InvalidInput);
  EXPECT_THROW(RadiusTable::from_list("bondi,"), InvalidInput);
}

TEST(Radii, LinesThatNoAtomUsesAreNamed) {
  const TemporaryDirectory dir;
  ReadOptions options;
  options.radii = "bondi," + dir.write("mine", "THR CA 2\nthr CA 2.5\n").string();
  const char* atom =
      "ATOM      1  CA  THR A   1       0.000   0.000   0.000  1.00  0.00           ";
  const Molecule molecule = read_text_as("a.pdb", std::string(atom) + "C\n", options);
  EXPECT_EQ(molecule.atoms.at(0).radius, 2);
  ASSERT_EQ(molecule.notes.size(), 1U);
  EXPECT_THAT(molecule.notes[0], HasSubstr("mine:2 (thr CA)"));
  // What helps an unknown element works.
  options.radii = dir.write("alone", "C 1.7\n").string();
  EXPECT_THAT(refusal_of_text<InvalidInput>(
                  "a.pdb", std::string(atom).replace(17, 3, "LIG") + "N\n", options),
              HasSubstr("give --radii bondi," + options.radii));
}

TEST(Radii, AreRefusedBesideThoseOfTheFile) {
  ReadOptions options;
  options.radii = "bondi";
  for (const auto& [name, text] :
       {std::pair{"a.xyzr", "0 0 0 1\n"}, {"a.pqr", "ATOM 1 N MET 1 -6.4 5.5 -3.3 -0.3 1.85\n"}})
    EXPECT_THAT(refusal_of_text<InvalidInput>(name, text, options), HasSubstr("leave out --radii"));
  options = {};
  options.waters = Inclusion::keep;
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.xyzr", "0 0 0 1\n", options), HasSubstr("--waters"));
  options = {};
  options.hydrogens = Inclusion::drop;
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.xyzr", "0 0 0 1\n", options),
              HasSubstr("--no-hydrogens"));
}

TEST(RadiusTable, UnknownSetIsRefused) {
  ReadOptions options;
  options.radii = "bondy";
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.xyzr", "0 0 0 1\n", options), HasSubstr("alvarez"));
}

}  // namespace
}  // namespace vdwmesh::testing
