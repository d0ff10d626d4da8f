// Tables of residue names, and the rules that read them. gemmi's table of residues covers the names
// of the PDB; the tables here add what force fields call the same residues.
//
// Sources of the names: toppar_water_ions.str of CHARMM, atomic_ions.lib and the leaprc files of
// AMBER, ions.itp and residuetypes.dat of GROMACS, and for ligands the chemical components of the
// PDB.
#include "structure/molecule/residue_elements.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <gemmi/resinfo.hpp>
#include <string>
#include <utility>

#include "core/letters.hpp"
#include "structure/molecule/standard_names.hpp"

namespace vdwmesh {
namespace {

using gemmi::El;
using namespace std::string_view_literals;

using NamedIon = std::pair<std::string_view, El>;

// The ions of CHARMM. Residue and atom have the same name, which is not the symbol.
constexpr std::array kCharmmIons{
    NamedIon{"SOD", El::Na}, NamedIon{"POT", El::K},  NamedIon{"CAL", El::Ca},
    NamedIon{"CES", El::Cs}, NamedIon{"LIT", El::Li}, NamedIon{"RUB", El::Rb},
    NamedIon{"BAR", El::Ba}, NamedIon{"CLA", El::Cl}, NamedIon{"IOD", El::I},
    NamedIon{"CAD", El::Cd},
};
// Ions of AMBER whose name is not the symbol, with digits and charge: sodium, sodium with its water
// as one particle, calcium, and protons.
constexpr std::array kAmberIons{
    NamedIon{"CIO", El::Na}, NamedIon{"IB", El::Na}, NamedIon{"C0", El::Ca},
    NamedIon{"HE+", El::H},  NamedIon{"HZ+", El::H},
};
// Names of water. In the PDB they mean nothing else; programs and force fields have the others,
// which other molecules have too. W is a bead of some waters.
constexpr std::array kWatersOfThePdb{"HOH"sv, "DOD"sv, "WAT"sv, "H2O"sv};
constexpr std::array kWatersOfPrograms{
    "TIP"sv, "TIP2"sv, "TIP3"sv, "TIP4"sv, "TIP5"sv, "TP3"sv, "TP4"sv,  "TP5"sv,
    "T3P"sv, "T4P"sv,  "SOL"sv,  "SPC"sv,  "SPCE"sv, "OH2"sv, "TP3M"sv,
};
constexpr std::array kWaterBeads{"W"sv, "WF"sv, "PW"sv};
constexpr std::array kWatersWithCharges{"SWM"sv, "SWM4"sv, "OPC"sv};
// Ions in the PDB whose residue name is not the symbol. The atom name is the symbol ("I" in "IOD").
constexpr std::array kOddlyNamedIons{
    NamedIon{"IOD", El::I},  NamedIon{"YT", El::Y},   NamedIon{"BS", El::Bi},
    NamedIon{"RHD", El::Rh}, NamedIon{"ARS", El::As},
};

template <class List>
El find_named(const List& list, std::string_view name) {
  const auto found = std::find_if(list.begin(), list.end(),
                                  [name](const NamedIon& ion) { return ion.first == name; });
  return found == list.end() ? El::X : found->second;
}

// The name without leading digits ("3CO") and without a charge at the end ("ZN2", "NA+", and
// CHARMM's "AL3P", where P means plus).
std::string_view base_name(std::string_view name) {
  if (name.size() > 2 && name.back() == 'P' && is_digit(name[name.size() - 2]))
    name.remove_suffix(1);
  const std::size_t last = name.find_last_not_of("0123456789+-");
  name = name.substr(0, last == std::string_view::npos ? 0 : last + 1);
  return name.substr(std::min(name.find_first_not_of("0123456789"), name.size()));
}

// The element with this symbol. X past einsteinium, and for deuterium, which gemmi lists behind all
// elements: no file holds ions of these elements, and their symbols occur as names of other things.
El element_named(std::string_view symbol) {
  if (symbol.empty() || symbol.size() > 2) return El::X;
  if (symbol.size() == 1 && is_small_letter(symbol[0])) return El::X;
  const El found = gemmi::find_element(std::string(symbol).c_str());
  return found > El::Es ? El::X : found;
}

template <class List, class Value>
bool holds(const List& list, const Value& value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

// Amino acids in force fields: protonation states of His, Cys, Asp, Glu, Lys and Arg; and some
// modified amino acids.
constexpr std::array kForceFieldAminoAcids{
    "HID"sv,  "HIE"sv,  "HIP"sv,  "HSD"sv,  "HSE"sv,  "HSP"sv, "HISA"sv, "HISB"sv, "HISD"sv,
    "HISE"sv, "HISH"sv, "HIS1"sv, "HIS2"sv, "CYX"sv,  "CYM"sv, "CYS2"sv, "CYSH"sv, "ASH"sv,
    "ASPH"sv, "ASPP"sv, "GLH"sv,  "GLUH"sv, "GLUP"sv, "LYN"sv, "LYP"sv,  "LYSH"sv, "LSN"sv,
    "ARGN"sv, "HYP"sv,  "NLE"sv,  "ORN"sv,  "SEP"sv,  "TPO"sv, "PTR"sv,
};
// Nucleotides in force fields.
constexpr std::array kForceFieldNucleotides{"ADE"sv, "GUA"sv, "CYT"sv, "THY"sv, "URA"sv,
                                            "RA"sv,  "RC"sv,  "RG"sv,  "RU"sv};
// Groups that cap the ends of a chain, such as acetyl and N-methyl amide.
constexpr std::array kEndGroups{"ACE"sv, "NME"sv, "NHE"sv, "NH2"sv, "NMA"sv, "CT3"sv};

bool is_amino_acid_of_the_pdb(std::string_view residue) {
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(std::string(residue));
  return info.is_amino_acid() && (info.is_standard() || residue == "MSE");
}

bool is_nucleotide_of_the_pdb(std::string_view residue) {
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(std::string(residue));
  return info.is_nucleic_acid() && info.is_standard();
}

// AMBER and GROMACS append a letter to a nucleotide at the end of a chain: 5, 3, or N for a single
// nucleotide ("DA5", "RU3", "GN"). The residue "IN" is indium, not a single inosine.
bool is_nucleotide(std::string_view residue) {
  if (is_nucleotide_of_the_pdb(residue) || holds(kForceFieldNucleotides, residue)) return true;
  if (residue.size() < 2 || "53N"sv.find(residue.back()) == std::string_view::npos) return false;
  residue.remove_suffix(1);
  if (residue == "I") return false;
  return is_nucleotide_of_the_pdb(residue) || holds(kForceFieldNucleotides, residue);
}

// Where side chains have hydrogens, by the letter of the position: alpha to zeta, and H for eta.
// Other amino acids may have them at all positions.
using SideChain = std::pair<std::string_view, std::string_view>;
constexpr std::array kSideChains{
    SideChain{"ALA", "AB"},    SideChain{"ARG", "ABGDEH"}, SideChain{"ASN", "ABD"},
    SideChain{"ASP", "ABD"},   SideChain{"ASX", "ABD"},    SideChain{"CYS", "ABG"},
    SideChain{"GLN", "ABGE"},  SideChain{"GLU", "ABGE"},   SideChain{"GLX", "ABGE"},
    SideChain{"GLY", "A"},     SideChain{"HIS", "ABDE"},   SideChain{"ILE", "ABGD"},
    SideChain{"LEU", "ABGD"},  SideChain{"LYS", "ABGDEZ"}, SideChain{"MET", "ABGE"},
    SideChain{"MSE", "ABGE"},  SideChain{"PHE", "ABDEZ"},  SideChain{"PRO", "ABGD"},
    SideChain{"SER", "ABG"},   SideChain{"THR", "ABG"},    SideChain{"TRP", "ABDEZH"},
    SideChain{"TYR", "ABDEH"}, SideChain{"VAL", "ABG"},
};
constexpr std::string_view kAllPositions = "ABGDEZH";

std::string_view positions_of_hydrogens(std::string_view residue) {
  const std::string name = standard_residue_name(residue);
  const auto found = std::find_if(kSideChains.begin(), kSideChains.end(),
                                  [&name](const SideChain& chain) { return chain.first == name; });
  return found == kSideChains.end() ? kAllPositions : found->second;
}

bool are_digits(std::string_view text) {
  return text.find_first_not_of("0123456789") == std::string_view::npos;
}

// Whether the text is one of the letters and perhaps digits behind it.
bool is_letter_and_number(std::string_view text, std::string_view letters) {
  return !text.empty() && letters.find(text[0]) != std::string_view::npos &&
         are_digits(text.substr(1));
}

// The next three take what stands behind the H of a hydrogen's name.
// Behind the side chain's: ends of chains, and HN of CHARMM.
bool is_behind_h_of_amino_acid(std::string_view rest, std::string_view residue) {
  return is_letter_and_number(rest, positions_of_hydrogens(residue)) ||
         is_letter_and_number(rest, "NT") || rest == "XT" || rest.starts_with("OP");
}

// HA1 of NME, HH31 of ACE, HN1 of NH2, HT1 of CT3, HY1 of ACE.
bool is_behind_h_of_end_group(std::string_view rest) { return is_letter_and_number(rest, "AHNTY"); }

// H2'1, HO5', HO'2, HOP3 and HM51.
bool is_behind_h_of_nucleotide(std::string_view rest) {
  const bool is_of_sugar =
      rest.find('\'') != std::string_view::npos || rest.find('*') != std::string_view::npos;
  return is_digit(rest[0]) || rest.starts_with("OP") || rest.starts_with("M5") ||
         (rest[0] == 'O' && is_of_sugar);
}

// Ligands of the PDB in which atom names are ambiguous. The symbol of the metal could be read as a
// light element with a letter behind it (CO, CA, NI, CU), or the name of a light atom as a metal
// (NA in a porphyrin).
struct Ligands {
  std::array<El, 2> metals;   // the second is X if there is only one
  std::string_view residues;  // names, each between blanks, so that searching finds whole names
};
// "CLA" is chlorophyll here and chloride in CHARMM; element_of_ion() is asked first and needs an
// atom of the same name.
constexpr std::array kLigands{
    Ligands{{El::Fe, El::X},
            " HEM HEC HEA HEB HAS HDD HDM HEO HES HEV DHE SRM HEME HEMO "},  // haems
    Ligands{{El::Fe, El::X}, " FES SF4 F3S FS4 CLF FEO "},  // clusters of iron and sulphur
    Ligands{{El::Fe, El::Mo}, " CFM CFN ICS "},             // of nitrogenase
    Ligands{{El::Fe, El::Ni}, " FCO NFU F43 "},             // of hydrogenases; factor F430
    Ligands{{El::Mg, El::X}, " CLA CHL BCL BCB "},          // chlorophylls
    Ligands{{El::Co, El::X}, " B12 CNC COB COY CBY NCO "},  // cobalamins, cobalt hexammine
    Ligands{{El::Cu, El::X}, " CUA CUB CUZ "},
    Ligands{{El::Ca, El::Mn}, " OEX OEY OEC "},  // of photosystem II
};

const Ligands* find_ligand(std::string_view residue) {
  std::string between_blanks(" ");
  between_blanks.append(residue).append(" ");
  const auto found = std::find_if(kLigands.begin(), kLigands.end(), [&](const Ligands& listed) {
    return listed.residues.find(between_blanks) != std::string_view::npos;
  });
  return found == kLigands.end() ? nullptr : &*found;
}

}  // namespace

El element_of_ion(std::string_view name, std::string_view residue) {
  if (name == residue && find_named(kAmberIons, name) != El::X) return find_named(kAmberIons, name);
  const std::string_view atom = base_name(name), ion = base_name(residue);
  if (atom.empty() || ion.empty()) return El::X;
  const El odd = find_named(kOddlyNamedIons, ion);
  // `odd` is the element if the PDB has the residue; its atom is named by the symbol. "IOD" is in
  // both tables of ions: with an atom "I" in the PDB, with an atom "IOD" in CHARMM.
  if (odd != El::X && element_named(atom) == odd) return odd;
  if (residue == "ION" && name != "ION") return element_of_ion(name, name);
  const El charmm = find_named(kCharmmIons, ion);
  // "NA" of "SOD". "CA" may be the alpha carbon of another CAL.
  if (charmm != El::X && charmm != El::Ca && element_named(atom) == charmm) return charmm;
  if (atom != ion) return El::X;
  return charmm != El::X ? charmm : element_named(ion);
}

bool is_amino_acid(std::string_view residue) {
  if (is_amino_acid_of_the_pdb(residue) || holds(kForceFieldAminoAcids, residue)) return true;
  // AMBER marks residues at the ends of a chain with N or C in front: "NALA", "CHIE".
  const bool end = residue.size() == 4 && (residue[0] == 'N' || residue[0] == 'C');
  return end && (is_amino_acid_of_the_pdb(residue.substr(1)) ||
                 holds(kForceFieldAminoAcids, residue.substr(1)));
}

bool is_standard_residue(std::string_view residue) {
  return is_amino_acid(residue) || is_nucleotide(residue) || holds(kEndGroups, residue);
}

bool is_deuterium_name(std::string_view name, std::string_view residue) {
  name.remove_prefix(std::min(name.find_first_not_of("0123456789"), name.size()));
  if (!name.starts_with('D')) return false;
  const std::string_view rest = name.substr(1);
  const bool is_water = is_named_as_water(residue);
  if (are_digits(rest)) return is_water || is_standard_residue(residue);
  if (is_water) return is_letter_and_number(rest, "W");
  if (holds(kEndGroups, residue)) return is_behind_h_of_end_group(rest);
  if (is_amino_acid(residue)) return is_behind_h_of_amino_acid(rest, residue);
  return is_nucleotide(residue) && is_behind_h_of_nucleotide(rest);
}

ResidueKind kind_of_residue(std::string_view residue) {
  const std::string name = upper_case(residue);
  if (is_named_as_water(name)) return ResidueKind::water;
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(name);
  if (is_amino_acid(name) || holds(kEndGroups, name) || info.is_amino_acid())
    return ResidueKind::protein;
  return is_nucleotide(name) || info.is_nucleic_acid() ? ResidueKind::nucleic : ResidueKind::other;
}

WaterName water_name(std::string_view residue) {
  if (holds(kWatersOfThePdb, residue)) return WaterName::of_the_pdb;
  if (holds(kWatersOfPrograms, residue)) return WaterName::of_a_program;
  if (holds(kWaterBeads, residue)) return WaterName::of_a_bead;
  return holds(kWatersWithCharges, residue) ? WaterName::of_charged_sites : WaterName::none;
}

El metal_of_ligand(std::string_view name, std::string_view residue) {
  const Ligands* ligand = find_ligand(residue);
  const El element = ligand ? element_named(base_name(name)) : El::X;
  return element != El::X && holds(ligand->metals, element) ? element : El::X;
}

bool is_ligand_with_metals(std::string_view residue) { return find_ligand(residue) != nullptr; }

}  // namespace vdwmesh
