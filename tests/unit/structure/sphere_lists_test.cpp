#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "structure/read/unexpanded.hpp"
#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

TEST(Pqr, ByBlanksWithAndWithoutChain) {
  const Molecule molecule =
      read_text_as("a.pqr",
                   "REMARK\n"
                   "ATOM  5 N      MET    1   -6.40600   5.46900  -3.25900 -0.30000 1.85000\n"
                   "ATOM  6 CA MET B 1 1.0 2.0 3.0 0.1 2.275\n"
                   "HETATM 7 ZN ZN B 301 1.0 2.0 3.0 2.0 1.4\nTER\nEND\n");
  ASSERT_EQ(molecule.atoms.size(), 3U);
  EXPECT_EQ(molecule.atoms[0].position, (Vec3d{-6.406, 5.469, -3.259}));
  EXPECT_EQ(molecule.atoms[0].radius, 1.85);
  EXPECT_EQ(molecule.atoms[0].element, "N");
  EXPECT_EQ(molecule.atoms[0].serial, 5);
  EXPECT_EQ(molecule.atoms[1].chain, "B");
  EXPECT_EQ(molecule.atoms[1].element, "C");
  EXPECT_EQ(molecule.atoms[1].residue_number, "1");
  EXPECT_EQ(molecule.atoms[2].element, "Zn");
  EXPECT_TRUE(molecule.atoms[2].hetero);
  EXPECT_EQ(molecule.radius_set, "file");
  EXPECT_TRUE(molecule.radii_assumed.empty());
}

TEST(Pqr, ByColumnsWhereNumbersTouch) {
  const Molecule molecule = read_text_as(
      "a.pqr", "ATOM      1  N   ALA A   1    -100.024-100.103-100.101  0.1414 1.8240\n");
  EXPECT_EQ(molecule.atoms.at(0).position, (Vec3d{-100.024, -100.103, -100.101}));
  EXPECT_EQ(molecule.atoms.at(0).radius, 1.824);
  EXPECT_EQ(molecule.atoms.at(0).chain, "A");
}

// "name residue chain number x radius" of the one atom, or "refused" and the message.
std::string what_is_read(const std::string& line) {
  const TemporaryDirectory dir;
  ReadOptions options;
  options.waters = Inclusion::keep;
  try {
    const Molecule molecule = read_structure(dir.write("a.pqr", line + "\n"), options);
    const Atom& a = molecule.atoms.at(0);
    const std::string chain(a.chain.empty() ? "-" : a.chain);
    return fmt::format("{} {} {} {} {} {}", a.name.view(), a.residue_name.view(), chain,
                       a.residue_number.view(), a.position.x, a.radius);
  } catch (const FileFormatError& error) {
    return fmt::format("refused {}", error.what());
  }
}

TEST(Pqr, DialectsOfProgramsAreRead) {
  std::ifstream table(VDWMESH_PQR_DIALECTS);
  std::size_t rows = 0;
  for (std::string row; std::getline(table, row);) {
    if (row.starts_with('#')) continue;
    std::istringstream fields(row);
    std::string program, line, expected;
    std::getline(std::getline(std::getline(fields, program, '|'), line, '|'), expected);
    SCOPED_TRACE(program);
    if (expected.starts_with("refused "))
      EXPECT_THAT(what_is_read(line), HasSubstr(expected.substr(8)));
    else
      EXPECT_EQ(what_is_read(line), expected);
    ++rows;
  }
  EXPECT_GT(rows, 30U);
}

TEST(Pqr, ColumnsThatLookSwappedAreRefused) {
  const std::string swapped =
      "ATOM 1 N ALA 1 0 0 0 1.8240 0.1414\nATOM 2 H1 ALA 1 1 0 0 0.6 0.1997\n";
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pqr", swapped), HasSubstr("look swapped"));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pqr", "ATOM 1 N ALA 1 0 0 0 1.8240 -0.4157\n"),
              HasSubstr("a.pqr:1: the radius is -0.4157"));
  // A single atom of carbon with such numbers is odd, but beside one in order it is no proof.
  EXPECT_EQ(read_text_as("a.pqr", "ATOM 1 N ALA 1 0 0 0 1.2 0.5\nATOM 2 C ALA 1 1 0 0 0.1 1.9\n")
                .atoms.size(),
            2U);
}

TEST(Pqr, WhatIsPassedOverIsTold) {
  const Molecule quiet = read_text_as("a.pqr",
                                      "REMARK 1\n# a comment\n\nCRYST1 1 1 1\nMODEL 1\n"
                                      "ATOM 1 N ALA 1 0 0 0 0 1.5\nTER\nENDMDL\nCONECT 1 2\nEND\n");
  EXPECT_TRUE(quiet.warnings.empty());
  const Molecule told =
      read_text_as("a.pqr",
                   "ATOM 1 N ALA 1 0.0 0.0 0.0 0 1.5 2.5\nATOMS 2 N ALA 1 0 0 0 0 1.5\n"
                   "N 0 0 0 1.5\n");
  ASSERT_EQ(told.warnings.size(), 2U);
  EXPECT_THAT(told.warnings[0], HasSubstr("2, of which line 2 is the first: 'ATOMS 2 N"));
  EXPECT_THAT(told.warnings[1], HasSubstr("of 1 atoms, of which line 1 is the first: '2.5'"));
}

