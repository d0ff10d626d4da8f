// GRO, MOL2, molfiles with SDF, and XYZ. The files are made by hand after the texts of the formats:
// GROMACS's manual, Tripos' "Mol2 File Format", BIOVIA's "CTfile Formats" and the XYZ of XMol.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>
#include <tuple>
#include <vector>

#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The two waters of GROMACS's manual, whose names of residues have five letters.
constexpr const char* kWaters =
    "MD of 2 waters, t= 0.0\n    6\n"
    "    1WATER  OW1    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434\n"
    "    1WATER  HW2    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791\n"
    "    1WATER  HW3    3   0.177   1.568   1.613 -0.9045 -2.6469  1.3180\n"
    "    2WATER  OW1    4   1.275   0.053   0.622  0.2519  0.3140 -0.1734\n"
    "    2WATER  HW2    5   1.337   0.002   0.680 -1.0641 -1.1349  0.0257\n"
    "    2WATER  HW3    6   1.326   0.120   0.568  1.9427 -0.8216 -0.0244\n"
    "   1.82060   1.82060   1.82060\n";

constexpr const char* kIon =
    "one\n2\n    1ALA     CA    1   0.100  -0.200   0.300\n"
    "    2CL      CL    2   1.000   1.000   1.000\n   5.0 5.0 5.0\n";

constexpr const char* kMol2 =
    "# made for a test\n@<TRIPOS>MOLECULE\nfirst\n 5 1 2\nSMALL\nUSER_CHARGES\n\n"
    "@<TRIPOS>ATOM\n"
    "1 CA 0.1 0.2 -0.3 C.3 1 ALA12 0.1 BACKBONE\n"
    "2 N1 1.5 0.0 0.0 N.ar 1 ALA12\n"
    "3 C1 3.0 0.0 0.0 C.ar 2 SO4 0.0\n"
    "4 LP1 3.1 0.0 0.0 LP 2 SO4\n"
    "5 X 3.2 0.0 0.0 Du\n"
    "@<TRIPOS>BOND\n1 1 2 1\n"
    "@<TRIPOS>SUBSTRUCTURE\n1 ALA12 1 RESIDUE 1 B ALA 1\n";

// An atom of V2000.
std::string atom_line(double x, const std::string& symbol) {
  return fmt::format("{:10.4f}{:10.4f}{:10.4f} {:<3} 0  0  0  0  0  0  0  0  0  0  0  0\n", x, 0.5,
                     -x, symbol);
}
constexpr const char* kHead = "title\n  PROGRAM 3D\n\n";
const std::string kMolfile = std::string(kHead) + "  2  1  0  0  0  0  0  0  0  0999 V2000\n" +
                             atom_line(-1.25, "C") + atom_line(0, "Cl") + "  1  2  1  0\nM  END\n";
const std::string kV3000 = std::string(kHead) +
                           "  0  0  0     0  0            999 V3000\nM  V30 BEGIN CTAB\n"
                           "M  V30 COUNTS 2 1 0 0 0\nM  V30 BEGIN ATOM\n"
                           "M  V30 1 C -1.25 0.5 1.25 0 CHG=1 -\nM  V30 MASS=13\n"
                           "M  V30 2 Cl 0 0.5 0 0\nM  V30 END ATOM\nM  V30 BEGIN BOND\n"
                           "M  V30 1 1 1 2\nM  V30 END BOND\nM  V30 END CTAB\nM  END\n";

// "C1 C ALA A 12" of each atom: name, element, residue, chain, number.
std::vector<std::string> atoms_of(const Molecule& molecule) {
  std::vector<std::string> found;
  for (const Atom& a : molecule.atoms)
    found.push_back(fmt::format("{} {} {} {} {}", a.name.view(), a.element.view(),
                                a.residue_name.view(), a.chain.empty() ? "-" : a.chain.view(),
                                a.residue_number.view()));
  return found;
}

ReadOptions with_model(const std::string& model) {
  ReadOptions options;
  options.model = model;
  return options;
}

