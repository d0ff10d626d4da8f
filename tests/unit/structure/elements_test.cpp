// Elements that the file does not give, against tables of the programs that write such files.
#include "structure/molecule/elements.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "structure/temp_file.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

// An atom as a program writes it into columns 13-16 and 18-20 of a PDB file.
struct Named {
  const char* four_columns;
  const char* residue;
  const char* element;
};

// Ions of CHARMM (toppar_water_ions.str; those with a charge and P of its 2024 set), with names of
// four letters cut to the three columns of a residue, and its states of histidine.
const std::vector<Named> kCharmm{
    {" SOD", "SOD", "Na"}, {" POT", "POT", "K"},  {" CLA", "CLA", "Cl"}, {" CAL", "CAL", "Ca"},
    {" CES", "CES", "Cs"}, {" LIT", "LIT", "Li"}, {" RUB", "RUB", "Rb"}, {" BAR", "BAR", "Ba"},
    {" ZN ", "ZN2", "Zn"}, {" CD ", "CD2", "Cd"}, {" MG ", "MG ", "Mg"}, {"AL3P", "AL3", "Al"},
    {"SR2P", "SR2", "Sr"}, {"LA3P", "LA3", "La"}, {"V2P ", "V2P", "V"},  {" CA ", "HSD", "C"},
    {" HD1", "HSD", "H"},  {" CD2", "HSE", "C"},  {" OT1", "ALA", "O"},  {"HG11", "VAL", "H"},
    {" FE ", "HEM", "Fe"}, {" NA ", "HEM", "N"},  {" CHA", "HEM", "C"},  {" HG ", "CYS", "H"}};

// AMBER (atomic_ions.lib, leaprc of ff14SB and OL15): ions with their charge in the name, states of
// charge of amino acids, ends of nucleic acids.
const std::vector<Named> kAmber{
    {"Na+ ", "Na+", "Na"}, {"Cl- ", "Cl-", "Cl"}, {"K+  ", "K+ ", "K"},  {"Li+ ", "Li+", "Li"},
    {"Cs+ ", "Cs+", "Cs"}, {"Rb+ ", "Rb+", "Rb"}, {"Mg+ ", "Mg+", "Mg"}, {"IOD ", "IOD", "I"},
    {"YB2 ", "YB2", "Yb"}, {" U  ", "U4+", "U"},  {"V2+ ", "V2+", "V"},  {"GD  ", "GD3", "Gd"},
    {"EU3 ", "EU3", "Eu"}, {"CO  ", "CO ", "Co"}, {"CD  ", "CD ", "Cd"}, {"HG  ", "HG ", "Hg"},
    {"PB  ", "PB ", "Pb"}, {"TL1 ", "TL1", "Tl"}, {" CA ", "HIE", "C"},  {"CD2 ", "HIP", "C"},
    {"SG  ", "CYX", "S"},  {"HD1 ", "HID", "H"},  {"CE  ", "LYN", "C"},  {"NE2 ", "HID", "N"},
    {"HO5'", "DA5", "H"},  {" P  ", "DC3", "P"},  {"CD  ", "GLH", "C"},  {"HD2 ", "ASH", "H"},
    {" CA ", "CAL", "C"}};  // of CALA, cut to three columns

// GROMACS (ions.itp of its AMBER, OPLS-AA and GROMOS force fields, residuetypes.dat), which writes
// names of up to three letters from column 14 on.
const std::vector<Named> kGromacs{
    {" NA ", "NA ", "Na"}, {" CL ", "CL ", "Cl"}, {" CA ", "CA ", "Ca"}, {" CS ", "CS ", "Cs"},
    {" CU ", "CU1", "Cu"}, {" CU ", "CU ", "Cu"}, {" ZN ", "ZN ", "Zn"}, {" MG ", "MG ", "Mg"},
    {" BR ", "BR ", "Br"}, {" LI ", "LI ", "Li"}, {" NA+", "NA+", "Na"}, {" CL-", "CL-", "Cl"},
    {" SN ", "SN ", "Sn"}, {" ND ", "ND ", "Nd"}, {" HF ", "HF ", "Hf"}, {" CE ", "CE4", "Ce"},
    {" IN ", "IN ", "In"}, {" HO ", "HO3", "Ho"}, {" TL ", "TL3", "Tl"}, {" CD1", "TRP", "C"},
    {" HE2", "HIS", "H"}};

