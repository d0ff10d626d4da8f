// Accessible areas of residues X in extended tripeptides Ala-X-Ala, to which the area of a residue
// in a protein is compared. They belong to a radius set and to a probe of 1.4 Å.
#pragma once

#include <optional>
#include <string_view>

namespace vdwmesh {

// The area of a residue and of parts of it, Å². The main chain is N, CA, C, O and OXT; the polarity
// is that of the radius set. The parts of a pair add up to the total but for rounding.
struct ResidueAreas {
  double total, main_chain, side_chain, polar, apolar;
};

// The probe that the reference areas are for, Å.
inline constexpr double kReferenceProbe = 1.4;

// The reference of the residue in a radius set, from FreeSASA 2.1 (S. Mitternacht, F1000Research 5
// (2016) 189), which computed it for the tripeptides of NACCESS by the method of Lee and Richards.
// There are references for the 20 standard amino acids in "protor" and "naccess", for 18 of them in
// "oons" (alanine and glycine are missing), and none in other sets. Names of protonation states and
// of ends of chains ("HID", "NALA") count as the standard residue. Side chains of glycine are 0.
std::optional<ResidueAreas> reference_areas(std::string_view radius_set, std::string_view residue);

}  // namespace vdwmesh