TEST(Gro, ColumnsOfTheManualAreRead) {
  ReadOptions options;
  options.waters = Inclusion::keep;
  const Molecule molecule = read_text_as("a.gro", kWaters, options);
  EXPECT_THAT(atoms_of(molecule),
              ElementsAre("OW1 O WATER - 1", "HW2 H WATER - 1", "HW3 H WATER - 1",
                          "OW1 O WATER - 2", "HW2 H WATER - 2", "HW3 H WATER - 2"));
  EXPECT_NEAR(molecule.atoms[1].position.x, 1.9, 1e-15);
  EXPECT_NEAR(molecule.atoms[1].position.z, 17.47, 1e-14);
  EXPECT_EQ(molecule.atoms[5].serial, 6);
  EXPECT_EQ(molecule.format, "gro");
  EXPECT_THAT(molecule.notes, Contains(HasSubstr("in nm")));
  EXPECT_THAT(molecule.notes, Contains(HasSubstr("1.82060 × 1.82060 × 1.82060")));
  EXPECT_EQ(molecule.elements_guessed, 6U);
}

TEST(Gro, UnitsThatAreNamedHold) {
  ReadOptions options;
  options.unit = LengthUnit::angstrom;
  EXPECT_EQ(read_text_as("a.gro", kIon, options).atoms.at(0).position, (Vec3d{0.1, -0.2, 0.3}));
  options.unit = LengthUnit::picometre;
  EXPECT_EQ(read_text_as("a.gro", kIon, options).atoms.at(1).position, (Vec3d{0.01, 0.01, 0.01}));
}

TEST(Gro, PrecisionFollowsFromThePoints) {
  const Molecule molecule = read_text_as(
      "a.gro",
      "six digits\n1\n    1ALA     CA    1   0.123456  -1.234567  12.345678  0.1234567 "
      " 0.1234567  0.1234567\n 0 0 0\n");
  EXPECT_NEAR(molecule.atoms.at(0).position.x, 1.23456, 1e-15);
  EXPECT_NEAR(molecule.atoms.at(0).position.y, -12.34567, 1e-14);
  EXPECT_NEAR(molecule.atoms.at(0).position.z, 123.45678, 1e-13);
}

TEST(Gro, FramesAreModels) {
  const std::string second = "two\n1\n    1ALA     CB    1   9.000   0.000   0.000\n 0 0 0\n";
  const Molecule first = read_text_as("a.gro", kIon + second);
  EXPECT_THAT(atoms_of(first), ElementsAre("CA C ALA - 1", "CL Cl CL - 2"));
  EXPECT_EQ(first.skipped.at("other_models"), 1U);
  EXPECT_THAT(atoms_of(read_text_as("a.gro", kIon + second, with_model("2"))),
              ElementsAre("CB C ALA - 1"));
}

TEST(Gro, NumbersThatWrapBeginNewResidues) {
  std::string text = "wraps\n4\n";
  for (const int number : {99999, 0, 1, 99999})
    text += fmt::format("{:5}LIG     C1{:5}{:8.3f}{:8.3f}{:8.3f}\n", number, number % 2, 1.0, 1.0,
                        number * 1e-3);
  const Molecule molecule = read_text_as("a.gro", text + " 0 0 0\n");
  ASSERT_EQ(molecule.atoms.size(), 4U);
  EXPECT_EQ(molecule.atoms[0].residue_number, molecule.atoms[3].residue_number);
  EXPECT_NE(molecule.atoms[0].residue, molecule.atoms[3].residue);
}

TEST(Gro, ResiduesThatTheBoxCutsAreWarnedOf) {
  const auto text = [](double x) {
    return fmt::format(
        "cut\n2\n    1ALA     CA    1   0.100   0.000   0.000\n"
        "    1ALA     CB    2{:8.3f}   0.000   0.000\n   5.0 5.0 5.0\n",
        x);
  };
  EXPECT_THAT(read_text_as("a.gro", text(4.95)).warnings, Contains(HasSubstr("1 residues")));
  EXPECT_THAT(read_text_as("a.gro", text(0.25)).warnings, IsEmpty());
}

TEST(Gro, SitesAreNoAtomsAndBeadsHaveNoElements) {
  const std::string site = "site\n2\n    1ALA     CA    1   0.100   0.000   0.000\n";
  const Molecule molecule =
      read_text_as("a.gro", site + "    2LIG    MW1    2   1.000   0.000   0.000\n 0 0 0\n");
  EXPECT_THAT(atoms_of(molecule), ElementsAre("CA C ALA - 1"));
  EXPECT_EQ(molecule.skipped.at("virtual_sites"), 1U);
  EXPECT_THAT(refusal_of_text<InvalidInput>(
                  "a.gro", site + "    2ALA     BB    2   1.000   0.000   0.000\n 0 0 0\n"),
              HasSubstr("Martini"));
}