// Components of the PDB, each with its column as the PDB sets it, and again from column 13 on.
const std::vector<Named> kComponents{
    {"FE  ", "HEM", "Fe"}, {" NA ", "HEC", "N"},  {"NA  ", "HEM", "N"},  {"CHA ", "HEM", "C"},
    {"MG  ", "CLA", "Mg"}, {" CHA", "CLA", "C"},  {"FE1 ", "SF4", "Fe"}, {" S1 ", "SF4", "S"},
    {"CO  ", "B12", "Co"}, {"NI  ", "F43", "Ni"}, {"CA1 ", "OEX", "Ca"}, {"MN1 ", "OEX", "Mn"},
    {"CU1 ", "CUA", "Cu"}, {"FE  ", "FE2", "Fe"}, {"CO  ", "3CO", "Co"}, {"MO  ", "4MO", "Mo"},
    {"SE  ", "MSE", "Se"}, {" I  ", "IOD", "I"},  {"NI  ", "NI ", "Ni"}, {"PT  ", "PT4", "Pt"}};

std::string record(const Named& atom, int serial, const std::string& element) {
  char line[128];
  std::snprintf(line, sizeof line, "ATOM  %5d %-4s %3s A%4d    %8.3f%8.3f%8.3f  1.00 10.00", serial,
                atom.four_columns, atom.residue, serial, 9.0 * serial, 0.0, 0.0);
  return std::string(line).append(12 - element.size(), ' ').append(element).append("\n");
}

std::string capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

enum class ElementColumns { given, missing };

void expect_elements(const std::vector<Named>& table, ElementColumns columns) {
  std::string text;
  int serial = 0;
  for (const Named& atom : table)
    text += record(atom, ++serial, columns == ElementColumns::given ? capitals(atom.element) : "");
  const Molecule molecule = read_text_as("a.pdb", text);
  ASSERT_EQ(molecule.atoms.size(), table.size());
  for (std::size_t i = 0; i < table.size(); ++i)
    EXPECT_EQ(molecule.atoms[i].element, table[i].element)
        << "'" << table[i].four_columns << "' of " << table[i].residue;
  EXPECT_EQ(molecule.elements_guessed, columns == ElementColumns::given ? 0 : table.size());
}

// The same names without columns, in a PQR file.
void expect_elements_of_bare_names(const std::vector<Named>& table) {
  std::string text;
  for (const Named& atom : table)
    text += std::string("ATOM 1 ") + atom.four_columns + " " + atom.residue + " 1 0 0 0 0 1\n";
  const Molecule molecule = read_text_as("a.pqr", text);
  ASSERT_EQ(molecule.atoms.size(), table.size());
  for (std::size_t i = 0; i < table.size(); ++i)
    EXPECT_EQ(molecule.atoms[i].element, table[i].element)
        << table[i].four_columns << " of " << table[i].residue;
}

class ElementsOf : public ::testing::TestWithParam<std::pair<std::string, std::vector<Named>>> {};

TEST_P(ElementsOf, AreTheSameWithAndWithoutElementColumns) {
  expect_elements(GetParam().second, ElementColumns::missing);
  expect_elements(GetParam().second, ElementColumns::given);
  expect_elements_of_bare_names(GetParam().second);
}

