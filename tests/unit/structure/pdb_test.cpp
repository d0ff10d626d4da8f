#include <gmock/gmock.h>

#include <algorithm>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> elements(const Molecule& molecule) {
  std::vector<std::string> result;
  for (const Atom& atom : molecule.atoms) result.push_back(atom.element);
  return result;
}

// An ATOM record up to the coordinates' end; `name` fills four columns.
std::string record(const std::string& name, const std::string& residue = "ALA", int number = 1,
                   double x = 0, const std::string& kind = "ATOM  ", char altloc = ' ') {
  char line[96];
  std::snprintf(line, sizeof line, "%s%5d %-4s%c%3s A%4d    %8.3f%8.3f%8.3f", kind.c_str(), number,
                name.c_str(), altloc, residue.c_str(), number, x, 0.0, 0.0);
  return line;
}

std::string with_tail(const std::string& line, const std::string& columns_73_on) {
  return line + "  1.00 10.00      " + columns_73_on + "\n";
}

TEST(Pdb, CoordinatesNamesAndSerialsComeThrough) {
  const Molecule molecule = read_text_as(
      "a.pdb",
      "ATOM     17  CA AGLY B  52A     -1.500   2.250-103.125  0.50 10.00           C  \n");
  ASSERT_EQ(molecule.atoms.size(), 1U);
  const Atom& atom = molecule.atoms[0];
  EXPECT_EQ(atom.position, (Vec3d{-1.5, 2.25, -103.125}));
  EXPECT_EQ(atom.name, "CA");
  EXPECT_EQ(atom.residue_name, "GLY");
  EXPECT_EQ(atom.residue_number, "52A");
  EXPECT_EQ(atom.chain, "B");
  EXPECT_EQ(atom.serial, 17);
  EXPECT_EQ(atom.element, "C");
  EXPECT_EQ(atom.radius, 1.70);
  EXPECT_FALSE(atom.hetero);
}

TEST(Pdb, EntryTagsOfOldFilesAreNotElements) {
  // Column 77 of "4INSB 12" would be boron, columns 79-80 of "4PTI  75" a charge.
  const Molecule molecule =
      read_text_as("a.pdb", with_tail(record(" N  ", "ALA", 1), "4INSB 12") +
                                with_tail(record(" CA ", "ALA", 2), "4INSB 13") +
                                with_tail(record(" O  ", "DOD", 3), "4INSB 14") +
                                with_tail(record("CA  ", " CA", 4), "4INS1015"));
  EXPECT_EQ(elements(molecule), (std::vector<std::string>{"N", "C", "Ca"}));
  EXPECT_EQ(molecule.skipped.at("waters"), 1U);
}

TEST(Pdb, ModernTailsAreNotTakenForTags) {
  const Molecule molecule =
      read_text_as("a.pdb", with_tail(record("ZN  ", " ZN", 1), "1ABCZN2+") +
                                with_tail(record(" O  ", "UNL", 2), "1ABC O1-"));
  EXPECT_EQ(elements(molecule), (std::vector<std::string>{"Zn", "O"}));
}

TEST(Pdb, OddChargeColumnsDoNoHarm) {
  const Molecule molecule = read_text_as("a.pdb", with_tail(record(" C1 ", "UNL"), "     C5X"));
  EXPECT_EQ(elements(molecule), std::vector<std::string>{"C"});
}

TEST(Pdb, ElementsFollowFromTheAlignmentOfNames) {
  const std::vector<std::pair<std::string, std::string>> names{
      {"CA  ", "Ca"}, {" CA ", "C"}, {"ZN  ", "Zn"}, {"1HB ", "H"}, {"HO5'", "H"},
      {"FE  ", "Fe"}, {" C1 ", "C"}, {"CL1 ", "Cl"}, {"C210", "C"}, {"NH1A", "N"},
      {"HG  ", "Hg"}, {" P  ", "P"}, {"SE  ", "Se"}};
  std::string text;
  std::vector<std::string> expected;
  for (const auto& [name, element] : names) {
    text += record(name, "UNL", static_cast<int>(expected.size()) + 1) + "\n";
    expected.push_back(element);
  }
  EXPECT_EQ(elements(read_text_as("a.pdb", text)), expected);
}

