#include <gmock/gmock.h>

#include <cmath>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

const std::string kColumns =
    "data_TEST\nloop_\n_atom_site.group_PDB\n_atom_site.id\n_atom_site.type_symbol\n"
    "_atom_site.label_atom_id\n_atom_site.label_alt_id\n_atom_site.label_comp_id\n"
    "_atom_site.label_asym_id\n_atom_site.label_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n"
    "_atom_site.Cartn_z\n_atom_site.occupancy\n_atom_site.B_iso_or_equiv\n"
    "_atom_site.auth_seq_id\n_atom_site.auth_asym_id\n_atom_site.pdbx_PDB_model_num\n";

TEST(MmCif, AtomsComeThrough) {
  const Molecule molecule =
      read_text_as("a.cif", kColumns +
                                "ATOM 100001 C CA . GLY A 1 1.5 -2.25 3.125 1 10 7 X 1\n"
                                "HETATM 100002 ZN ZN . ZN B . 4 5 6 1 10 301 X 1\n"
                                "HETATM 100003 D D1 . DOD C . 4 5 6 1 10 302 X 1\n");
  ASSERT_EQ(molecule.atoms.size(), 2U);
  EXPECT_EQ(molecule.format, "mmcif");
  EXPECT_EQ(molecule.atoms[0].position, (Vec3d{1.5, -2.25, 3.125}));
  EXPECT_EQ(molecule.atoms[0].serial, 100001);
  EXPECT_EQ(molecule.atoms[0].chain, "X");
  EXPECT_EQ(molecule.atoms[0].residue_number, "7");
  EXPECT_FALSE(molecule.atoms[0].hetero);
  EXPECT_TRUE(molecule.atoms[1].hetero);
  EXPECT_EQ(molecule.atoms[1].element, "Zn");
  EXPECT_EQ(molecule.skipped.at("waters"), 1U);
}

TEST(MmCif, RowsOfOneResidueMayBeApart) {
  const Molecule molecule = read_text_as("a.cif", kColumns +
                                                      "ATOM 1 N N . GLY A 1 0 0 0 1 10 1 A 1\n"
                                                      "ATOM 2 C CA . ALA A 2 1 0 0 1 10 2 A 1\n"
                                                      "ATOM 3 O O . GLY A 1 2 0 0 1 10 1 A 1\n");
  EXPECT_EQ(
      molecule.atoms.at(0).element + molecule.atoms.at(1).element + molecule.atoms.at(2).element,
      "NCO");
}

TEST(MmCif, ColumnsThatMayBeMissing) {
  const Molecule molecule =
      read_text_as("a.cif",
                   "data_x\nloop_\n_atom_site.type_symbol\n_atom_site.label_atom_id\n"
                   "_atom_site.label_comp_id\n_atom_site.label_asym_id\n_atom_site.label_seq_id\n"
                   "_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
                   "N N GLY A 1 0 0 0\nC CA GLY A 1 1 0 0\n");
  EXPECT_EQ(molecule.atoms.size(), 2U);
  EXPECT_EQ(molecule.atoms.at(1).name, "CA");
}

// Chains by the author's names, elements by names of atoms and residues.
TEST(MmCif, ChainsAndElementsMayBeToldFromOtherColumns) {
  const Molecule molecule = read_text_as(
      "a.cif",
      "data_x\nloop_\n_atom_site.auth_atom_id\n_atom_site.auth_comp_id\n_atom_site.auth_asym_id\n"
      "_atom_site.auth_seq_id\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n"
      "CA GLY X 1 0 0 0\nCA CA Y 2 9 0 0\n");
  ASSERT_EQ(molecule.atoms.size(), 2U);
  EXPECT_EQ(molecule.atoms[0].chain + " " + molecule.atoms[0].element, "X C");
  EXPECT_EQ(molecule.atoms[1].chain + " " + molecule.atoms[1].element, "Y Ca");
  EXPECT_EQ(molecule.elements_guessed, 2U);
}

TEST(MmCif, BadCoordinateNamesItsRow) {
  for (const char* bad : {"?", "nan", "inf", "abc"})
    EXPECT_THAT(
        refusal_of_text<FileFormatError>(
            "a.cif", kColumns + "ATOM 1 N N . GLY A 1 0 0 0 1 10 1 A 1\nATOM 2 C CA . GLY A 1 0 " +
                         bad + " 0 1 10 1 A 1\n"),
        HasSubstr("row 2 of _atom_site (id 2): Cartn_y"));
}

