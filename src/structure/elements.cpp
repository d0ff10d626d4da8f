#include "structure/elements.hpp"

#include <array>
#include <cctype>
#include <gemmi/elem.hpp>
#include <gemmi/resinfo.hpp>
#include <string>

#include "structure/lines.hpp"

namespace vdwmesh {
namespace {

using gemmi::El;

constexpr std::string_view kOrganic = "CNOHPS";

char upper(char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

El single_letter(char c) { return gemmi::impl::find_single_letter_element(upper(c)); }

// Elements past lawrencium exist for moments; a name like "NH1A" never means nihonium.
El two_letters(char first, char second) {
  const std::array<char, 3> symbol{first, second, '\0'};
  const El found = gemmi::find_element(symbol.data());
  return found > El::Lr && found != El::D ? El::X : found;
}

bool only_organic_elements(std::string_view residue) {
  const gemmi::ResidueInfo info = gemmi::find_tabulated_residue(std::string(residue));
  return (info.is_amino_acid() || info.is_nucleic_acid()) &&
         (info.is_standard() || residue == "MSE");  // not the modified ones: some hold halogens
}

El first_letter(std::string_view name) {
  for (const char c : name)
    if (is_letter(c)) return single_letter(c);
  return El::X;
}

El of_standard_residue(std::string_view four_columns, std::string_view residue) {
  if ((residue == "MSE" || residue == "SEC") && trimmed(four_columns) == "SE") return El::Se;
  const El element = first_letter(four_columns);
  const bool expected = element == El::D ||
                        (element != El::X &&
                         kOrganic.find(gemmi::element_name(element)[0]) != std::string_view::npos);
  return expected ? element : El::X;
}

// "CL1", "BR": no carbon or boron has such a name outside the standard residues.
El halogen(std::string_view name) {
  if (name.size() < 2) return El::X;
  const El element = two_letters(name[0], name[1]);
  return element == El::Cl || element == El::Br ? element : El::X;
}

El of_full_name(std::string_view name) {
  const char first = upper(name[0]), second = upper(name[1]);
  if (halogen(name) != El::X) return halogen(name);
  if (kOrganic.find(first) != std::string_view::npos) return single_letter(first);
  const El element = two_letters(first, second);
  return element != El::X ? element : first_letter(name);
}

El of_aligned_name(std::string_view name) {
  if (is_digit(name[0])) return single_letter(name[1]);
  if (name[3] != ' ' && is_letter(name[0])) {
    if (is_digit(name[1])) return single_letter(name[0]);
    return of_full_name(name);
  }
  if (is_letter(name[0]) && !is_letter(name[1])) return single_letter(name[0]);
  const El element = two_letters(name[0], name[1]);
  return element != El::X ? element : first_letter(name);
}

}  // namespace

const char* element_of_aligned_name(std::string_view four_columns, std::string_view residue) {
  std::string name(four_columns.substr(0, 4));
  name.resize(4, ' ');
  if (only_organic_elements(residue)) {
    const El element = of_standard_residue(name, residue);
    if (element != El::X) return gemmi::element_name(element);
  }
  return gemmi::element_name(of_aligned_name(name));
}

const char* element_of_bare_name(std::string_view name, std::string_view residue) {
  name = trimmed(name);
  if (only_organic_elements(residue)) {
    const El element = of_standard_residue(name, residue);
    if (element != El::X) return gemmi::element_name(element);
  }
  const std::string_view bare_residue = residue.substr(0, residue.find_first_of("0123456789+-"));
  const std::string_view bare_name = name.substr(0, name.find_first_of("0123456789+-"));
  const bool ion = bare_name.size() == 2 && bare_name == bare_residue.substr(0, 2);
  El element = ion ? two_letters(bare_name[0], bare_name[1]) : El::X;
  if (element == El::X) element = halogen(name);
  if (element == El::X) element = first_letter(name);
  if (element == El::X && name.size() > 1) element = two_letters(name[0], name[1]);
  return gemmi::element_name(element);
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

}  // namespace vdwmesh