TEST(Mol2, TypesGiveElementsAndSubstructuresResidues) {
  const Molecule molecule = read_text_as("a.mol2", kMol2);
  EXPECT_THAT(atoms_of(molecule), ElementsAre("CA C ALA B 12", "N1 N ALA B 12", "C1 C SO4 - 2"));
  EXPECT_EQ(molecule.atoms[0].position, (Vec3d{0.1, 0.2, -0.3}));
  EXPECT_EQ(molecule.skipped.at("virtual_sites"), 2U);
  EXPECT_EQ(molecule.elements_guessed, 0U);
  EXPECT_THAT(molecule.warnings, IsEmpty());
}

// One atom of this name and type.
std::string mol2_atom(const std::string& name, const std::string& type,
                      const std::string& residue = "1 LIG1") {
  return "@<TRIPOS>MOLECULE\nx\n1\nSMALL\nNO_CHARGES\n@<TRIPOS>ATOM\n1 " + name + " 0 0 0 " + type +
         " " + residue + "\n";
}

TEST(Mol2, TypesOfForceFieldsAreNoSymbols) {
  const std::vector<std::tuple<const char*, const char*, const char*>> told = {
      {"C5", "ca", "C"}, {"O1", "os", "O"},        {"C2", "cd", "C"},
      {"H1", "ho", "H"}, {"CA", "CT", "C"},        {"CL1", "cl", "Cl"},
      {"HA", "HC", "H"}, {"C01", "opls_135", "C"}, {"C7", "CG2R61", "C"}};
  for (const auto& [name, type, element] : told) {
    const Molecule molecule = read_text_as("a.mol2", mol2_atom(name, type));
    EXPECT_EQ(molecule.atoms.at(0).element, element) << type;
    EXPECT_EQ(molecule.elements_guessed, 1U) << type;
    EXPECT_THAT(molecule.warnings, Contains(HasSubstr("none of SYBYL"))) << type;
  }
}

TEST(Mol2, SymbolsOfSybyl) {
  const std::vector<std::tuple<const char*, const char*, const char*>> told = {
      {"X1", "C.cat", "C"}, {"X1", "O.co2", "O"},  {"X1", "S.O2", "S"}, {"X1", "Cr.oh", "Cr"},
      {"X1", "Ca", "Ca"},   {"X1", "Co.oh", "Co"}, {"X1", "P.3", "P"},  {"X1", "H.spc", "H"},
      {"X1", "Br", "Br"},   {"X1", "Pt", "Pt"},    {"X1", "Li", "Li"},  {"X1", "N.pl3", "N"}};
  ReadOptions options;
  options.radii = "alvarez";
  for (const auto& [name, type, element] : told) {
    const Molecule molecule = read_text_as("a.mol2", mol2_atom(name, type), options);
    EXPECT_EQ(molecule.atoms.at(0).element, element) << type;
    EXPECT_EQ(molecule.elements_guessed, 0U) << type;
  }
  for (const char* type : {"Any", "Hal", "Hev", "Het"})
    EXPECT_THAT(refusal_of_text<InvalidInput>("a.mol2", mol2_atom("X1", type)),
                HasSubstr("cannot be told"));
}

TEST(Mol2, NamesOfSubstructures) {
  const std::vector<std::tuple<const char*, const char*>> told = {
      {"1 LIG1", "LIG - 1"},   {"1 <0>", "<0> - 1"}, {"3 HEM154", "HEM154 - 3"}, {"", "UNL A 1"},
      {"7 DA12", "DA - 12"},   {"4 SO4", "SO4 - 4"}, {"1 ****", "UNL A 1"},      {"2", "UNL A 2"},
      {"9 ALA-3", "ALA - -3"}, {"1 UNL1", "UNL - 1"}};
  for (const auto& [fields, residue] : told)
    EXPECT_THAT(atoms_of(read_text_as("a.mol2", mol2_atom("C1", "C.3", fields))),
                ElementsAre(fmt::format("C1 C {}", residue)))
        << fields;
}

TEST(Mol2, MoleculesAreModels) {
  const std::string text = kMol2 + mol2_atom("O1", "O.3");
  EXPECT_EQ(read_text_as("a.mol2", text).skipped.at("other_models"), 1U);
  EXPECT_THAT(atoms_of(read_text_as("a.mol2", text, with_model("2"))), ElementsAre("O1 O LIG - 1"));
}

