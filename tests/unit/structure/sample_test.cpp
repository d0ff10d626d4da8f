#include <gmock/gmock.h>

#include <algorithm>

#include "structure/reference_spheres.hpp"
#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

// 1UBQ: 602 protein atoms and 58 waters (wwPDB entry).
TEST(Sample, Ubiquitin) {
  const Molecule molecule = read_sample("ubiquitin");
  expect_account_adds_up(molecule);
  EXPECT_EQ(molecule.atoms.size(), 602U);
  EXPECT_EQ(molecule.atoms_read, 660U);
  EXPECT_EQ(molecule.skipped, (SkippedAtoms{{"waters", 58}}));
  EXPECT_TRUE(molecule.radii_assumed.empty());
}

TEST(Sample, UbiquitinIsTheReference) {
  VDWMESH_NEEDS_SHARED("reference/1UBQ.xyzr");
  EXPECT_EQ(spheres(read_sample("ubiquitin")),
            spheres(read_structure(shared_path("reference/1UBQ.xyzr"))));
}

// 58 residues, 454 atoms other than hydrogen, three disulphide bridges.
TEST(Sample, Bpti) {
  const Molecule molecule = read_sample("bpti");
  expect_account_adds_up(molecule);
  EXPECT_EQ(molecule.atoms.size(), 454U);
  EXPECT_EQ(molecule.atoms.back().residue_number, "58");
  const auto sulphurs = std::count_if(molecule.atoms.begin(), molecule.atoms.end(),
                                      [](const Atom& atom) { return atom.element == "S"; });
  EXPECT_EQ(sulphurs, 7);  // 6 cysteines, 1 methionine
}

TEST(Sample, ObeysTheOptions) {
  ReadOptions options;
  options.waters = Inclusion::keep;
  options.select = "A/1-10";
  EXPECT_LT(read_sample("ubiquitin", options).atoms.size(), 100U);
}

TEST(Sample, OthersAreRefused) {
  EXPECT_THROW(read_sample("haemoglobin"), InvalidInput);
  EXPECT_THROW(read_sample(""), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
