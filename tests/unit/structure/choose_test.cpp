#include <gmock/gmock.h>

#include <algorithm>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

// A record of a PDB file, as far as the tests vary it.
struct Line {
  const char* name;  // four columns
  const char* residue = "ALA";
  int number = 1;
  char altloc = ' ';
  double occupancy = 1;
  char chain = 'A';
  const char* kind = "ATOM  ";
  double x = 0;  // Å
};

std::string pdb(const std::vector<Line>& lines) {
  std::string text;
  for (const Line& line : lines) {
    char buffer[96];
    std::snprintf(buffer, sizeof buffer, "%s%5d %s%c%3s %c%4d    %8.3f%8.3f%8.3f%6.2f\n", line.kind,
                  1, line.name, line.altloc, line.residue, line.chain, line.number, line.x, 0.0,
                  0.0, line.occupancy);
    text += buffer;
  }
  return text;
}

// "name residue" of each atom, to compare at a glance.
std::vector<std::string> left(const std::vector<Line>& lines, const ReadOptions& options = {}) {
  std::vector<std::string> names;
  for (const Atom& atom : read_text_as("a.pdb", pdb(lines), options).atoms)
    names.push_back(atom.name + " " + atom.residue_name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Waters, AreDroppedByNameUnlessKept) {
  std::vector<Line> lines{{" N  "}};
  for (const char* name : {"HOH", "DOD", "WAT", "H2O", "SOL", "TIP", "SPC"})
    lines.push_back({" O  ", name, static_cast<int>(lines.size()) + 1});
  EXPECT_EQ(left(lines), Names{"N ALA"});
  ReadOptions options;
  options.waters = Inclusion::keep;
  EXPECT_EQ(left(lines, options).size(), lines.size());
}

TEST(Waters, NamesOfOtherThingsAreJudgedByTheirAtoms) {
  EXPECT_EQ(left({{" C1 ", "SOL"}, {" O1 ", "SOL"}}).size(), 2U);
  EXPECT_EQ(left({{" O1 ", "SOL"}, {" O2 ", "SOL"}, {" H1 ", "SOL"}}).size(), 3U);
  EXPECT_EQ(left({{" N  "}, {" OW ", "SOL", 2}, {" HW1", "SOL", 2}, {" HW2", "SOL", 2}}),
            Names{"N ALA"});
}

TEST(Kinds, AreCountedOnceInOrder) {
  ReadOptions options;
  options.hydrogens = Inclusion::drop;
  options.hetero_atoms = Inclusion::drop;
  const Molecule molecule = read_text_as("a.pdb",
                                         pdb({{" N  "},
                                              {" H  "},
                                              {" O  ", "HOH", 2, ' ', 1, 'A', "HETATM"},
                                              {" H1 ", "HOH", 2, ' ', 1, 'A', "HETATM"},
                                              {" H1 ", "LIG", 3, ' ', 1, 'A', "HETATM"},
                                              {" C1 ", "LIG", 3, ' ', 1, 'A', "HETATM"}}),
                                         options);
  EXPECT_EQ(molecule.atoms_used, 1U);
  EXPECT_EQ(molecule.skipped, (SkippedAtoms{{"waters", 2}, {"hydrogens", 2}, {"hetatm", 1}}));
}

const std::vector<Line> kTwoConformers{{" N  "},
                                       {" CA ", "ALA", 1, 'A', 0.6, 'A', "ATOM  ", 1},
                                       {" CA ", "ALA", 1, 'B', 0.4, 'A', "ATOM  ", 2},
                                       {" CB ", "ALA", 1, 'A', 0.1, 'A', "ATOM  ", 3},
                                       {" CB ", "ALA", 1, 'B', 0.9, 'A', "ATOM  ", 4}};

std::vector<double> positions(const std::vector<Line>& lines, const ReadOptions& options = {}) {
  std::vector<double> x;
  for (const Atom& atom : read_text_as("a.pdb", pdb(lines), options).atoms)
    x.push_back(atom.position.x);
  return x;
}

TEST(AlternateLocations, OneLabelPerResidueByMeanOccupancy) {
  // Means 0.35 and 0.65, so B although CA alone would choose A.
  EXPECT_EQ(positions(kTwoConformers), (std::vector<double>{0, 2, 4}));
}

TEST(AlternateLocations, TiesGoToTheFirstInTheFile) {
  EXPECT_EQ(positions({{" CA ", "ALA", 1, 'B', 0.5, 'A', "ATOM  ", 1},
                       {" CA ", "ALA", 1, 'A', 0.5, 'A', "ATOM  ", 2}}),
            std::vector<double>{1});
}

TEST(AlternateLocations, AreChosenPerResidue) {
  EXPECT_EQ(positions({{" CA ", "ALA", 1, 'A', 0.6, 'A', "ATOM  ", 1},
                       {" CA ", "ALA", 1, 'B', 0.4, 'A', "ATOM  ", 2},
                       {" CA ", "ALA", 2, 'A', 0.4, 'A', "ATOM  ", 3},
                       {" CA ", "ALA", 2, 'B', 0.6, 'A', "ATOM  ", 4}}),
            (std::vector<double>{1, 4}));
}

TEST(AlternateLocations, AtomsOfTheOtherLabelAloneAreKept) {
  // B has the higher mean; HB1 stands under A alone, HB2 under A and C, of which C is the higher,
  // and twice under C. CB of A goes, since B has one.
  const std::vector<Line> lines{{" N  "},
                                {" CB ", "ALA", 1, 'A', 0.2, 'A', "ATOM  ", 1},
                                {" CB ", "ALA", 1, 'B', 0.6, 'A', "ATOM  ", 2},
                                {" HB1", "ALA", 1, 'A', 0.2, 'A', "ATOM  ", 3},
                                {" HB2", "ALA", 1, 'A', 0.2, 'A', "ATOM  ", 4},
                                {" HB2", "ALA", 1, 'C', 0.3, 'A', "ATOM  ", 5},
                                {" HB2", "ALA", 1, 'C', 0.3, 'A', "ATOM  ", 6}};
  EXPECT_EQ(positions(lines), (std::vector<double>{0, 2, 3, 5, 6}));
  EXPECT_EQ(read_text_as("a.pdb", pdb(lines)).skipped, (SkippedAtoms{{"alternate_locations", 2}}));
  ReadOptions options;
  options.altloc = "B";  // what was asked for, and nothing else
  EXPECT_EQ(positions(lines, options), (std::vector<double>{0, 2}));
}

// Seen in a deposited entry: a side chain of two conformations, 0.44 and 0.56, and a hydrogen of
// the backbone with occupancy 1.00 under A alone.
TEST(AlternateLocations, AWholeAtomUnderOneLabelIsNotLost) {
  EXPECT_EQ(left({{" HA ", "SER", 1, 'A', 1.00},
                  {" CB ", "SER", 1, 'A', 0.44},
                  {" CB ", "SER", 1, 'B', 0.96},
                  {" OG ", "SER", 1, 'A', 0.44},
                  {" OG ", "SER", 1, 'B', 0.96}}),
            (Names{"HA SER", "CB SER", "OG SER"}));
}

// The first conformation has no label: CZ of it must not stand beside that of B.
TEST(AlternateLocations, APartialAtomWithoutALabelMakesWayForItsTwin) {
  const std::vector<Line> lines{{" NE ", "ARG", 1, ' ', 0.5, 'A', "ATOM  ", 1},
                                {" CZ ", "ARG", 1, ' ', 0.5, 'A', "ATOM  ", 2},
                                {" CZ ", "ARG", 1, 'B', 0.5, 'A', "ATOM  ", 3},
                                {" NH1", "ARG", 1, 'A', 0.4, 'A', "ATOM  ", 4},
                                {" NH1", "ARG", 1, 'B', 0.5, 'A', "ATOM  ", 5}};
  EXPECT_EQ(positions(lines), (std::vector<double>{1, 3, 5}));
  EXPECT_EQ(read_text_as("a.pdb", pdb(lines)).skipped, (SkippedAtoms{{"alternate_locations", 2}}));
  ReadOptions options;
  options.altloc = "A";
  EXPECT_EQ(positions(lines, options), (std::vector<double>{1, 2, 4}));
  // Two whole atoms of one name are two atoms.
  EXPECT_EQ(positions({{" O  ", "UNL", 1, ' ', 1, 'A', "ATOM  ", 1},
                       {" O  ", "UNL", 1, 'B', 0.5, 'A', "ATOM  ", 2}}),
            (std::vector<double>{1, 2}));
}

TEST(AlternateLocations, ALabelMayBeAskedFor) {
  ReadOptions options;
  options.altloc = "A";
  EXPECT_EQ(positions(kTwoConformers, options), (std::vector<double>{0, 1, 3}));
  options.altloc = "all";
  EXPECT_EQ(positions(kTwoConformers, options), (std::vector<double>{0, 1, 2, 3, 4}));
  options.altloc = "C";
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", pdb(kTwoConformers), options),
              HasSubstr("there are A B"));
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", pdb({{" N  "}}), options),
              HasSubstr("the file has none"));
}