TEST(Pdb, StandardResiduesHoldNoCalciumOrMercury) {
  const Molecule molecule =
      read_text_as("a.pdb", record("CA  ", "LYS", 1) + "\n" + record("HG  ", "SER", 2) + "\n" +
                                record("SE  ", "MSE", 3) + "\n" + record("CA  ", "MSE", 4) + "\n" +
                                record("CD  ", "GLN", 5) + "\n" + record("OP1 ", " DA", 6) + "\n");
  EXPECT_EQ(elements(molecule), (std::vector<std::string>{"C", "H", "Se", "C", "C", "O"}));
}

TEST(Pdb, IonsInResiduesOfOthersAreTold) {
  const auto told = [](const char* name, const char* residue, const std::string& symbol) {
    const Molecule molecule =
        read_text_as("a.pdb", with_tail(record(name, residue, 1), "    " + symbol));
    return std::any_of(molecule.warnings.begin(), molecule.warnings.end(), [&](const auto& text) {
      return text.find(molecule.atoms[0].element.str() + " in ") != std::string::npos;
    });
  };
  EXPECT_TRUE(told("NA  ", " CL", "NA"));
  EXPECT_TRUE(told("CL  ", "SOD", "CL"));
  EXPECT_FALSE(told("NA  ", " NA", "NA"));
  EXPECT_FALSE(told("CL  ", "CLA", "CL"));
  EXPECT_FALSE(told("MG  ", "CLA", "MG"));  // chlorophyll
  EXPECT_FALSE(told("ZN  ", "ZN2", "ZN"));
}

TEST(Pdb, NamesAtTheLeftThroughoutSayNothingByTheirPlace) {
  const Molecule molecule =
      read_text_as("a.pdb", record("N   ", "ALA", 1) + "\n" + record("CA  ", "UNL", 2) + "\n" +
                                record("CA  ", " CA", 3) + "\n" + record("HG1 ", "UNL", 4) + "\n");
  EXPECT_EQ(elements(molecule), (std::vector<std::string>{"N", "C", "Ca", "H"}));
}

TEST(Pdb, DeuteriumHasTheRadiusOfHydrogen) {
  const Molecule molecule = read_text_as("a.pdb", with_tail(record(" D  ", "ALA"), "     D  "));
  EXPECT_EQ(molecule.atoms.at(0).element, "D");
  EXPECT_EQ(molecule.atoms.at(0).radius, 1.20);
  ReadOptions options;
  options.hydrogens = Inclusion::drop;
  EXPECT_THAT(
      refusal_of_text<InvalidInput>("a.pdb", with_tail(record(" D  "), "     D  "), options),
      HasSubstr("1 hydrogens"));
}

TEST(Pdb, LineEndsAndByteOrderMarkDoNotMatter) {
  const std::string one = record(" C1 ", "UNL", 1), two = record(" O1 ", "UNL", 2);
  for (const char* end : {"\n", "\r\n", "\r"})
    EXPECT_EQ(read_text_as("a.pdb", "\xef\xbb\xbf" + one + end + two + end).atoms.size(), 2U);
  EXPECT_EQ(read_text_as("a.pdb", one + "\n" + two).atoms.size(), 2U);  // no end at the end
}

TEST(Pdb, HybridSerialsAreNumbers) {
  std::string text;
  for (const char* serial : {"99999", "A0000", "ZZZZZ", "a0000", "*****", "A00.0"}) {
    std::string line = record(" C1 ", "UNL", 1);
    text += line.replace(6, 5, serial) + "\n";
  }
  const Molecule molecule = read_text_as("a.pdb", text);
  std::vector<std::int64_t> serials;
  for (const Atom& atom : molecule.atoms) serials.push_back(atom.serial);
  // cci.lbl.gov/hybrid_36: A0000 = 100000, ZZZZZ = 43770015, a0000 = 43770016. What is
  // no number is counted.
  EXPECT_EQ(serials, (std::vector<std::int64_t>{99999, 100000, 43770015, 43770016, 5, 6}));
}