// Every name from column 13 on, in a file that writes all names so.
TEST_P(ElementsOf, DoNotDependOnTheColumnInAFileOfLeftAlignedNames) {
  static constexpr const char* kBackbone[] = {"N   ", "C   ", "O   "};
  std::string text;
  for (int i = 0; i < 3; ++i) text += record({kBackbone[i], "ALA", ""}, i + 1, "");
  for (const Named& atom : GetParam().second) {
    std::string name = atom.four_columns;
    name.erase(0, name.find_first_not_of(' '));
    text += record({name.c_str(), atom.residue, ""}, 4, "");
  }
  const Molecule molecule = read_text_as("a.pdb", text);
  for (std::size_t i = 0; i < GetParam().second.size(); ++i)
    EXPECT_EQ(molecule.atoms.at(i + 3).element, GetParam().second[i].element)
        << GetParam().second[i].four_columns << " of " << GetParam().second[i].residue;
}

INSTANTIATE_TEST_SUITE_P(Programs, ElementsOf,
                         ::testing::Values(std::pair{"charmm", kCharmm}, std::pair{"amber", kAmber},
                                           std::pair{"gromacs", kGromacs},
                                           std::pair{"components", kComponents}),
                         [](const auto& info) { return "of_" + info.param.first; });

TEST(Elements, WhereTheResidueSaysNothingTheColumnDecides) {
  expect_elements({{"CA  ", "UNL", "Ca"},
                   {" CA ", "UNL", "C"},
                   {"CD  ", "LIG", "Cd"},
                   {" CD ", "LIG", "C"},
                   {"FE  ", "UNL", "Fe"},
                   {" ZN ", "UNL", "Zn"}},
                  ElementColumns::missing);
}

// Names that fill all four columns begin with a hydrogen or a carbon, not with helium or cadmium.
TEST(Elements, FullNamesBeginWithTheLetterOfALightElement) {
  EXPECT_STREQ(element_of_aligned_name("HE21", "UNL"), "H");
  EXPECT_STREQ(element_of_aligned_name("CD11", "UNL"), "C");
  EXPECT_STREQ(element_of_aligned_name("NE10", "UNL"), "N");
  EXPECT_STREQ(element_of_aligned_name("CL10", "UNL"), "Cl");
}

TEST(Elements, GuessesAreCountedAndUnusualOnesListed) {
  const std::string text = record({" N  ", "ALA", ""}, 1, "") + record({" SOD", "SOD", ""}, 2, "") +
                           record({" SOD", "SOD", ""}, 3, "") + record({" CLA", "CLA", ""}, 4, "") +
                           record({" CAL", "CAL", ""}, 5, "CA") +
                           record({" O  ", "HOH", ""}, 6, "");
  const Molecule molecule = read_text_as("a.pdb", text);
  EXPECT_EQ(molecule.elements_guessed, 4U);  // the water is left out, calcium is given
  ASSERT_EQ(molecule.unusual_elements_guessed.size(), 2U);
  EXPECT_EQ(molecule.unusual_elements_guessed[0].element, "Cl");
  EXPECT_EQ(molecule.unusual_elements_guessed[1].element, "Na");
  EXPECT_EQ(molecule.unusual_elements_guessed[1].residue_name, "SOD");
  EXPECT_EQ(molecule.unusual_elements_guessed[1].atom_name, "SOD");
  EXPECT_EQ(molecule.unusual_elements_guessed[1].count, 2U);
  ASSERT_EQ(molecule.notes.size(), 1U);
  EXPECT_THAT(molecule.notes[0], HasSubstr("of 4 atoms"));
  EXPECT_THAT(molecule.notes[0], HasSubstr("Na (atom SOD of SOD, 2x)"));
  EXPECT_TRUE(read_text_as("a.pdb", record({" N  ", "ALA", ""}, 1, "N")).notes.empty());
}

// Radii of a PQR file do not rest on elements.
TEST(Elements, GuessesThatNothingRestsOnAreNotTold) {
  const Molecule molecule = read_text_as("a.pqr", "ATOM 1 SOD SOD 1 0 0 0 0 1\n");
  EXPECT_EQ(molecule.elements_guessed, 1U);
  EXPECT_TRUE(molecule.notes.empty());
  EXPECT_EQ(read_text_as("a.xyzr", "0 0 0 1\n").elements_guessed, 0U);
}