TEST(Microheterogeneity, OneResidueStays) {
  const std::vector<Line> lines{{" CA ", "SER", 1, 'A', 0.3},
                                {" OG ", "SER", 1, 'A', 0.3},
                                {" CA ", "THR", 1, 'B', 0.7},
                                {" CB ", "THR", 1, 'B', 0.7}};
  EXPECT_EQ(left(lines), (Names{"CA THR", "CB THR"}));
  EXPECT_EQ(read_text_as("a.pdb", pdb(lines)).skipped, (SkippedAtoms{{"microheterogeneity", 2}}));
}

TEST(Microheterogeneity, ConformersOfOneOfTheResidues) {
  // Means: A 0.2 and C 0.3 (SER), B 0.5 (THR).
  const std::vector<Line> lines{
      {" CA ", "SER", 1, 'A', 0.2}, {" CA ", "SER", 1, 'C', 0.3}, {" CA ", "THR", 1, 'B', 0.5}};
  EXPECT_EQ(left(lines), Names{"CA THR"});
  ReadOptions options;
  options.altloc = "C";
  EXPECT_EQ(read_text_as("a.pdb", pdb(lines), options).skipped,
            (SkippedAtoms{{"alternate_locations", 1}, {"microheterogeneity", 1}}));
}

TEST(Microheterogeneity, AtomsAreNotTakenFromTheResidueThatGoes) {
  const std::vector<Line> lines{{" CA ", "SER", 1, 'A', 0.3},
                                {" OG ", "SER", 1, 'A', 0.3},
                                {" CA ", "THR", 1, 'B', 0.4},
                                {" CB ", "THR", 1, 'C', 0.3}};
  EXPECT_EQ(left(lines), (Names{"CA THR", "CB THR"}));
  EXPECT_EQ(read_text_as("a.pdb", pdb(lines)).skipped, (SkippedAtoms{{"microheterogeneity", 2}}));
}

