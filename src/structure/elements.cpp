// A cascade of rules, from the most to the least reliable:
// 1. in_known_residue(): what the name of the residue implies (tables in residue_elements.cpp).
// 2. of_aligned_name(): the columns in which a PDB file places the name.
// 3. of_bare_name(): the letters alone, with a preference for light elements, since nearly all
//    atoms of molecules are C, N, O, H, P or S.
// Each rule returns El::X, gemmi's unknown element, if it cannot decide; then the next one is
// tried. Names are in capitals here. "The columns" are columns 13 to 16 of a PDB record.
#include "structure/elements.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <gemmi/elem.hpp>
#include <string>

#include "core/letters.hpp"
#include "structure/lines.hpp"
#include "structure/residue_elements.hpp"

namespace vdwmesh {
namespace {

using gemmi::El;

constexpr std::string_view kOrganic = "CNOHPS";  // elements of one letter in standard residues

std::string capitals(std::string_view text) { return upper_case(trimmed(text)); }

El single_letter(char c) { return gemmi::impl::find_single_letter_element(upper_case(c)); }

// The element with this symbol of two letters, or of one letter if the other character is a blank.
// X for elements past lawrencium, which no structure contains: "NH1A" is nitrogen, never nihonium.
// Deuterium (D) is the exception, because gemmi lists it behind all elements.
El two_letters(char first, char second) {
  const std::array<char, 3> symbol{first, second, '\0'};
  const El found = gemmi::find_element(symbol.data());
  return found > El::Lr && found != El::D ? El::X : found;
}

// The element of one letter that the first letter of the name stands for; digits are skipped.
El first_letter(std::string_view name) {
  for (const char c : name)
    if (is_letter(c)) return single_letter(c);
  return El::X;
}

// Whether the element is one of kOrganic or deuterium.
bool is_organic(El element) {
  return element == El::D ||
         (element != El::X &&
          kOrganic.find(gemmi::element_name(element)[0]) != std::string_view::npos &&
          gemmi::element_name(element)[1] == '\0');
}

// Standard residues hold only the elements of kOrganic, and Se in selenomethionine and
// selenocysteine.
El in_standard_residue(std::string_view name, std::string_view residue) {
  if ((residue == "MSE" || residue == "SEC") && name == "SE") return El::Se;
  const El element = first_letter(name);
  return is_organic(element) ? element : El::X;
}

// Rule 1: the element that the name of the residue implies, in standard residues, ions and known
// ligands with metals. In such a ligand, an atom that is not a metal is an organic element by its
// first letter.
El in_known_residue(std::string_view name, std::string_view residue) {
  if (is_standard_residue(residue)) return in_standard_residue(name, residue);
  if (const El ion = element_of_ion(name, residue); ion != El::X) return ion;
  if (const El metal = metal_of_ligand(name, residue); metal != El::X) return metal;
  const El light = is_ligand_with_metals(residue) ? first_letter(name) : El::X;
  return is_organic(light) ? light : El::X;
}

// Chlorine or bromine by the first two letters ("CL1", "BR"); X for any other name. Outside the
// standard residues, no carbon or boron has such a name.
El halogen(std::string_view name) {
  if (name.size() < 2) return El::X;
  const El element = two_letters(name[0], name[1]);
  return element == El::Cl || element == El::Br ? element : El::X;
}

// The element of a name that is a symbol of two letters and perhaps digits, such as "FE2". Only for
// elements that such a name nearly always means; X otherwise. Names such as "CA", "CO", "HG", "NA"
// and "PB" are not among them: they more often mean a light element with a letter behind it (alpha
// carbon, gamma hydrogen).
El unambiguous_symbol(std::string_view name) {
  static constexpr std::array kTelling{El::Fe, El::Ni, El::Cu, El::Si, El::Se, El::Pt, El::Ir};
  if (name.size() < 2 || name.find_first_not_of("0123456789", 2) != std::string_view::npos)
    return El::X;
  const El element = two_letters(name[0], name[1]);
  return std::find(kTelling.begin(), kTelling.end(), element) != kTelling.end() ? element : El::X;
}

// The element of a name that fills all four columns. Then column 13 says nothing about the length
// of the symbol, because long names of light elements begin there too ("HG11", "CG2A"). Light
// elements are preferred.
El of_full_name(std::string_view name) {
  if (halogen(name) != El::X) return halogen(name);
  if (kOrganic.find(name[0]) != std::string_view::npos) return single_letter(name[0]);
  const El element = two_letters(name[0], name[1]);
  return element != El::X ? element : first_letter(name);
}

// Rule 2. The name has exactly four characters and may contain blanks. Old PDB files put the digit
// of a hydrogen first ("1HB "), so the letter behind a leading digit is the symbol. A digit behind
// the first letter ("H11A") ends the symbol.
El of_aligned_name(std::string_view name) {
  if (is_digit(name[0])) return single_letter(name[1]);
  if (name[3] != ' ' && is_letter(name[0])) {
    if (is_digit(name[1])) return single_letter(name[0]);
    return of_full_name(name);
  }
  // One letter in column 13 and no letter behind it, as in "K   " or "C1  ": the name is not
  // aligned.
  if (is_letter(name[0]) && !is_letter(name[1])) return single_letter(name[0]);
  const El element = two_letters(name[0], name[1]);
  return element != El::X ? element : first_letter(name);
}

// Rule 3. A symbol of two letters is tried last, for names whose first letter is no element ("ZN").
El of_bare_name(std::string_view name) {
  El element = halogen(name);
  if (element == El::X) element = unambiguous_symbol(name);
  if (element == El::X) element = first_letter(name);
  if (element == El::X && name.size() > 1) element = two_letters(name[0], name[1]);
  return element;
}

}  // namespace

const char* element_of_aligned_name(std::string_view four_columns, std::string_view residue) {
  std::string name(four_columns.substr(0, 4));
  name.resize(4, ' ');
  name = upper_case(name);
  const El known = in_known_residue(trimmed(name), capitals(residue));
  if (known != El::X) return gemmi::element_name(known);
  const El element = of_aligned_name(name);
  // CHARMM writes "ZN" from column 14 on. No element has the symbol Z, so rule 2 fails.
  return gemmi::element_name(element != El::X ? element : of_bare_name(trimmed(name)));
}

const char* element_of_bare_name(std::string_view name, std::string_view residue) {
  if (is_martini_bead(name, residue)) return gemmi::element_name(El::X);
  const std::string bare = capitals(name);
  const El known = in_known_residue(bare, capitals(residue));
  return gemmi::element_name(known != El::X ? known : of_bare_name(bare));
}

const char* element_of_symbol(std::string_view symbol) {
  symbol = trimmed(symbol);
  std::size_t letters = 0;
  while (letters < symbol.size() && is_letter(symbol[letters])) ++letters;
  if (letters == 0 || letters > 2) return gemmi::element_name(El::X);
  const El element = letters == 1 ? single_letter(symbol[0])
                                  : gemmi::find_element(std::string(symbol.substr(0, 2)).c_str());
  return gemmi::element_name(element);
}

bool is_martini_bead(std::string_view name, std::string_view residue) {
  const std::string_view bare = trimmed(name);
  const char first = bare.empty() ? ' ' : upper_case(bare.front());
  if (first != 'G' && first != 'S' && first != 'B') return false;
  const std::string bead = capitals(name);
  if (bead == "GL1") return true;
  const bool side_chain =
      bead.size() == 3 && bead.starts_with("SC") && bead[2] >= '1' && bead[2] <= '6';
  return (bead == "BB" || side_chain) && is_amino_acid(capitals(residue));
}

}  // namespace vdwmesh