TEST(MmCif, WholeNumbersThatDoNotFitNameTheirRow) {
  const std::string first = kColumns + "ATOM 1 N N . GLY A 1 0 0 0 1 10 1 A 1\n";
  EXPECT_EQ(read_text_as("a.cif", first + "ATOM 2 C CA . GLY A 1 0 0 0 1 10 -12345678 A 1\n")
                .atoms.at(1)
                .residue_number,
            "-12345678");
  EXPECT_THAT(refusal_of_text<FileFormatError>(
                  "a.cif", first + "ATOM 2 C CA . GLY A 1 0 0 0 1 10 18888888888 A 1\n"),
              HasSubstr("row 2 of _atom_site: auth_seq_id is '18888888888'"));
}

TEST(MmCif, SyntaxErrorNamesItsLine) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", "data_x\n_cell.length_a\n"),
              HasSubstr("a.cif:"));
  EXPECT_THAT(refusal_of_text<FileFormatError>(
                  "a.cif", kColumns + "ATOM 1 N N . GLY A 1 0 0 0 1 10 1 A 1\nATOM 2 C CA\n"),
              HasSubstr("a.cif"));  // cut off in the middle of a row
}

TEST(MmCif, LackingTablesAndColumnsAreNamed) {
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", "data_x\n_cell.length_a 1\n"),
              HasSubstr("no _atom_site table"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif",
                                               "data_x\nloop_\n_atom_site.id\n"
                                               "_atom_site.Cartn_x\n1 0\n"),
              HasSubstr("lacks the column label_asym_id"));
}

TEST(MmCif, ColumnsInTwoLoopsAreNotLost) {
  const std::string positions =
      "loop_\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 2 3\n4 5 6\n";
  const std::string others =
      "loop_\n_atom_site.id\n_atom_site.type_symbol\n_atom_site.label_asym_id\n"
      "_atom_site.auth_seq_id\n1 C A 1\n2 N A 1\n";
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", "data_x\n" + others + positions),
              HasSubstr("in one loop"));
}

TEST(MmCif, ColumnsMayStandInAnyOrderAmongOthers) {
  const Molecule molecule = read_text_as(
      "a.cif",
      "data_x\n_entry.id 'a b'\nloop_\n_other.id\n_other.text\n1\n;_atom_site.id\nloop_\n;\n"
      "save_frame\n_atom_site.id 7\nsave_\n"
      "loop_\n_ATOM_SITE.cartn_Z\n_atom_site.Cartn_y\n_atom_site.Cartn_x\n_atom_site.unknown\n"
      "_atom_site.label_asym_id\n_atom_site.label_seq_id\n_atom_site.label_comp_id\n"
      "_atom_site.label_atom_id\n3 2 1 'a b' A 1 A \"O5'\"\n# the end\n");
  ASSERT_EQ(molecule.atoms.size(), 1U);
  EXPECT_EQ(molecule.atoms[0].position, (Vec3d{1, 2, 3}));
  EXPECT_EQ(molecule.atoms[0].name, "O5'");
  EXPECT_EQ(molecule.atoms[0].element, "O");
}

TEST(MmCif, OneAtomMayStandWithoutALoop) {
  const std::string atom =
      "data_x\n_atom_site.Cartn_x 1\n_atom_site.Cartn_y 2\n_atom_site.Cartn_z 3\n"
      "_atom_site.label_asym_id A\n_atom_site.label_seq_id 1\n_atom_site.label_comp_id ZN\n";
  EXPECT_EQ(read_text_as("a.cif", atom + "_atom_site.label_atom_id ZN\n").atoms.at(0).element,
            "Zn");
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", atom),
              HasSubstr("lacks the column label_atom_id"));
}