// A residue of which an atom has no label is there in any case: only its labels are chosen among.
TEST(Microheterogeneity, AResidueThatIsPartlyUnlabelledStays) {
  const std::vector<Line> lines{{" N  ", "SER", 1},
                                {" CA ", "SER", 1, 'A', 0.3},
                                {" CA ", "THR", 1, 'B', 0.7},
                                {" CB ", "THR", 1, 'B', 0.7}};
  EXPECT_EQ(left(lines), (Names{"N SER", "CA THR", "CB THR"}));
  EXPECT_EQ(read_text_as("a.pdb", pdb(lines)).skipped, (SkippedAtoms{{"alternate_locations", 1}}));
}

TEST(Microheterogeneity, SharedNumbersWithoutLabelsAreKept) {
  EXPECT_EQ(left({{" CA ", "SER", 1}, {" CA ", "THR", 1}}).size(), 2U);
}

// gemmi gives an atom 20 Å² where the file has no temperature factor, and selections ask gemmi.
TEST(Selection, ByTemperatureFactorWhereTheFormatHasNone) {
  for (const auto& [select, used] : {std::pair{";b>19.9", 2U}, {";b<20.1", 2U}}) {
    ReadOptions options;
    options.select = select;
    const Molecule pqr = read_text_as("a.pqr",
                                      "ATOM 1 N MET 1 -6.4 5.5 -3.3 -0.3 1.85\n"
                                      "ATOM 2 CA MET 1 1.0 2.0 3.0 0.1 2.275\n",
                                      options);
    EXPECT_EQ(pqr.atoms_used, used) << select;
    EXPECT_EQ(read_text_as("a.xyzr", "0 0 0 1\n3 0 0 1\n", options).atoms_used, used) << select;
  }
}