TEST(Pqr, ZeroRadiiAreCountedNotUsed) {
  const Molecule molecule =
      read_text_as("a.pqr", "ATOM 1 N ALA 1 0 0 0 0 1.5\nATOM 2 H ALA 1 1 0 0 0 0.0\n");
  EXPECT_EQ(molecule.atoms.size(), 1U);
  EXPECT_EQ(molecule.skipped.at("zero_radius"), 1U);
  EXPECT_THAT(refusal_of_text<InvalidInput>("a.pqr", "ATOM 2 H ALA 1 1 0 0 0 0.0\n"),
              HasSubstr("1 zero_radius"));
}

TEST(Pqr, ElementsFollowFromNames) {
  const Molecule molecule = read_text_as("a.pqr",
                                         "ATOM 1 CA CA 1 0 0 0 0 1\nATOM 2 CA ALA 2 0 0 0 0 1\n"
                                         "ATOM 3 CL1 LIG 3 0 0 0 0 1\nATOM 4 1HB ALA 2 0 0 0 0 1\n"
                                         "ATOM 5 NA NA+ 4 0 0 0 0 1\nATOM 6 FE HEM 5 0 0 0 0 1\n");
  std::string elements;
  for (const Atom& atom : molecule.atoms) elements += atom.element + " ";
  EXPECT_EQ(elements, "Ca C Cl H Na Fe ");
}

TEST(Pqr, WatersFollowTheWaterRule) {
  const std::string text = "ATOM 1 N ALA 1 0 0 0 0 1.5\nATOM 2 O WAT 2 5 0 0 0 1.7\n";
  EXPECT_EQ(read_text_as("a.pqr", text).skipped.at("waters"), 1U);
}

TEST(Pqr, BadFieldsAreRefusedWithTheirLine) {
  const std::string good = "ATOM 1 N ALA 1 0 0 0 0 1.5\n";
  for (const char* bad :
       {"ATOM 2 N ALA 1 0 nan 0 0 1.5", "ATOM 2 N ALA 1 0 0 0 0 -1.5", "ATOM 2 N ALA 1 0 0 0 0 inf",
        "ATOM 2 N ALA 1 0 0 0 0", "ATOM 2", "ATOM 2 N ALA 1 0 0 0 x 1.5"})
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.pqr", good + bad), HasSubstr("a.pqr:2: "));
  EXPECT_THAT(refusal_of_text<FileFormatError>("a.pqr", "REMARK\n"), HasSubstr("nothing to mesh"));
}

TEST(Xyzr, NumbersAndComments) {
  const Molecule molecule =
      read_text_as("a.xyzr", "# two spheres\n0 0 0 1.5\r\n\n 1.25 -2e1 +3 2 1 CA_1 # extra\n");
  ASSERT_EQ(molecule.atoms.size(), 2U);
  EXPECT_EQ(molecule.atoms[1].position, (Vec3d{1.25, -20, 3}));
  EXPECT_EQ(molecule.atoms[1].radius, 2.0);
  EXPECT_EQ(molecule.atoms[1].serial, 2);
  EXPECT_EQ(molecule.format, "xyzr");
}

// What tells nothing of a sphere is refused; what thesis presets leave out is not asked for.
TEST(Xyzr, ChoicesByNamesAndRecordsAreRefused) {
  ReadOptions waters, hydrogens, hetero, preset;
  waters.waters = Inclusion::keep;
  hydrogens.hydrogens = Inclusion::drop;
  hetero.hetero_atoms = Inclusion::drop;
  preset.hetero_atoms = Inclusion::drop_where_told;
  const auto refusal = [](const ReadOptions& options) {
    return refusal_of_text<InvalidInput>("a.xyzr", "0 0 0 1\n", options);
  };
  EXPECT_THAT(refusal(waters), HasSubstr("leave out --waters"));
  EXPECT_THAT(refusal(hydrogens), HasSubstr("leave out --no-hydrogens"));
  EXPECT_THAT(refusal(hetero), HasSubstr("leave out --no-hetatm"));
  EXPECT_EQ(read_text_as("a.xyzr", "0 0 0 1\n", preset).atoms.size(), 1U);
  EXPECT_THAT(refusal_of_text<InvalidInput>(
                  "a.pdb", "HETATM    1  C1  LIG A   1       0.000   0.000   0.000\n", preset),
              HasSubstr("1 hetatm"));
}