// Residue 1 comes again after residue 3, and 2 in another chain: four residues, of which the label
// of highest occupancy is chosen one by one.
TEST(MmCif, ResiduesAreFoundAgain) {
  const std::string rows =
      "ATOM 1 N N A GLY A 1 0 0 0 0.4 10 1 A 1\nATOM 2 C CA A GLY A 3 2 0 0 0.9 10 3 A 1\n"
      "ATOM 3 N N B GLY A 1 4 0 0 0.6 10 1 A 1\nATOM 4 C CA B GLY B 1 6 0 0 0.1 10 1 B 1\n";
  const Molecule molecule = read_text_as("a.cif", kColumns + rows);
  EXPECT_EQ(molecule.skipped, (SkippedAtoms{{"alternate_locations", 1}}));
  ASSERT_EQ(molecule.atoms.size(), 3U);
  EXPECT_EQ(molecule.atoms[1].position.x, 4);
}

TEST(MmCif, BadRowsAreNamed) {
  const std::string row = "ATOM 1 N N . GLY A 1 0 0 0 1 10 1 A 1\n";
  const auto refusal_of = [&](const std::string& rows) {
    return refusal_of_text<FileFormatError>("a.cif", kColumns + rows);
  };
  EXPECT_THAT(refusal_of(row + "ATOM 2 N N . GLY A 1 0 0 0 1 10 1x2 A 1\n"),
              HasSubstr("row 2 of _atom_site: auth_seq_id is '1x2'"));
  EXPECT_THAT(refusal_of(row + "ATOM 2 N N AB GLY A 1 0 0 0 1 10 1 A 1\n"),
              HasSubstr("row 2 of _atom_site: label_alt_id is 'AB'"));
  EXPECT_THAT(refusal_of(row + "ATOM 2 N N . GLY A 1 0 0\n"),
              HasSubstr("not a multiple of its 16"));
  EXPECT_THAT(refusal_of(row + "data_second\n" + kColumns.substr(10) + row),
              HasSubstr("two data blocks, TEST and second"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", "data_x\n1\n"),
              HasSubstr("a.cif:2: the value '1' stands where"));
}

TEST(MmCif, LineEndsDoNotMatter) {
  const std::string text = kColumns + "ATOM 1 N N . GLY A 1 0 0 0 1 10 1 A 1\n";
  for (const std::string& end : {std::string("\r\n"), std::string("\r")}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? end : std::string(1, c);
    EXPECT_EQ(read_text_as("a.cif", "\xef\xbb\xbf" + other).atoms.size(), 1U);
  }
}

TEST(MmCif, ChargedSymbolsAreElements) {
  const Molecule molecule = read_text_as("a.cif", kColumns +
                                                      "ATOM 1 O2- O . UNL A 1 0 0 0 1 10 1 A 1\n"
                                                      "ATOM 2 Fe3+ FE . UNL A 1 0 0 0 1 10 1 A 1\n"
                                                      "ATOM 3 ? C1 . UNL A 1 0 0 0 1 10 1 A 1\n");
  EXPECT_EQ(molecule.atoms.at(0).element, "O");
  EXPECT_EQ(molecule.atoms.at(1).element, "Fe");
  EXPECT_EQ(molecule.atoms.at(2).element, "C");
}

// A cell of 10 x 20 x 30 Å with right angles: Cartesian = fraction x edge.
TEST(SmallCif, FractionsArePlacedByTheCell) {
  const std::string cell =
      "data_x\n_cell_length_a 10\n_cell_length_b 20(1)\n_cell_length_c 30\n"
      "_cell_angle_alpha 90\n_cell_angle_beta 90\n_cell_angle_gamma 90\n";
  const std::string sites =
      "loop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n"
      "_atom_site_fract_z\nC1 0.1 0.1 0.1\nO2 -0.5 0.25(2) 0\n";
  const Molecule molecule = read_text_as("a.cif", cell + sites);
  EXPECT_EQ(molecule.format, "cif");
  ASSERT_EQ(molecule.atoms.size(), 2U);
  constexpr double kRounding = 1e-12;  // Å; a few roundings of numbers below 10
  const Vec3d expected[2] = {{1, 2, 3}, {-5, 5, 0}};
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_LE(norm(molecule.atoms[i].position - expected[i]), kRounding);
  EXPECT_TRUE(molecule.path.ends_with("a.cif")) << molecule.path;
  EXPECT_EQ(molecule.atoms[0].name, "C1");
  EXPECT_EQ(molecule.atoms[1].name, "O2");
  EXPECT_EQ(molecule.atoms[1].element, "O");
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", "data_x\n" + sites),
              HasSubstr("no unit cell"));
}