TEST(Selection, ComesAfterTheWaterRule) {
  ReadOptions options;
  options.select = "A/2-3/CA,CB";
  const Molecule molecule = read_text_as("a.pdb",
                                         pdb({{" CA ", "ALA", 1},
                                              {" CA ", "ALA", 2},
                                              {" C  ", "ALA", 2},
                                              {" CB ", "ALA", 3},
                                              {" O  ", "HOH", 3},
                                              {" CA ", "ALA", 2, ' ', 1, 'B'}}),
                                         options);
  EXPECT_EQ(molecule.atoms_used, 2U);
  EXPECT_EQ(molecule.skipped, (SkippedAtoms{{"waters", 1}, {"not_selected", 3}}));
}

// As in the syntax of MMDB: https://www.ccp4.ac.uk/html/pdbcur.html
TEST(Selection, ASingleNumberIsOneResidue) {
  const std::vector<Line> lines{{" CA ", "ALA", 9}, {" CA ", "GLY", 10}, {" CA ", "SER", 11}};
  ReadOptions options;
  const auto chosen = [&](const char* text) {
    options.select = text;
    return left(lines, options);
  };
  EXPECT_EQ(chosen("A/10"), Names{"CA GLY"});
  EXPECT_EQ(chosen("/1/A/10/CA[C];q>-1"), Names{"CA GLY"});
  EXPECT_EQ(chosen("A/10-"), (Names{"CA GLY", "CA SER"}));
  EXPECT_EQ(chosen("A/-10"), (Names{"CA ALA", "CA GLY"}));
  EXPECT_EQ(chosen("A/9-10"), (Names{"CA ALA", "CA GLY"}));
  EXPECT_EQ(chosen("A/(SER)"), Names{"CA SER"});
}

// What "-10" means depends on the file, so the program says it where it is no single residue.
TEST(Selection, AnOpenBeginningIsTold) {
  const auto warnings = [](const char* text, int first) {
    ReadOptions options;
    options.select = text;
    const Molecule molecule =
        read_text_as("a.pdb", pdb({{" N  ", "ALA", first}, {" N  ", "GLY", 10}}), options);
    return std::ranges::count_if(molecule.warnings, [](const std::string& warning) {
      return warning.find("all residues up to that number") != warning.npos;
    });
  };
  EXPECT_EQ(warnings("A/-10", 9), 1);
  EXPECT_EQ(warnings("A/*-10", 9), 0);
  EXPECT_EQ(warnings("A/-3", -3), 0);
  EXPECT_EQ(warnings("A/9-10", 9), 0);
}