TEST(Molfile, BothVersionsSayTheSame) {
  for (const std::string& text : {kMolfile, kV3000}) {
    const Molecule molecule = read_text_as("a.mol", text);
    EXPECT_THAT(atoms_of(molecule), ElementsAre("C C UNL A 1", "Cl Cl UNL A 1"));
    EXPECT_EQ(molecule.atoms[0].position, (Vec3d{-1.25, 0.5, 1.25}));
    EXPECT_EQ(molecule.format, "sdf");
    EXPECT_THAT(molecule.warnings, IsEmpty());
  }
}

TEST(Molfile, MoleculesOfSdfAreModelsByTheirPlace) {
  const std::string data = "> <NAME>\nM  END is no end here\n\n$$$$\n";
  const std::string empty =
      std::string(kHead) + "  0  0  0  0  0  0  0  0  0  0999 V2000\nM  END\n";
  const std::string text = kMolfile + data + empty + data + kV3000 + data;
  const Molecule molecule = read_text_as("a.sdf", text);
  EXPECT_EQ(molecule.atoms.size(), 2U);
  EXPECT_EQ(molecule.skipped.at("other_models"), 2U);
  EXPECT_THAT(molecule.warnings, ElementsAre(HasSubstr("1 of the molecules have no atoms")));
  EXPECT_EQ(read_text_as("a.sdf", text, with_model("3")).atoms.size(), 2U);
  EXPECT_EQ(read_text_as("a.sdf", text, with_model("all")).atoms.at(3).serial, 2);
}

TEST(Molfile, DrawingsAndMissingEndsAreWarnedOf) {
  const std::string flat =
      "t\n  PROGRAM 01012601012D\n\n  1  0  0  0  0  0  0  0  0  0999 V2000\n" + atom_line(0, "C");
  EXPECT_THAT(read_text_as("a.mol", flat + "M  END\n").warnings,
              ElementsAre(HasSubstr("two dimensions")));
  EXPECT_THAT(read_text_as("a.mol", flat).warnings, Contains(HasSubstr("no M  END")));
}

TEST(Xyz, SymbolsAndNumbers) {
  const Molecule molecule =
      read_text_as("a.xyz",
                   "6\n comment\nC 0 0 1.5\n17 1 2 3\ncl 4 0 0 0.5\nZN 8 0 0\nO2- 12 0 0\n"
                   "XX 0 0 9\n");
  EXPECT_THAT(atoms_of(molecule), ElementsAre("C C UNL A 1", "Cl Cl UNL A 1", "cl Cl UNL A 1",
                                              "ZN Zn UNL A 1", "O2- O UNL A 1"));
  EXPECT_EQ(molecule.atoms[1].position, (Vec3d{1, 2, 3}));
  EXPECT_EQ(molecule.skipped.at("virtual_sites"), 1U);
  EXPECT_THAT(molecule.notes, Contains(HasSubstr("columns behind z")));
}

TEST(Xyz, FramesAreModels) {
  const std::string text = "1\n\nC 0 0 0\n2\n\nO 1 0 0\n0 2 0 0\n\n";
  EXPECT_EQ(read_text_as("a.xyz", text).skipped.at("other_models"), 2U);
  const Molecule second = read_text_as("a.xyz", text, with_model("2"));
  EXPECT_THAT(atoms_of(second), ElementsAre("O O UNL A 1"));
  EXPECT_EQ(second.skipped.at("virtual_sites"), 1U);
}

TEST(Xyz, ColumnsOfTheExtendedForm) {
  const std::string head = "1\nLattice=\"9 0 0 0 9 0 0 0 9\" Properties=";
  EXPECT_THAT(read_text_as("a.xyz", head + "species:S:1:pos:R:3:q:R:1 pbc=T\nC 0 0 0 1\n").notes,
              Contains(HasSubstr("lattice")));
  EXPECT_THAT(
      refusal_of_text<FileFormatError>("a.xyz", head + "id:I:1:species:S:1:pos:R:3\n1 C 0 0 0\n"),
      HasSubstr("a.xyz:2: the columns are"));
}

