// Tables of other names, and the affixes that mark the ends of chains. Sources of the names: the
// leaprc files of AMBER, top_all36_prot.rtf of CHARMM, residuetypes.dat and aminoacids.rtp of
// GROMACS, and the PDB's table of atom names before its remediation in 2007.
//
// CHARMM's nucleotides (ADE, GUA, CYT, THY, URA) are left out: the PDB has other molecules by these
// names, glutaric acid for one.
#include "structure/molecule/standard_names.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/letters.hpp"
#include "structure/molecule/residue_elements.hpp"

namespace vdwmesh {
namespace {

using OtherName = std::pair<std::string_view, std::string_view>;  // other, standard

constexpr std::array kResidues{
    OtherName{"HID", "HIS"},  OtherName{"HIE", "HIS"},  OtherName{"HIP", "HIS"},
    OtherName{"HSD", "HIS"},  OtherName{"HSE", "HIS"},  OtherName{"HSP", "HIS"},
    OtherName{"HISA", "HIS"}, OtherName{"HISB", "HIS"}, OtherName{"HISD", "HIS"},
    OtherName{"HISE", "HIS"}, OtherName{"HISH", "HIS"}, OtherName{"HIS1", "HIS"},
    OtherName{"HIS2", "HIS"}, OtherName{"CYX", "CYS"},  OtherName{"CYM", "CYS"},
    OtherName{"CYS2", "CYS"}, OtherName{"CYSH", "CYS"}, OtherName{"ASH", "ASP"},
    OtherName{"ASPH", "ASP"}, OtherName{"ASPP", "ASP"}, OtherName{"GLH", "GLU"},
    OtherName{"GLUH", "GLU"}, OtherName{"GLUP", "GLU"}, OtherName{"LYN", "LYS"},
    OtherName{"LYP", "LYS"},  OtherName{"LYSH", "LYS"}, OtherName{"LSN", "LYS"},
    OtherName{"ARGN", "ARG"}, OtherName{"WAT", "HOH"},  OtherName{"DOD", "HOH"},
    OtherName{"H2O", "HOH"},
};

constexpr std::array<std::string_view, 12> kNucleotides{"A",  "C",  "G",  "U",  "DA", "DC",
                                                        "DG", "DT", "RA", "RC", "RG", "RU"};

template <class Names>
bool holds(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

template <class Names>
std::string_view standard(const Names& names, std::string_view name) {
  const auto found = std::find_if(names.begin(), names.end(),
                                  [name](const OtherName& entry) { return entry.first == name; });
  return found == names.end() ? name : found->second;
}

// AMBER puts N or C before the name of an amino acid at the end of a chain.
std::string_view without_end_of_protein(std::string_view residue) {
  const bool may_be = residue.size() == 4 && (residue[0] == 'N' || residue[0] == 'C');
  return may_be && is_amino_acid(residue.substr(1)) ? residue.substr(1) : residue;
}

// AMBER puts 5, 3 or N (a single nucleotide) behind the name of a nucleotide, and in some of its
// force fields R before that of RNA.
std::string_view without_marks_of_nucleotide(std::string_view residue) {
  std::string_view name = residue;
  if (name.size() > 1 && (name.back() == '5' || name.back() == '3' || name.back() == 'N'))
    name.remove_suffix(1);
  if (!holds(kNucleotides, name)) return residue;
  return name[0] == 'R' ? name.substr(1) : name;
}

}  // namespace

std::string standard_residue_name(std::string_view residue) {
  const std::string capitals = upper_case(residue);
  const std::string_view listed = standard(kResidues, capitals);
  if (listed != capitals) return std::string(listed);
  const std::string_view inner = without_end_of_protein(capitals);
  return std::string(inner != capitals ? standard(kResidues, inner)
                                       : without_marks_of_nucleotide(capitals));
}

std::string standard_atom_name(std::string_view residue, std::string_view atom) {
  std::string name = upper_case(atom);
  std::replace(name.begin(), name.end(), '*', '\'');
  if (is_amino_acid(residue)) {
    if (residue == "ILE" && name == "CD") return "CD1";
    if (name == "OT1" || name == "OC1") return "O";
    if (name == "OT2" || name == "OC2") return "OXT";
    return name;
  }
  if (name == "O1P") return "OP1";
  if (name == "O2P") return "OP2";
  if (name == "O3P") return "OP3";
  if (name == "C5M" && (residue == "DT" || residue == "T")) return "C7";
  return name;
}

}  // namespace vdwmesh