TEST(Selection, NegativeNumbers) {
  const std::vector<Line> lines{{" CA ", "ALA", -3}, {" CA ", "GLY", -1}, {" CA ", "SER", 3}};
  const auto chosen = [&](const char* text) {
    ReadOptions options;
    options.select = text;
    return left(lines, options);
  };
  EXPECT_EQ(chosen("A/-3"), Names{"CA ALA"});
  EXPECT_EQ(chosen("-1"), Names{"CA GLY"});
  EXPECT_EQ(chosen("A/-3--1/CA"), (Names{"CA ALA", "CA GLY"}));
  EXPECT_EQ(chosen("A/-1-3"), (Names{"CA GLY", "CA SER"}));
  EXPECT_EQ(chosen("/1/A/-1-"), (Names{"CA GLY", "CA SER"}));
  EXPECT_EQ(chosen("A/*--1"), (Names{"CA ALA", "CA GLY"}));
}

// What tables print can be selected, with whatever signs.
TEST(Selection, NamesWithSigns) {
  const std::vector<Line> lines{{"C1* ", "  A", 1}, {"CL  ", "CL-", 2}, {" N  ", "ALA", 3}};
  const auto chosen = [&](const char* text) {
    ReadOptions options;
    options.select = text;
    return left(lines, options);
  };
  EXPECT_EQ(chosen("A/1/C1*"), Names{"C1* A"});
  EXPECT_EQ(chosen("(CL-)"), Names{"CL CL-"});
  EXPECT_EQ(chosen("(!CL-,A)"), Names{"N ALA"});
}

// An atom record with a segment id.
std::string in_segment(const char* name, const char* chain_and_residue, double x,
                       const char* segment) {
  char buffer[96];
  std::snprintf(buffer, sizeof buffer,
                "ATOM      1 %s %s    %8.3f   0.000   0.000  1.00  0.00      %-4s\n", name,
                chain_and_residue, x, segment);
  return buffer;
}

std::vector<std::uint32_t> residues(const Molecule& molecule) {
  std::vector<std::uint32_t> list;
  for (const Atom& atom : molecule.atoms) list.push_back(atom.residue);
  return list;
}

TEST(Residues, OfDifferentSegmentsStayApart) {
  for (const char* place : {"ALA A   1", "ALA     1"}) {
    const std::string text = in_segment(" N  ", place, 0, "P1") +
                             in_segment(" CA ", place, 2, "P1") + "TER\n" +
                             in_segment(" N  ", place, 50, "P2");
    EXPECT_EQ(residues(read_text_as("a.pdb", text)), (std::vector<std::uint32_t>{0, 0, 1}));
    ReadOptions options;
    options.select = ";segment=P2";
    const Molecule second = read_text_as("a.pdb", text, options);
    ASSERT_EQ(second.atoms.size(), 1U);
    EXPECT_EQ(second.atoms[0].segment, "P2");
    if (place[4] != ' ') continue;
    options.select = "P1";  // in place of a chain
    EXPECT_EQ(read_text_as("a.pdb", text, options).atoms.size(), 2U);
  }
}

TEST(Residues, NumbersThatComeAgainAreOthers) {
  const Molecule molecule = read_text_as("a.pdb", pdb({{" N  ", "ALA", 1},
                                                       {" CA ", "ALA", 1},
                                                       {" N  ", "GLY", 2},
                                                       {" N  ", "ALA", 1},
                                                       {" CA ", "ALA", 1},
                                                       {" N  ", "GLY", 2}}));
  EXPECT_EQ(residues(molecule), (std::vector<std::uint32_t>{0, 0, 1, 2, 2, 3}));
  // Atoms that a file lists behind those of other residues and chains are none of another residue.
  const Molecule later = read_text_as(
      "a.pdb", pdb({{" N  ", "ALA", 1}, {" N  ", "GLY", 2, ' ', 1, 'B'}, {" H  ", "ALA", 1}}));
  EXPECT_EQ(residues(later), (std::vector<std::uint32_t>{0, 1, 0}));
}

