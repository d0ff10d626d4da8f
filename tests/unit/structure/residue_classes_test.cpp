// Kinds of residues and their hydropathy, beside the scale as Biopython has it
// (Bio.SeqUtils.ProtParamData.kd, Debian's python3-biopython).
#include "structure/residue_classes.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace vdwmesh {
namespace {

TEST(Hydropathy, IsThatOfBiopython) {
  const std::map<std::string, double> biopython{
      {"ALA", 1.8},  {"ARG", -4.5}, {"ASN", -3.5}, {"ASP", -3.5}, {"CYS", 2.5},
      {"GLN", -3.5}, {"GLU", -3.5}, {"GLY", -0.4}, {"HIS", -3.2}, {"ILE", 4.5},
      {"LEU", 3.8},  {"LYS", -3.9}, {"MET", 1.9},  {"PHE", 2.8},  {"PRO", -1.6},
      {"SER", -0.8}, {"THR", -0.7}, {"TRP", -0.9}, {"TYR", -1.3}, {"VAL", 4.2}};
  for (const auto& [name, value] : biopython) EXPECT_EQ(hydropathy(name), value) << name;
  for (const char* name : {"HID", "NHIS"}) EXPECT_EQ(hydropathy(name), -3.2) << name;
  for (const char* name : {"HOH", "DA", "", "HEM"}) EXPECT_FALSE(hydropathy(name)) << name;
}

TEST(ResidueClass, OfAminoAcidsAndNucleotides) {
  using enum ResidueClass;
  for (const char* name : {"ASP", "GLU"}) EXPECT_EQ(residue_class(name), acidic) << name;
  for (const char* name : {"LYS", "ARG", "HIS", "HIE"})
    EXPECT_EQ(residue_class(name), basic) << name;
  for (const char* name : {"SER", "THR", "CYS", "TYR", "ASN", "GLN"})
    EXPECT_EQ(residue_class(name), polar) << name;
  for (const char* name : {"ALA", "VAL", "LEU", "ILE", "MET", "PHE", "TRP", "PRO", "GLY"})
    EXPECT_EQ(residue_class(name), hydrophobic) << name;
  for (const char* name : {"DA", "G", "DA5", "U"})
    EXPECT_EQ(residue_class(name), nucleotide) << name;
  for (const char* name : {"HEM", "HOH", ""}) EXPECT_EQ(residue_class(name), other) << name;
}

}  // namespace
}  // namespace vdwmesh