TEST(Xyz, NamesAreNotTakenForSymbols) {
  const auto refusal = [](const std::string& word) {
    return refusal_of_text<FileFormatError>("a.xyz", "1\n\n" + word + " 0 0 0\n");
  };
  for (const char* word : {"CA", "CD", "HG", "ca", "NE", "HO", "NA", "HG1", "CE"})
    EXPECT_THAT(refusal(word),
                HasSubstr("a.xyz:3: '" + std::string(word) + "' may be the element"));
  for (const char* word : {"CB", "OW", "HD11", "N_3", "Carbon", "1HB", "Jx"})
    EXPECT_THAT(refusal(word), HasSubstr("is no symbol of an element"));
  EXPECT_EQ(read_text_as("a.xyz", "1\n\nCa 0 0 0\n").atoms.at(0).element, "Ca");
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.xyz", "1\n\nX 0 0 0\n"),
              HasSubstr("the element of atom X"));
}

// Line ends, a byte order mark, gzip and a missing last line break change nothing.
TEST(AtomLines, TheSameFileInOtherBytes) {
  const std::vector<std::pair<std::string, std::string>> files = {{"a.gro", kIon},
                                                                  {"a.mol2", kMol2},
                                                                  {"a.mol", kMolfile},
                                                                  {"a.sdf", kV3000},
                                                                  {"a.xyz", "1\n\nC 0 0 0.25\n"}};
  for (const auto& [name, text] : files) {
    const std::vector<std::string> expected = atoms_of(read_text_as(name, text));
    std::string windows, old;
    for (const char c : text) {
      windows += c == '\n' ? "\r\n" : std::string(1, c);
      old += c == '\n' ? '\r' : c;
    }
    EXPECT_EQ(atoms_of(read_text_as(name, windows)), expected) << name;
    EXPECT_EQ(atoms_of(read_text_as(name, old)), expected) << name;
    EXPECT_EQ(atoms_of(read_text_as(name, "\xef\xbb\xbf" + text)), expected) << name;
    EXPECT_EQ(atoms_of(read_text_as(name + ".gz", gzipped(text))), expected) << name;
    EXPECT_EQ(atoms_of(read_text_as(name, text.substr(0, text.size() - 1))), expected) << name;
  }
}

struct Damaged {
  std::string name, text, message;
};