TEST(Residues, NamesOfFourLetters) {
  const std::string text =
      in_segment(" N  ", "POPEM   1", 10, "MEMB") + in_segment(" C12", "POPCM   1", 20, "MEMB") +
      in_segment(" N  ", "HSD P   3", 30, "PROA") + in_segment(" CB ", "NALAA   4", 40, "");
  const Molecule molecule = read_text_as("a.pdb", text);
  ASSERT_EQ(molecule.atoms.size(), 4U);
  EXPECT_EQ(molecule.atoms[0].residue_name, "POPE");
  EXPECT_EQ(molecule.atoms[0].chain, "M");
  EXPECT_EQ(molecule.atoms[1].residue_name, "POPC");
  EXPECT_EQ(molecule.atoms[2].residue_name, "HSD");
  EXPECT_EQ(molecule.atoms[3].residue_name, "NALA");
  EXPECT_EQ(molecule.atoms[3].chain, "A");
  ReadOptions options;
  options.select = "(POPC)";
  EXPECT_EQ(read_text_as("a.pdb", text, options).atoms.size(), 1U);
  options = {};
  options.radii = "protor";
  EXPECT_EQ(read_text_as("a.pdb", text, options).atoms[3].radius, 1.88);  // Tsai et al. 1999
  // Chain ids of two letters stand there as well.
  const Molecule wide = read_text_as("a.pdb", in_segment(" N  ", "ALAAB   1", 0, "") +
                                                  in_segment(" N  ", "HEMAB   2", 9, "") +
                                                  in_segment(" N  ", "GLYAB   3", 19, ""));
  EXPECT_EQ(wide.atoms.at(1).residue_name, "HEM");
  EXPECT_EQ(wide.atoms.at(1).chain, "AB");
  // A blank behind the fourth letter is no chain id: neutral lysine of GROMOS, without a chain.
  const Molecule neutral = read_text_as(
      "a.pdb", in_segment(" CA ", "ALA     1", 0, "") + in_segment(" CA ", "LYSN    2", 9, ""));
  EXPECT_EQ(neutral.atoms.at(1).residue_name, "LYSN");
  EXPECT_EQ(neutral.atoms.at(1).chain, "");
  EXPECT_EQ(neutral.warnings.size(), 1U);  // the letter might be a chain in the wrong column
}

TEST(AlternateLocations, TheHighestWhereALabelIsMissing) {
  const std::vector<Line> lines{{" CA ", "ALA", 1, 'A', 0.6, 'A', "ATOM  ", 1},
                                {" CA ", "ALA", 1, 'B', 0.4, 'A', "ATOM  ", 2},
                                {" CA ", "ALA", 2, 'A', 0.4, 'A', "ATOM  ", 3},
                                {" CA ", "ALA", 2, 'C', 0.2, 'A', "ATOM  ", 4}};
  ReadOptions options;
  options.altloc = "C";
  EXPECT_EQ(positions(lines, options), (std::vector<double>{1, 4}));
  EXPECT_THAT(read_text_as("a.pdb", pdb(lines), options).notes.at(0),
              HasSubstr("1 atoms have no alternate location C"));
}

TEST(Selection, BadSyntaxIsRefused) {
  for (const char* bad : {"A/1/CA[", "//////", "A/1/CA[Qq]", "A/(ALA", "A/1/CA;q~3"}) {
    ReadOptions options;
    options.select = bad;
    EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", pdb({{" CA "}}), options),
                HasSubstr("A/10-40/CA"))
        << bad;
  }
}

TEST(Measure, MarksAtomsAndDropsNone) {
  const std::string lines =
      pdb({{" CA ", "ALA", 1}, {" CA ", "GLY", 2}, {" CB ", "ALA", 3}, {" O  ", "HOH", 4}});
  ReadOptions options;
  options.measure = "A/1-2";
  const auto marks = [&] {
    std::vector<bool> measured;
    for (const Atom& atom : read_text_as("a.pdb", lines, options).atoms)
      measured.push_back(atom.measured);
    return measured;
  };
  EXPECT_EQ(marks(), (std::vector<bool>{true, true, false}));
  options.measure = "(GLY)";
  EXPECT_EQ(marks(), (std::vector<bool>{false, true, false}));
  options.select = "A/2-3";  // of the atoms in use, which are two then
  EXPECT_EQ(marks(), (std::vector<bool>{true, false}));
  options.measure.clear();
  EXPECT_EQ(marks(), (std::vector<bool>{true, true}));
}