TEST(Pdb, MoreAtomsThanFiveDigits) {
  std::string text;
  constexpr int kAtoms = 100'003;
  for (int i = 0; i < kAtoms; ++i)
    text += record(" C1 ", "UNL", 1, 0.001 * (i % 9000)).replace(6, 5, "*****") + "\n";
  const Molecule molecule = read_text_as("a.pdb", text);
  ASSERT_EQ(molecule.atoms.size(), static_cast<std::size_t>(kAtoms));
  EXPECT_EQ(molecule.atoms.back().serial, kAtoms);
  for (int i = 0; i < kAtoms; i += 997)
    EXPECT_EQ(molecule.atoms[static_cast<std::size_t>(i)].position.x,
              std::stod(text.substr(static_cast<std::size_t>(i) * 55 + 30, 8)));
}

TEST(Pdb, AtomsKeepTheOrderOfTheFile) {
  const Molecule molecule =
      read_text_as("a.pdb", record(" N  ", "ALA", 1) + "\n" + record(" N  ", "GLY", 2) + "\n" +
                                record(" O  ", "ALA", 1) + "\n" + record(" O  ", "GLY", 2) + "\n");
  EXPECT_EQ(elements(molecule), (std::vector<std::string>{"N", "N", "O", "O"}));
}

TEST(Pdb, BadCoordinatesAreRefusedWithTheirLine) {
  const std::string good = record(" C1 ", "UNL") + "\n";
  for (const std::string& bad :
       {std::string("     nan"), std::string("     inf"), std::string("********"),
        std::string("        "), std::string("  1.5x  "), std::string("  1e999 ")}) {
    const std::string message =
        refusal_of_text<FileFormatError>("a.pdb", good + record(" C1 ", "UNL").replace(38, 8, bad));
    EXPECT_THAT(message, HasSubstr("a.pdb:2: y in columns 39-46")) << bad;
  }
}

TEST(Pdb, ShortRecordIsRefusedWithItsLine) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", "REMARK\n" + record(" C1 ").substr(0, 44)),
              HasSubstr("a.pdb:2: z in columns 47-54"));
}

TEST(Pdb, RecordMayEndAfterTheCoordinates) {
  EXPECT_EQ(read_text_as("a.pdb", record(" C1 ", "UNL")).atoms.size(), 1U);
}

TEST(Pdb, NoAtomsIsAnError) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pdb", "HEADER    NOTHING\nEND\n"),
              HasSubstr("no ATOM or HETATM"));
}

TEST(Pdb, UnknownElementNamesTheAtom) {
  const std::string message = refusal_of_text<InvalidInput>(
      "a.pdb", record(" C1 ", "UNL", 1) + "\n" + with_tail(record(" Q1 ", "LIG", 2), "     Q  "));
  EXPECT_THAT(message, HasSubstr("atom Q1 of residue LIG 2 of chain A (serial 2, line 2)"));
  const TemporaryDirectory dir;
  ReadOptions options;
  options.radii = dir.write("radii.txt", "C 1.7\nLIG Q1 2.5\n").string();
  const Molecule molecule =
      read_structure(dir.write("a.pdb", with_tail(record(" Q1 ", "LIG", 2), "     Q  ")), options);
  EXPECT_EQ(molecule.atoms.at(0).radius, 2.5);
  EXPECT_EQ(molecule.radius_set, options.radii);
}

TEST(Pdb, ElementInNoTableNamesTheAtom) {
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", with_tail(record("RA  ", " RA"), "    RA  ")),
              HasSubstr("no radius for element Ra of atom RA"));
}

TEST(Pdb, CoincidentAtomsAreKept) {
  EXPECT_EQ(read_text_as("a.pdb", record(" C1 ", "UNL") + "\n" + record(" C1 ", "UNL") + "\n")
                .atoms.size(),
            2U);
}

}  // namespace
}  // namespace vdwmesh::testing