std::vector<Damaged> damaged_files() {
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    EXPECT_NE(text.find(from), text.npos) << from;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string ion = kIon, mol2 = kMol2;
  return {
      {"a.gro", changed(ion, "-0.200", "-0.2x0"), "a.gro:3: y is '  -0.2x0'"},
      {"a.gro", changed(ion, "   0.300", "  0.300"), "a.gro:3: .gro needs x, y and z in fixed"},
      {"a.gro", changed(ion, "   1.000   1.000   1.000", "   1.00"), "a.gro:4: .gro needs"},
      {"a.gro", changed(ion, "    2CL ", "    bCL "), "a.gro:4: 'b' in columns 1-5"},
      {"a.gro", changed(ion, "\n2\n", "\n1\n"), "a.gro:4: the box, 3 or 9 numbers"},
      {"a.gro", changed(ion, "\n2\n", "\n3\n"), "a.gro:5: .gro needs"},
      {"a.gro", changed(ion, "\n2\n", "\n4\n"), "a.gro:5: .gro needs"},
      {"a.gro", changed(ion, "\n2\n", "\n-2\n"), "a.gro:2: '-2' stands where the number of atoms"},
      {"a.gro", ion.substr(0, ion.find("    2CL")), "ends behind line 3, where atom 2 of 2"},
      {"a.gro", "title\n0\n1 1 1\n", "has no atoms"},
      {"a.gro", "title\n99999999999999999999\n", "stands where the number of atoms"},
      {"a.gro", "ATOM\nATOM      2  CA  ALA A   1\n", "a.gro:2: "},
      {"a.mol2", changed(mol2, " 5 1 2", " 6 1 2"),
       "molecule 1, with 5 atoms, of which its header"},
      {"a.mol2", changed(mol2, " 5 1 2", " five"), "a.mol2:4: 'five' stands where"},
      {"a.mol2", changed(mol2, "0.2 -0.3", "0.2 -0.3e"), "a.mol2:9: z is '-0.3e'"},
      {"a.mol2", changed(mol2, " Du\n", "\n"), "a.mol2:13: has 5 fields"},
      {"a.mol2", changed(mol2, " BACKBONE", " \\"), "a.mol2:9: goes on in the next line"},
      {"a.mol2", "@<TRIPOS>ATOM\n1 C 0 0 0 C.3\n", "before the first"},
      {"a.mol2", "C 0 0 0\n", "is not MOL2"},
      {"a.mol", changed(kMolfile, "0.5000    1.2500", "0.5000    1.25x0"), "a.mol:5: z is"},
      {"a.mol", changed(kMolfile, "  2  1  0", "  3  1  0"), "a.mol:7: x is"},
      {"a.mol", changed(kMolfile, "  2  1  0", "  1  1  0"), "a.mol:6: bond 1 of 1 should stand"},
      {"a.mol", changed(kMolfile, "  1  2  1  0", "  1  3  1  0"), "between two of 2 atoms"},
      {"a.mol", changed(kMolfile, "  2  1  0", "  two  0"), "stands where the number of atoms"},
      {"a.mol", kMolfile.substr(0, 130), "ends behind line 5, where atom 2 of 2"},
      {"a.mol", changed(kMolfile, "Cl ", "CA "), "a.mol:6: 'CA' may be the element Ca"},
      {"a.mol", changed(kMolfile, "Cl ", "CB "), "a.mol:6: 'CB' is no symbol"},
      {"a.mol", changed(kV3000, "COUNTS 2", "COUNTS 3"), "with 2 atoms, of which COUNTS says 3"},
      {"a.mol", changed(kV3000, "M  END\n", ""), "where M  END should follow"},
      {"a.mol", changed(kV3000, " 0 0.5 0 0", " 0 0.5"), "has 4 fields"},
      {"a.mol", changed(kV3000, "2 Cl", "2 NOT [C,N]"), "x is '[C,N]'"},
      {"a.sdf", "$RXN\n\n\n\n", "is a reaction"},
      {"a.xyz", "2\n\nC 0 0 0\n", "ends behind line 3, where atom 2 of 2 should follow"},
      {"a.xyz", "1\n\nC 0 0 0\nC 1 0 0\n", "a.xyz:4: 'C 1 0 0' stands where the number of atoms"},
      {"a.xyz", "1\n\nC 0 0\n", "a.xyz:3: has 3 fields"},
      {"a.xyz", "1\n\nC 0 0 nan\n", "a.xyz:3: z is 'nan'"},
      {"a.xyz", "1\n\nC 0 0 1e7\n", "coordinates and radii of up to 1e+06"},
      {"a.xyz", "1\n\n119 0 0 0\n", "'119' is no atomic number"},
      {"a.xyz", "1\n", "ends behind line 1, where a comment"},
      {"a.xyz", "C 0 0 0\n", "a.xyz:1: 'C 0 0 0' stands where the number of atoms"},
      // The content tells these formats, whatever the name says.
      {"a.xyz", kMol2, "holds MOL2; rename it to .mol2"},
      {"a.pdb", kMolfile, "holds a molfile or SDF; rename it to .sdf"},
      {"a.gro", kV3000, "holds a molfile or SDF"},
      {"a.cif", mol2.substr(mol2.find('@')), "is not mmCIF"},
  };
}

TEST(AtomLines, DamagedFilesAreRefusedByTheirLine) {
  for (const Damaged& file : damaged_files()) {
    SCOPED_TRACE(file.text);
    EXPECT_THAT(refusal_of_text<Error>(file.name, file.text), HasSubstr(file.message));
  }
}

TEST(AtomLines, WatersCannotBeToldWithoutResidues) {
  ReadOptions options;
  options.waters = Inclusion::keep;
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.xyz", "1\n\nC 0 0 0\n", options),
              HasSubstr("leave out --waters"));
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.mol", kMolfile, options),
              HasSubstr("leave out --waters"));
}

TEST(AtomLines, SelectionsAndRadiiGoByResidues) {
  ReadOptions options;
  options.select = "resn ALA and chain B";
  options.radii = "protor";
  const Molecule molecule = read_text_as("a.mol2", kMol2, options);
  EXPECT_EQ(molecule.atoms.size(), 2U);
  EXPECT_EQ(molecule.atoms[0].radius, 1.88);  // CA of ALA with its hydrogen (Tsai et al. 1999)
  options = {};
  options.select = "protein";
  EXPECT_THAT(atoms_of(read_text_as("a.gro", kIon, options)), ElementsAre("CA C ALA - 1"));
}

}  // namespace
}  // namespace vdwmesh::testing