TEST(Measure, OfNoAtomAndBadSyntaxAreRefused) {
  const std::string lines = pdb({{" CA ", "ALA", 1}, {" O  ", "HOH", 2}});
  ReadOptions options;
  options.measure = "(HOH)";  // the waters are dropped before
  const std::string message = refusal_of_text<InvalidInput>("a.pdb", lines, options);
  EXPECT_THAT(message, HasSubstr("'(HOH)' of the atoms to measure matches none of the 1 atoms"));
  options.measure = "A/1/CA[";
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", lines, options), HasSubstr("A/10-40/CA"));
}

TEST(Account, NothingLeftSaysWhatDroppedTheAtoms) {
  ReadOptions options;
  options.hydrogens = Inclusion::drop;
  const std::string lines = pdb({{" H  "}, {" O  ", "HOH", 2}, {" O  ", "HOH", 3}});
  const std::string message = refusal_of_text<InvalidInput>("a.pdb", lines, options);
  EXPECT_THAT(message, HasSubstr("none of its 3 atoms"));
  EXPECT_THAT(message, HasSubstr("1 hydrogens, 2 waters"));
}

TEST(Account, AssumedRadiiAreListed) {
  const Molecule molecule = read_text_as(
      "a.pdb", pdb({{"CA  ", " CA"}, {"CA  ", " CA", 2}, {"FE  ", " FE", 3}, {" C1 ", "UNL", 4}}));
  ASSERT_EQ(molecule.radii_assumed.size(), 2U);
  EXPECT_EQ(molecule.radii_assumed[0].element, "Ca");
  EXPECT_EQ(molecule.radii_assumed[0].radius, 2.62);
  EXPECT_EQ(molecule.radii_assumed[0].count, 2U);
  EXPECT_EQ(molecule.radii_assumed[1].element, "Fe");
  EXPECT_EQ(molecule.radius_set, "bondi");
}

const std::string kDimer =
    "REMARK 350 BIOMOLECULE: 1\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000       10.00000\n"
    "REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        0.00000\n";

TEST(Assembly, IsMadeOfTheChosenAtoms) {
  ReadOptions options;
  options.assembly = "1";
  const Molecule molecule = read_text_as("a.pdb",
                                         kDimer + pdb({{" CA ", "ALA", 1, ' ', 1, 'A', "ATOM  ", 1},
                                                       {" CA ", "ALA", 2, ' ', 1, 'A', "ATOM  ", 2},
                                                       {" O  ", "HOH", 3},
                                                       {" CA ", "ALA", 1, ' ', 1, 'B'}}),
                                         options);
  std::vector<double> x;
  for (const Atom& atom : molecule.atoms) x.push_back(atom.position.x);
  EXPECT_EQ(x, (std::vector<double>{1, 2, 9, 8}));
  EXPECT_NE(molecule.atoms[0].chain, molecule.atoms[2].chain);
  EXPECT_EQ(molecule.atoms_used, 2U);
  EXPECT_EQ(molecule.skipped, (SkippedAtoms{{"waters", 1}, {"not_in_assembly", 1}}));
  EXPECT_EQ(molecule.assembly, "1");
}

TEST(Assembly, UnknownNamesAreRefused) {
  ReadOptions options;
  options.assembly = "2";
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", kDimer + pdb({{" CA "}}), options),
              HasSubstr("asymmetric and 1"));
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", pdb({{" CA "}}), options),
              HasSubstr("asymmetric only"));
}

}  // namespace
}  // namespace vdwmesh::testing
