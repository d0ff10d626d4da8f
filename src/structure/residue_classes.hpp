// What a residue is like in water, by its name. Names of protonation states and of ends of chains
// ("HID", "NALA") count as the standard residue.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace vdwmesh {

enum class ResidueClass : std::uint8_t { hydrophobic, polar, acidic, basic, nucleotide, other };
inline constexpr int kResidueClasses = 6;

// Of the 20 standard amino acids and the standard nucleotides; `other` for all else. Glycine and
// proline count as hydrophobic, histidine as basic.
ResidueClass residue_class(std::string_view residue);

// The hydropathy of an amino acid, from 4.5 (isoleucine) to -4.5 (arginine): J. Kyte and R. F.
// Doolittle, J. Mol. Biol. 157 (1982) 105, table 2. Nothing for other residues.
std::optional<double> hydropathy(std::string_view residue);

}  // namespace vdwmesh