// "DC1" may be a dummy or deuterium: where the residue has no hydrogen HC1, it is no atom, and
// told.
TEST(Elements, DummiesByNameAloneAreCounted) {
  const std::string text = record({" C1 ", "LIG", ""}, 1, "") + record({"DC1 ", "LIG", ""}, 2, "") +
                           record({"DH2 ", "LIG", ""}, 3, "") + record({" DA ", "ALA", ""}, 4, "");
  const Molecule molecule = read_text_as("a.pdb", text);
  EXPECT_EQ(molecule.skipped, (SkippedAtoms{{"virtual_sites", 2}}));
  ASSERT_EQ(molecule.atoms.size(), 2U);
  EXPECT_EQ(molecule.atoms[1].element, "D");
  ASSERT_EQ(molecule.warnings.size(), 1U);
  EXPECT_THAT(molecule.warnings[0], HasSubstr("2 without an element are dummies"));
  EXPECT_THAT(molecule.warnings[0], HasSubstr("the first is DC1 of LIG 2"));
  const Molecule given = read_text_as("a.pdb", record({"DC1 ", "LIG", ""}, 1, "D"));
  EXPECT_EQ(given.atoms.at(0).element, "D");
  EXPECT_TRUE(given.warnings.empty());
}

// A Martini bead stands for some four atoms: no radius of an element would be right.
TEST(Elements, BeadsHaveNone) {
  const std::string protein =
      record({" BB ", "ALA", ""}, 1, "") + record({" SC1", "LYS", ""}, 2, "") +
      record({" W  ", "W  ", ""}, 3, "") + record({"NA+ ", "ION", ""}, 4, "");
  const std::string lipid = record({" NC3", "DPP", ""}, 1, "") +
                            record({" PO4", "DPP", ""}, 2, "") +
                            record({" GL1", "DPP", ""}, 3, "") + record({" C1A", "DPP", ""}, 4, "");
  for (const std::string& text : {protein, lipid})
    EXPECT_THAT(refusal_of_text<InvalidInput>("a.pdb", text),
                HasSubstr("is a bead of a coarse-grained (Martini) model"));
  const TemporaryDirectory dir;
  ReadOptions options;
  options.radii = dir.write("radii", "X 2.35\nLYS SC1 2.1\n").string();
  const Molecule molecule = read_text_as("a.pdb", protein, options);
  ASSERT_EQ(molecule.atoms.size(), 3U);
  EXPECT_EQ(molecule.skipped, (SkippedAtoms{{"waters", 1}}));
  EXPECT_EQ(molecule.atoms[0].radius, 2.35);
  EXPECT_EQ(molecule.atoms[1].radius, 2.1);
  EXPECT_EQ(molecule.elements_guessed, 0U);
  EXPECT_EQ(read_text_as("a.pdb", record({" W  ", "W  ", ""}, 1, "W")).atoms.at(0).element, "W");
}

TEST(Elements, OfFilesThatShowedADefect) {
  VDWMESH_NEEDS_SHARED("molecules/traps");
  const auto elements = [](const char* name) {
    std::string text;
    for (const Atom& atom :
         read_structure(shared_path(std::string("molecules/traps/") + name)).atoms)
      text += atom.element + " ";
    return text;
  };
  EXPECT_EQ(elements("charmm_ions.pdb"), "N C Na K Ca Cs Fe ");
  EXPECT_EQ(elements("left_aligned_heme.pdb"), "N C C O Fe N C Cu Ni ");
  EXPECT_THAT(refusal_of<InvalidInput>(shared_path("molecules/traps/martini_beads.pdb")),
              HasSubstr("is a bead"));
}

}  // namespace
}  // namespace vdwmesh::testing
