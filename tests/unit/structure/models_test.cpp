// Models of PDB and PQR files: the same records, so the same tests.
#include <gmock/gmock.h>

#include "structure/temp_file.hpp"
#include "support/shared_files.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::HasSubstr;

ReadOptions model(const std::string& name) {
  ReadOptions options;
  options.model = name;
  return options;
}

// Of the format that the parameter names by its extension.
class Models : public ::testing::TestWithParam<std::string> {
 protected:
  std::string file() const { return "a." + GetParam(); }

  std::string atom(int serial) const {
    const bool pqr = GetParam() == "pqr";
    char line[96];
    std::snprintf(line, sizeof line, "ATOM  %5d  C1  UNL A%4d    %8.3f%8.3f%8.3f%s\n", serial, 1,
                  1.0 * serial, 0.0, 0.0, pqr ? " 0.1000 1.7000" : "  1.00 10.00");
    return line;
  }
  std::string two_atoms() const { return atom(1) + atom(2); }

  void expect_two_models(const std::string& text) const {
    SCOPED_TRACE(text);
    const Molecule first = read_text_as(file(), text);
    EXPECT_EQ(first.atoms_used, 2U);
    EXPECT_EQ(first.skipped, (SkippedAtoms{{"other_models", 2}}));
    EXPECT_EQ(first.model, "1");
    EXPECT_EQ(read_text_as(file(), text, model("2")).atoms.at(0).model, 2);
    const Molecule all = read_text_as(file(), text, model("all"));
    EXPECT_EQ(all.atoms_used, 4U);
    EXPECT_EQ(all.model, "all");
    EXPECT_THAT(refusal_of_text<InvalidInput>(file(), text, model("3")), HasSubstr("1 to 2"));
  }
};

INSTANTIATE_TEST_SUITE_P(Formats, Models, ::testing::Values("pdb", "pqr"),
                         [](const auto& info) { return "of_" + info.param; });

TEST_P(Models, AreFoundHoweverTheyAreMarked) {
  const std::string two = two_atoms();
  expect_two_models("MODEL        1\n" + two + "ENDMDL\nMODEL        2\n" + two + "ENDMDL\nEND\n");
  expect_two_models("MODEL 1\n" + two + "MODEL 2\n" + two);             // no ENDMDL
  expect_two_models(two + "ENDMDL\nMODEL        2\n" + two + "END\n");  // no first MODEL
  expect_two_models(two + "END\n" + two + "END\n");                     // frames ended by END
  expect_two_models("MODEL        1\n" + two + "ENDMDL\nEND\nMODEL        1\n" + two + "ENDMDL\n");
  expect_two_models("MODEL\n" + two + "ENDMDL\nMODEL  x\n" + two + "ENDMDL\n");  // no numbers
}

TEST_P(Models, ThatShareANumberAreTwo) {
  const std::string text =
      "MODEL 2\n" + two_atoms() + "ENDMDL\nMODEL 2\n" + atom(7) + "ENDMDL\n" + atom(8) + "END\n";
  EXPECT_EQ(read_text_as(file(), text).atoms.size(), 2U);
  EXPECT_EQ(read_text_as(file(), text, model("2")).atoms.size(), 2U);
  // The second takes the next free number, which is 3; the third, which has none, its place's next.
  EXPECT_EQ(read_text_as(file(), text, model("3")).atoms.at(0).serial, 7);
  EXPECT_EQ(read_text_as(file(), text, model("4")).atoms.at(0).serial, 8);
}

TEST_P(Models, WithoutAtomsDoNotCount) {
  const std::string text = "MODEL 1\nENDMDL\nMODEL 2\n" + atom(1) + "ENDMDL\n";
  const Molecule molecule = read_text_as(file(), text);
  EXPECT_EQ(molecule.atoms.size(), 1U);
  EXPECT_EQ(molecule.model, "2");
  EXPECT_EQ(molecule.skipped, SkippedAtoms{});
}

TEST_P(Models, AreNotBegunByLongerWords) {
  const std::string text =
      atom(1) + "MODELLED LOOP FOLLOWS\nENDURING\nATOMIC RADII BELOW\n" + atom(2);
  EXPECT_EQ(read_text_as(file(), text).atoms.size(), 2U);
}

TEST_P(Models, NumbersNeedNotBeginWithOne) {
  const std::string text =
      "MODEL        0\n" + two_atoms() + "ENDMDL\nMODEL        7\n" + two_atoms() + "ENDMDL\n";
  EXPECT_EQ(read_text_as(file(), text).model, "0");
  EXPECT_EQ(read_text_as(file(), text, model("07")).atoms.at(0).model, 7);
}

// The names of the first half are those that a count from the place of a model meets.
TEST_P(Models, ThousandsOfWhichTheNumbersAreTaken) {
  constexpr int half = 1'000;
  std::string text;
  for (int i = 0; i < half; ++i) text += "MODEL " + std::to_string(half + 1 + i) + "\n" + atom(1);
  for (int i = 0; i < half; ++i) text += "MODEL\n" + atom(2);
  const Molecule molecule = read_text_as(file(), text, model(std::to_string(3 * half)));
  EXPECT_EQ(molecule.atoms.at(0).serial, 2);
}

TEST_P(Models, FilesThatShowedADefect) {
  if (GetParam() != "pqr") return;
  VDWMESH_NEEDS_SHARED("molecules/sparse/two.pqr");
  EXPECT_EQ(read_structure(shared_path("molecules/sparse/two.pqr"), model("2")).atoms.size(), 1U);
  EXPECT_EQ(read_structure(shared_path("molecules/sparse/modelled.pqr")).atoms.size(), 2U);
  EXPECT_EQ(read_structure(shared_path("molecules/sparse/empty_first.pqr")).atoms.size(), 1U);
}

}  // namespace
}  // namespace vdwmesh::testing