// Without _atom_site_type_symbol, the label tells: "Ca1" is calcium, "CA1" may as well be a carbon.
TEST(SmallCif, ElementsMayBeToldFromLabels) {
  const std::string cell =
      "data_x\n_cell_length_a 10\n_cell_length_b 10\n_cell_length_c 10\n"
      "_cell_angle_alpha 90\n_cell_angle_beta 90\n_cell_angle_gamma 90\n";
  const std::string columns = "_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n";
  const auto elements = [](const Molecule& molecule) {
    std::string names;
    for (const Atom& atom : molecule.atoms) names += atom.element + " ";
    return names;
  };
  const Molecule labelled = read_text_as(
      "a.cif", cell + "loop_\n_atom_site_label\n" + columns +
                   "Ca1 0 0 0\nHO1 .1 0 0\nC12 .2 0 0\nCL1 .3 0 0\nSi .4 0 0\nOW1 .5 0 0\n");
  EXPECT_EQ(elements(labelled), "Ca H C Cl Si O ");
  EXPECT_EQ(labelled.elements_guessed, 6U);
  const Molecule symbols =
      read_text_as("a.cif", cell + "loop_\n_atom_site_label\n_atom_site_type_symbol\n" + columns +
                                "X1 Ho3+ 0 0 0\nX2 c .1 0 0\nX3 O2- .2 0 0\n");
  EXPECT_EQ(elements(symbols), "Ho C O ");
  EXPECT_EQ(symbols.elements_guessed, 0U);
  const Molecule mixed =
      read_text_as("a.cif", cell + "loop_\n_atom_site_label\n_atom_site_type_symbol\n" + columns +
                                "N1 C 0 0 0\nCa1 ? .1 0 0\nO1 . .2 0 0\n");
  EXPECT_EQ(elements(mixed), "C Ca O ");
  EXPECT_EQ(mixed.elements_guessed, 2U);
}

// The metric tensor of the cell says every distance, whichever way the axes are laid: with
// fractions f and g, d^2 = sum over i, j of (f - g)_i (f - g)_j (a_i . a_j).
TEST(SmallCif, ObliqueCellsKeepTheirDistances) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  const double edges[3] = {5.1, 7.3, 9.7},
               cosines[3] = {std::cos(81 * kDegree), std::cos(97.5 * kDegree),
                             std::cos(112 * kDegree)};
  const double fractions[4][3] = {{0, 0, 0}, {0.3, 0.1, 0.2}, {-0.25, 0.9, 0.4}, {0.7, -0.6, 1.1}};
  std::string text =
      "data_x\n_cell_length_a 5.1\n_cell_length_b 7.3\n_cell_length_c 9.7\n"
      "_cell_angle_alpha 81\n_cell_angle_beta 97.5\n_cell_angle_gamma 112\n"
      "loop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n";
  for (const auto& f : fractions)
    text += "C1 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " + std::to_string(f[2]) +
            "\n";
  const Molecule molecule = read_text_as("a.cif", text);
  ASSERT_EQ(molecule.atoms.size(), 4U);
  constexpr double kRounding = 1e-12;  // Å; some tens of roundings of numbers below 20
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double squared = 0;
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          squared += (fractions[i][a] - fractions[j][a]) * (fractions[i][b] - fractions[j][b]) *
                     edges[a] * edges[b] * (a == b ? 1 : cosines[3 - a - b]);
      EXPECT_NEAR(norm(molecule.atoms[i].position - molecule.atoms[j].position), std::sqrt(squared),
                  kRounding);
    }
  EXPECT_EQ(molecule.atoms[0].position, (Vec3d{0, 0, 0}));
}

