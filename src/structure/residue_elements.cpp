// Sources of the names: the residues of CHARMM's toppar_water_ions.str, AMBER's atomic_ions.lib and
// leaprc files and GROMACS' ions.itp and residuetypes.dat; for ligands the components of the PDB.
#include "structure/residue_elements.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <gemmi/resinfo.hpp>
#include <string>

namespace vdwmesh {
namespace {

using gemmi::El;
using namespace std::string_view_literals;

struct Named {
  std::string_view name;
  El element;
};

// Ions whose residues are not called after the element.
constexpr std::array kIons{
    Named{"SOD", El::Na}, Named{"POT", El::K},  Named{"CAL", El::Ca}, Named{"CES", El::Cs},
    Named{"LIT", El::Li}, Named{"RUB", El::Rb}, Named{"BAR", El::Ba}, Named{"CLA", El::Cl},
    Named{"IOD", El::I},  Named{"YT", El::Y},   Named{"BS", El::Bi},  Named{"RHD", El::Rh},
    Named{"ARS", El::As},
};

// Without the digits in front ("3CO") and the charge behind ("ZN2", "NA+", CHARMM's "AL3P").
std::string_view core(std::string_view name) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (name.size() > 2 && name.back() == 'P' && is_digit(name[name.size() - 2]))
    name.remove_suffix(1);
  const std::size_t last = name.find_last_not_of("0123456789+-");
  name = name.substr(0, last == std::string_view::npos ? 0 : last + 1);
  return name.substr(std::min(name.find_first_not_of("0123456789"), name.size()));
}

// Elements past einsteinium are no ions of any file; their symbols are names of other things.
El element_named(std::string_view symbol) {
  if (symbol.empty() || symbol.size() > 2) return El::X;
  const El found = symbol.size() == 1 ? gemmi::impl::find_single_letter_element(symbol[0])
                                      : gemmi::find_element(std::string(symbol).c_str());
  return found > El::Es ? El::X : found;
}

template <class List>
bool holds(const List& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

constexpr std::array kAminoAcids{
    "HID"sv,  "HIE"sv,  "HIP"sv,  "HSD"sv,  "HSE"sv,  "HSP"sv,  "HISA"sv, "HISB"sv, "HISD"sv,
    "HISE"sv, "HISH"sv, "HIS1"sv, "HIS2"sv, "CYX"sv,  "CYM"sv,  "CYS2"sv, "CYSH"sv, "ASH"sv,
    "ASPH"sv, "ASPP"sv, "GLH"sv,  "GLUH"sv, "GLUP"sv, "LYN"sv,  "LYP"sv,  "LYSH"sv, "LSN"sv,
    "ARGN"sv, "HYP"sv,  "NLE"sv,  "ORN"sv,  "SEP"sv,  "TPO"sv,  "PTR"sv,
};
constexpr std::array kNucleotides{"ADE"sv, "GUA"sv, "CYT"sv, "THY"sv, "URA"sv,
                                  "RA"sv,  "RC"sv,  "RG"sv,  "RU"sv};
constexpr std::array kEndGroups{"ACE"sv, "NME"sv, "NHE"sv, "NH2"sv, "NMA"sv, "CT3"sv};

bool is_amino_acid_of_the_pdb(std::string_view residue) {
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(std::string(residue));
  return info.is_amino_acid() && (info.is_standard() || residue == "MSE");
}

bool is_nucleotide_of_the_pdb(std::string_view residue) {
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(std::string(residue));
  return info.is_nucleic_acid() && info.is_standard();
}

// AMBER's and GROMACS' ends of nucleic acids: "DA5", "RU3", "GN".
bool is_nucleotide(std::string_view residue) {
  if (is_nucleotide_of_the_pdb(residue) || holds(kNucleotides, residue)) return true;
  if (residue.size() < 2 || "53N"sv.find(residue.back()) == std::string_view::npos) return false;
  residue.remove_suffix(1);
  return is_nucleotide_of_the_pdb(residue) || holds(kNucleotides, residue);
}

struct Ligand {
  std::string_view residue;
  std::array<El, 2> metals;
};

// Components of the PDB with a metal whose symbol could be read as a lighter element with a letter
// behind it (FE, CO, CA, NI, CU), or whose other names could be read as metals (NA of a porphyrin).
constexpr std::array kLigands{
    // Haems.
    Ligand{"HEM", {El::Fe, El::X}}, Ligand{"HEC", {El::Fe, El::X}}, Ligand{"HEA", {El::Fe, El::X}},
    Ligand{"HEB", {El::Fe, El::X}}, Ligand{"HAS", {El::Fe, El::X}}, Ligand{"HDD", {El::Fe, El::X}},
    Ligand{"HDM", {El::Fe, El::X}}, Ligand{"HEO", {El::Fe, El::X}}, Ligand{"HES", {El::Fe, El::X}},
    Ligand{"HEV", {El::Fe, El::X}}, Ligand{"DHE", {El::Fe, El::X}}, Ligand{"SRM", {El::Fe, El::X}},
    Ligand{"HEME", {El::Fe, El::X}}, Ligand{"HEMO", {El::Fe, El::X}},
    // Iron and sulphur.
    Ligand{"FES", {El::Fe, El::X}}, Ligand{"SF4", {El::Fe, El::X}}, Ligand{"F3S", {El::Fe, El::X}},
    Ligand{"FS4", {El::Fe, El::X}}, Ligand{"CFM", {El::Fe, El::Mo}}, Ligand{"CFN", {El::Fe, El::Mo}},
    Ligand{"ICS", {El::Fe, El::Mo}}, Ligand{"CLF", {El::Fe, El::X}}, Ligand{"FCO", {El::Fe, El::Ni}},
    Ligand{"NFU", {El::Ni, El::Fe}}, Ligand{"FEO", {El::Fe, El::X}},
    // Chlorophylls, cobalamins, factor F430, copper sites, the oxygen-evolving complex.
    Ligand{"CLA", {El::Mg, El::X}}, Ligand{"CHL", {El::Mg, El::X}}, Ligand{"BCL", {El::Mg, El::X}},
    Ligand{"BCB", {El::Mg, El::X}}, Ligand{"B12", {El::Co, El::X}}, Ligand{"CNC", {El::Co, El::X}},
    Ligand{"COB", {El::Co, El::X}}, Ligand{"COY", {El::Co, El::X}}, Ligand{"CBY", {El::Co, El::X}},
    Ligand{"NCO", {El::Co, El::X}}, Ligand{"F43", {El::Ni, El::X}}, Ligand{"CUA", {El::Cu, El::X}},
    Ligand{"CUB", {El::Cu, El::X}}, Ligand{"CUZ", {El::Cu, El::X}}, Ligand{"OEX", {El::Ca, El::Mn}},
    Ligand{"OEY", {El::Ca, El::Mn}}, Ligand{"OEC", {El::Ca, El::Mn}},
};

const Ligand* find_ligand(std::string_view residue) {
  const auto found = std::find_if(kLigands.begin(), kLigands.end(),
                                  [residue](const Ligand& l) { return l.residue == residue; });
  return found == kLigands.end() ? nullptr : &*found;
}

}  // namespace

El element_of_ion(std::string_view name, std::string_view residue) {
  const std::string_view atom = core(name), ion = core(residue);
  if (atom.empty() || ion.empty()) return El::X;
  const auto alias =
      std::find_if(kIons.begin(), kIons.end(), [ion](const Named& i) { return i.name == ion; });
  if (alias != kIons.end())
    return atom == ion || element_named(atom) == alias->element ? alias->element : El::X;
  return atom == ion ? element_named(ion) : El::X;
}

bool is_amino_acid(std::string_view residue) {
  if (is_amino_acid_of_the_pdb(residue) || holds(kAminoAcids, residue)) return true;
  const bool end = residue.size() == 4 && (residue[0] == 'N' || residue[0] == 'C');
  return end && (is_amino_acid_of_the_pdb(residue.substr(1)) || holds(kAminoAcids, residue.substr(1)));
}

bool is_standard_residue(std::string_view residue) {
  return is_amino_acid(residue) || is_nucleotide(residue) || holds(kEndGroups, residue);
}

El metal_of_ligand(std::string_view name, std::string_view residue) {
  const Ligand* ligand = find_ligand(residue);
  const El element = ligand ? element_named(core(name)) : El::X;
  return element != El::X && holds(ligand->metals, element) ? element : El::X;
}

bool is_ligand_with_metals(std::string_view residue) { return find_ligand(residue) != nullptr; }

}  // namespace vdwmesh
