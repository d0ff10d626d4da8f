// One table of the amino acids has both their classes and the scale.
#include "structure/residue_classes.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include "structure/molecule/standard_names.hpp"

namespace vdwmesh {
namespace {

using enum ResidueClass;

struct AminoAcid {
  std::string_view name;
  ResidueClass kind;
  double hydropathy;
};

constexpr AminoAcid kAminoAcids[] = {
    {"ILE", hydrophobic, 4.5},  {"VAL", hydrophobic, 4.2},  {"LEU", hydrophobic, 3.8},
    {"PHE", hydrophobic, 2.8},  {"CYS", polar, 2.5},        {"MET", hydrophobic, 1.9},
    {"ALA", hydrophobic, 1.8},  {"GLY", hydrophobic, -0.4}, {"THR", polar, -0.7},
    {"SER", polar, -0.8},       {"TRP", hydrophobic, -0.9}, {"TYR", polar, -1.3},
    {"PRO", hydrophobic, -1.6}, {"HIS", basic, -3.2},       {"GLU", acidic, -3.5},
    {"GLN", polar, -3.5},       {"ASP", acidic, -3.5},      {"ASN", polar, -3.5},
    {"LYS", basic, -3.9},       {"ARG", basic, -4.5}};

constexpr std::string_view kNucleotides[] = {"A",  "C",  "G",  "U",  "I", "DA",
                                             "DC", "DG", "DT", "DU", "DI"};

const AminoAcid* find(const std::string& name) {
  const auto found = std::ranges::find(kAminoAcids, name, &AminoAcid::name);
  return found == std::end(kAminoAcids) ? nullptr : found;
}

}  // namespace

ResidueClass residue_class(std::string_view residue) {
  const std::string name = standard_residue_name(residue);
  if (const AminoAcid* acid = find(name)) return acid->kind;
  return std::ranges::count(kNucleotides, name) > 0 ? nucleotide : other;
}

std::optional<double> hydropathy(std::string_view residue) {
  const AminoAcid* acid = find(standard_residue_name(residue));
  return acid ? std::optional(acid->hydropathy) : std::nullopt;
}

}  // namespace vdwmesh
