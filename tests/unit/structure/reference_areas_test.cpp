// The reference areas beside those in the library of FreeSASA, digit by digit.
#include "structure/reference_areas.hpp"

#include <freesasa.h>
#include <gtest/gtest.h>

#include <string>

// The library has this function, which its header does not declare.
extern "C" const freesasa_nodearea* freesasa_classifier_residue_reference(
    const freesasa_classifier* classifier, const char* res_name);

namespace vdwmesh::testing {
namespace {

const char* const kResidues[] = {"ALA", "ARG", "ASN", "ASP", "CYS", "GLN", "GLU", "GLY", "HIS",
                                 "ILE", "LEU", "LYS", "MET", "PHE", "PRO", "SER", "THR", "TRP",
                                 "TYR", "VAL", "MSE", "SEC", "HOH", "A",   "DA",  "UNL"};

void expect_same(const char* set, const freesasa_classifier& witness, int expected) {
  int found = 0;
  for (const char* residue : kResidues) {
    const freesasa_nodearea* theirs = freesasa_classifier_residue_reference(&witness, residue);
    if (theirs && !theirs->name) theirs = nullptr;  // a residue of the set without a reference
    const auto ours = reference_areas(set, residue);
    ASSERT_EQ(ours.has_value(), theirs != nullptr) << set << ' ' << residue;
    if (!ours) continue;
    ++found;
    EXPECT_EQ(ours->total, theirs->total) << set << ' ' << residue;
    EXPECT_EQ(ours->main_chain, theirs->main_chain) << set << ' ' << residue;
    EXPECT_EQ(ours->side_chain, theirs->side_chain) << set << ' ' << residue;
    EXPECT_EQ(ours->polar, theirs->polar) << set << ' ' << residue;
    EXPECT_EQ(ours->apolar, theirs->apolar) << set << ' ' << residue;
  }
  EXPECT_EQ(found, expected) << set;
}

TEST(ReferenceAreas, AreThoseOfFreesasa) {
  expect_same("protor", freesasa_protor_classifier, 20);
  expect_same("naccess", freesasa_naccess_classifier, 20);
  expect_same("oons", freesasa_oons_classifier, 18);
}

TEST(ReferenceAreas, OtherSetsHaveNone) {
  for (const char* set : {"bondi", "alvarez", "file", "radii.txt"})
    EXPECT_FALSE(reference_areas(set, "ALA")) << set;
}

}  // namespace
}  // namespace vdwmesh::testing