// Groups of disorder are alternate locations: that of the higher occupancy stays, with atoms that
// belong to no group. Negative numbers are of atoms disordered about a symmetry element.
TEST(SmallCif, GroupsOfDisorderAreAlternateLocations) {
  const std::string text =
      "data_x\n_cell_length_a 10\n_cell_length_b 10\n_cell_length_c 10\n"
      "_cell_angle_alpha 90\n_cell_angle_beta 90\n_cell_angle_gamma 90\n"
      "loop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n"
      "_atom_site_occupancy\n_atom_site_disorder_group\n"
      "C1 0 0 0 1 .\nC2 0.1 0 0 0.3 1\nC2 0.2 0 0 0.7 2\nC3 0.3 0 0 0.3 1\nC3 0.4 0 0 0.7 2\n";
  const auto places = [](const Molecule& molecule) {
    std::vector<double> x;
    for (const Atom& atom : molecule.atoms) x.push_back(std::round(atom.position.x));
    return x;
  };
  EXPECT_EQ(places(read_text_as("a.cif", text)), (std::vector<double>{0, 2, 4}));
  EXPECT_EQ(read_text_as("a.cif", text).skipped, (SkippedAtoms{{"alternate_locations", 2}}));
  ReadOptions options;
  options.altloc = "1";
  EXPECT_EQ(places(read_text_as("a.cif", text, options)), (std::vector<double>{0, 1, 3}));
  const std::string symmetric = "C4 0.5 0 0 0.5 -1\n";
  EXPECT_EQ(places(read_text_as("a.cif", text + symmetric, options)),
            (std::vector<double>{0, 1, 3, 5}));
}

TEST(MmCif, LettersInFrontOfResidueNumbersGoBehind) {
  const std::string row = "ATOM 1 P P . U A 1 0 0 0 1 10 A46 A 1\n";
  const Molecule molecule = read_text_as("a.cif", kColumns + row);
  EXPECT_EQ(molecule.atoms.at(0).residue_number, "46A");
  ASSERT_EQ(molecule.warnings.size(), 1U);
  EXPECT_THAT(molecule.warnings[0], HasSubstr("row 1 of _atom_site: 'A46'"));
  EXPECT_THAT(refusal_of_text<FileFormatError>(
                  "a.cif", kColumns + row + "ATOM 2 P P . U A 1 0 0 9 1 10 46A A 1\n"),
              HasSubstr("cannot be told apart"));
  EXPECT_THAT(refusal_of_text<FileFormatError>(
                  "a.cif", kColumns + "ATOM 1 P P . U A 1 0 0 0 1 10 AB46 A 1\n"),
              HasSubstr("auth_seq_id is 'AB46'"));
}

TEST(MmCif, AtomsOfMessagesAreRows) {
  const std::string text = kColumns + "ATOM 7 C C . GLY A 1 0 0 0 1 10 1 A 1\n" +
                           "HETATM 9 Q1 Q1 . LIG A 1 5 0 0 1 10 2 A 1\n";
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.cif", text),
              HasSubstr("(serial 9, row 2 of _atom_site)"));
}

const std::string kComponent =
    "data_3UQ\n_chem_comp.id 3UQ\nloop_\n_chem_comp_atom.comp_id\n_chem_comp_atom.atom_id\n"
    "_chem_comp_atom.type_symbol\n_chem_comp_atom.model_Cartn_x\n_chem_comp_atom.model_Cartn_y\n"
    "_chem_comp_atom.model_Cartn_z\n_chem_comp_atom.pdbx_model_Cartn_x_ideal\n"
    "_chem_comp_atom.pdbx_model_Cartn_y_ideal\n_chem_comp_atom.pdbx_model_Cartn_z_ideal\n";

TEST(ChemicalComponent, TheFirstSetWithAllAtomsIsRead) {
  const Molecule whole = read_text_as(
      "a.cif", kComponent + "3UQ C1 C 1.0 2.0 3.0 0.0 0.0 0.0\n3UQ CL1 CL 3 2 3 1.2 0 0\n");
  ASSERT_EQ(whole.atoms.size(), 2U);
  EXPECT_EQ(whole.atoms[0].position, (Vec3d{1, 2, 3}));
  EXPECT_EQ(whole.atoms[1].element, "Cl");
  EXPECT_EQ(whole.atoms[1].residue_name, "3UQ");
  EXPECT_THAT(whole.warnings.at(0), HasSubstr("example_xyz"));
  const Molecule part = read_text_as(
      "a.cif", kComponent + "3UQ C1 C 1.0 2.0 3.0 0.0 0.0 0.0\n3UQ O1 O ? ? ? 1.2 0.0 0.0\n");
  EXPECT_EQ(part.atoms.at(1).position, (Vec3d{1.2, 0, 0}));
  EXPECT_THAT(part.warnings.at(0), HasSubstr("ideal_xyz"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.cif", kComponent + "3UQ C1 C ? ? ? ? ? ?\n"),
              HasSubstr("chemical component"));
}

}  // namespace
}  // namespace vdwmesh::testing