TEST(Xyzr, NumbersTooCloseToZeroAreZero) {
  const Molecule molecule =
      read_text_as("a.xyzr", "1e-400 -1E-400 1e-99999999999999999999 1\n0." +
                                 std::string(400, '0') + "1 4e-320 100e-330 2\n");
  EXPECT_EQ(molecule.atoms.at(0).position, (Vec3d{0, 0, 0}));
  EXPECT_EQ(molecule.atoms.at(1).position.x, 0);
  EXPECT_EQ(molecule.atoms.at(1).position.y, 4e-320);
  EXPECT_EQ(molecule.atoms.at(1).position.z, 0);
  for (const char* large : {"1e400", "-1e400", "1e99999999999999999999"})
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr", std::string(large) + " 0 0 1\n"),
                HasSubstr("x is '"));
}

TEST(Xyzr, BadLinesAreRefused) {
  for (const char* bad : {"1 2 3", "1 2 3 -1", "a b c d", "1 2 inf 1", "nan 2 3 1", "1,2,3,1",
                          "1 2 +-3 1", "1 2 ++3 1", "1 2 + 1"})
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr", std::string("0 0 0 1\n") + bad),
                HasSubstr("a.xyzr:2: "));
}

// The lines of a large file are read on all cores, in pieces of some hundred kilobytes.
class LargeXyzr : public ::testing::TestWithParam<const char*> {
 protected:
  static constexpr int kLines = 60'000;

  // Line i has the sphere i, i / 8, -i, 1 + i % 3; every tenth is a comment or empty.
  static std::string text(int faulty_line = -1) {
    std::string all;
    for (int i = 0; i < kLines; ++i) {
      if (i == faulty_line)
        all += "1 2 three 4";
      else if (i % 10 == 9)
        all += i % 20 == 9 ? "# 1 2 3 4" : " \t";
      else
        all += fmt::format("{} {:.3f} {} {}", i, i / 8.0, -i, 1 + i % 3);
      all += GetParam();
    }
    return all;
  }
};

TEST_P(LargeXyzr, KeepsTheOrderOfItsLines) {
  const Molecule molecule = read_text_as("a.xyzr", text());
  ASSERT_EQ(molecule.atoms.size(), static_cast<std::size_t>(kLines / 10 * 9));
  for (std::size_t atom = 0; atom < molecule.atoms.size(); ++atom) {
    const auto line = static_cast<double>(atom / 9 * 10 + atom % 9);
    ASSERT_EQ(molecule.atoms[atom].position, (Vec3d{line, line / 8, -line}));
    ASSERT_EQ(molecule.atoms[atom].radius, 1 + static_cast<int>(line) % 3);
    ASSERT_EQ(molecule.atoms[atom].serial, static_cast<std::int64_t>(atom) + 1);
  }
}

TEST_P(LargeXyzr, NamesTheFirstFaultyLine) {
  for (const int line : {0, 31'234, kLines - 2})
    EXPECT_THAT(refusal_of_text<FileFormatError>("a.xyzr", text(line) + "also at fault\n"),
                HasSubstr(fmt::format("a.xyzr:{}: z is 'three', not a finite number", line + 1)));
}

// By pieces, as processes read it, each of which knows the numbers of spheres of all.
TEST_P(LargeXyzr, PiecesHaveTheSpheresOfTheFile) {
  const std::string whole = text();
  const std::vector<std::string_view> pieces = pieces_of_spheres(whole);
  EXPECT_EQ(pieces.size() > 1, std::string(GetParam()) != "\r");
  std::size_t next = 0, counted = 0;
  for (const std::string_view piece : pieces) {
    counted += count_spheres(piece);
    EXPECT_TRUE(read_spheres(piece, [&next](const Vec3d& center, double radius) {
      const auto line = static_cast<double>(next / 9 * 10 + next % 9);
      EXPECT_EQ(center, (Vec3d{line, line / 8, -line}));
      EXPECT_EQ(radius, 1 + static_cast<int>(line) % 3);
      ++next;
    }));
    EXPECT_EQ(next, counted);
  }
  EXPECT_EQ(next, static_cast<std::size_t>(kLines / 10 * 9));
}

// What the reader refuses or leaves out.
TEST(SphereText, LinesThatAreNoSpheresAreToldFromOthers) {
  const auto is_sound = [](const char* line) {
    return read_spheres(std::string("0 0 0 1\n") + line + "\n0 0 1 1\n",
                        [](const Vec3d&, double) {});
  };
  for (const char* line : {"", "# 1", "1 2 3 4", "1 2 3 4 five", "-1e6 1e6 0 1e6"})
    EXPECT_TRUE(is_sound(line)) << line;
  for (const char* line : {"1 2 3", "1 2 x 4", "1 2 3 -1", "1 2 3 0", "1 2 1.1e6 1", "1 2 3 1.1e6",
                           "nan 2 3 4", "1 2 3 inf"})
    EXPECT_FALSE(is_sound(line)) << line;
}

INSTANTIATE_TEST_SUITE_P(LineEnds, LargeXyzr, ::testing::Values("\n", "\r\n", "\r"));

}  // namespace
}  // namespace vdwmesh::testing
