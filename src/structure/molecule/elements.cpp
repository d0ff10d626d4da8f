// read_element() weighs the symbol of the file against the names. For names there is a cascade of
// rules, from the most to the least reliable:
// 1. in_known_residue(): what the name of the residue implies (tables in residue_elements.cpp).
// 2. of_aligned_name(): the columns in which a PDB file places the name.
// 3. of_bare_name(): the letters alone, with a preference for light elements, since nearly all
//    atoms of molecules are C, N, O, H, P or S.
// Each rule returns El::X, gemmi's unknown element, if it cannot decide; then the next one is
// tried. Names are in capitals here. "The columns" are columns 13 to 16 of a PDB record.
#include "structure/molecule/elements.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <gemmi/elem.hpp>
#include <string>

#include "core/letters.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/read/lines.hpp"
#include "structure/read/parsed_file.hpp"

namespace vdwmesh {
namespace {

using gemmi::El;

constexpr std::string_view kOrganic = "CNOHPS";  // elements of one letter in standard residues

std::string capitals(std::string_view text) { return upper_case(trimmed(text)); }

El single_letter(char c) {
  const char symbol[] = {c, '\0'};
  return gemmi::find_element(symbol);
}

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
  // The PDB's X and the older A stand for O or N, which share these places: OE1 and NE2 of GLN.
  if (name.size() == 3 && (name[0] == 'X' || name[0] == 'A') &&
      (residue == "ASX" || residue == "GLX" || residue == "ASN" || residue == "GLN"))
    return name.ends_with('1') ? El::O : name.ends_with('2') ? El::N : El::X;
  const El element = first_letter(name);
  if (is_named_as_water(residue) && element != El::O && !gemmi::is_hydrogen(element)) return El::X;
  return is_organic(element) ? element : El::X;
}

bool has_only_light_atoms(std::string_view residue) {
  return is_standard_residue(residue) || is_named_as_water(residue);
}

// Rule 1: the element that the name of the residue implies, in standard residues, ions and known
// ligands with metals. In such a ligand, an atom that is not a metal is an organic element by its
// first letter.
El in_known_residue(std::string_view name, std::string_view residue) {
  if (has_only_light_atoms(residue)) return in_standard_residue(name, residue);
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

// Rule 3. A symbol of two letters is tried last, for names whose first letter is no element ("ZN").
// Xenon is left to rule 1: an X in a name means an unknown atom, as in "XE1" of GLX.
El of_bare_name(std::string_view name) {
  El element = halogen(name);
  if (element == El::X) element = unambiguous_symbol(name);
  if (element == El::X) element = first_letter(name);
  if (element == El::X && name.size() > 1) element = two_letters(name[0], name[1]);
  return element == El::Xe ? El::X : element;
}

// Whether the element was told from a name that begins with D, and the residue has no such
// deuterium.
bool is_dummy(El told, std::string_view name, std::string_view residue) {
  name.remove_prefix(std::min(name.find_first_not_of("0123456789"), name.size()));
  return (told == El::D || told == El::X) && name.starts_with('D') &&
         !is_deuterium_name(name, residue);
}

// Rule 2. The name has exactly four characters and may contain blanks. Old PDB files put the digit
// of a hydrogen first ("1HB "), so the letter behind a leading digit is the symbol. A digit behind
// the first letter ("H11A") ends the symbol. A name that begins behind column 13 is read by its
// letters, because many programs write those of chlorine and iron there as well.
El of_aligned_name(std::string_view name) {
  if (name[0] == ' ') return of_bare_name(trimmed(name));
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

// Symbols that programs give to what is no atom: virtual sites (OpenMM, mdtraj), lone pairs,
// dummies of free-energy calculations, alpha spheres (fpocket).
constexpr std::array<std::string_view, 7> kVirtualSymbols{"VS", "EP", "LP", "MW", "XX", "DU", "VE"};
// How names of virtual sites, lone pairs and dummies begin.
constexpr std::array<std::string_view, 5> kVirtualNames{"EP", "LP", "VS", "MW", "DU"};

// Whether the names are of something that is no atom: all of residue DUM (membranes of OPM), alpha
// spheres of fpocket, pseudo-atoms of PyMOL, sites of water models ("OM", "IW"), virtual sites,
// masses and pseudo-atoms of amino acids ("MCB1", "QB"). `given` is the element of the symbol.
bool is_virtual(std::string_view symbol, std::string_view name, std::string_view residue,
                El given) {
  const auto begins_name = [name](std::string_view prefix) { return name.starts_with(prefix); };
  if (residue == "DUM" || (residue == "STP" && (name == "POL" || name == "APOL"))) return true;
  if (residue == "PSD" && symbol == "PS") return true;
  if ((name == "OM" || name == "IW") && is_named_as_water(residue)) return true;
  // A program that takes the first letter of "VS1" for its symbol; no vanadium is called so.
  if (given == El::V && name.starts_with("VS")) return true;
  if (given != El::X || symbol == "X") return false;
  if (std::find(kVirtualSymbols.begin(), kVirtualSymbols.end(), symbol) != kVirtualSymbols.end())
    return true;
  if (std::any_of(kVirtualNames.begin(), kVirtualNames.end(), begins_name)) return true;
  if (!has_only_light_atoms(residue) || name.empty()) return false;
  constexpr std::string_view kNoLightElement = "ELMQV";
  return kNoLightElement.find(name[0]) != std::string_view::npos && name != "V" &&
         (name.size() < 2 || name.starts_with("MN") || two_letters(name[0], name[1]) == El::X);
}

// Whether the symbol is one of two letters that begin the name, and the second letter tells the
// position of a light atom: alpha to zeta, eta, and O of hydrogens.
bool is_positional(El given, std::string_view name) {
  constexpr std::string_view kPositions = "ABGDEZHO";
  return name.size() > 1 && kOrganic.find(name[0]) != std::string_view::npos &&
         two_letters(name[0], name[1]) == given && given != El::Co &&
         kPositions.find(name[1]) != std::string_view::npos;
}

// Whether `rest` is the first letter of the symbol of two letters of `whole`.
bool is_rest_of(El rest, El whole) {
  const char *const letter = gemmi::element_name(rest), *const symbol = gemmi::element_name(whole);
  return letter[1] == '\0' && symbol[1] != '\0' && letter[0] == symbol[0];
}

// The element of an atom to which the file gives one. `name` and `residue` are in capitals,
// `written` is the name as it stands in the file.
El weighed(El given, std::string_view name, std::string_view residue, std::string_view written,
           NamePlace place) {
  const El known = in_known_residue(name, residue);
  if (known == El::X) {
    const El whole = halogen(name) != El::X ? halogen(name) : unambiguous_symbol(name);
    const bool tells =
        trimmed(written).size() > 1 && (is_small_letter(trimmed(written)[1]) ||
                                        (place == NamePlace::columns && written[0] != ' '));
    return whole != El::X && tells && is_rest_of(given, whole) ? whole : given;
  }
  if (is_rest_of(given, known) || is_positional(given, name)) return known;
  if (gemmi::is_hydrogen(given) && gemmi::is_hydrogen(known)) return given;
  if (!has_only_light_atoms(residue)) return element_of_ion(name, residue) != El::X ? known : given;
  // "XE1" of GLX is no xenon, whoever says so.
  const bool is_whole =
      name.size() > 1 && two_letters(name[0], name[1]) == given && given != El::Xe;
  return is_whole || (given == El::Se && known == El::S) ? given : known;
}

// Whether symbol and name agree on an ion, and the residue has the name of another: "NA" of "CL".
bool is_other_ion(El given, std::string_view name, std::string_view residue) {
  if (name.size() != 2 || two_letters(name[0], name[1]) != given || residue.size() < 2)
    return false;
  const El ion = element_of_ion(residue, residue);
  return ion != El::X && ion != given && !is_organic(ion) && !is_ligand_with_metals(residue);
}

// Whether the symbol is the letter by which the name begins, in a residue that does not make more
// of it: so it is with nearly all atoms.
bool is_plain(std::string_view symbol, std::string_view name, std::string_view residue,
              const AtomRecord& atom) {
  constexpr std::string_view kLaterLetters = "LREIUTlreiutMm";  // of symbols and of "OM"
  if (symbol.size() != 1 || !is_organic(atom.element) || atom.element == El::D) return false;
  name = trimmed(name);
  return !name.empty() && name[0] == symbol[0] && name != residue && residue != "DUM" &&
         residue != "STP" && (!atom.hetero || residue == "HOH") &&
         (name.size() < 2 || kLaterLetters.find(name[1]) == std::string_view::npos);
}

}  // namespace

void read_element(std::string_view symbol, std::string_view name, NamePlace place,
                  std::string_view residue, AtomRecord& atom) {
  if (is_plain(symbol, name, residue, atom)) return;
  const std::string bare = capitals(name), of_residue = capitals(residue);
  const El given = atom.element;
  atom.is_virtual = is_virtual(capitals(symbol), bare, of_residue, given);
  if (atom.is_virtual) {
    atom.element = El::X;
  } else if (given != El::X) {
    atom.element = weighed(given, bare, of_residue, name, place);
    atom.symbol_overruled = atom.element != given;
    atom.is_other_ion = is_other_ion(given, bare, of_residue);
  } else if (capitals(symbol) != "X" || in_known_residue(bare, of_residue) != El::X) {
    atom.element_guessed = true;
    atom.element =
        gemmi::find_element(place == NamePlace::columns ? element_of_aligned_name(name, residue)
                                                        : element_of_bare_name(name, residue));
    atom.is_virtual = is_dummy(atom.element, bare, of_residue);
    if (atom.is_virtual) atom.element = El::X;
  }
}

const char* element_of_aligned_name(std::string_view four_columns, std::string_view residue) {
  std::string name(four_columns.substr(0, 4));
  name.resize(4, ' ');
  name = upper_case(name);
  const El known = in_known_residue(trimmed(name), capitals(residue));
  if (known != El::X) return gemmi::element_name(known);
  const El element = of_aligned_name(name);
  return gemmi::element_name(element != El::X ? element : of_bare_name(trimmed(name)));
}

const char* element_of_bare_name(std::string_view name, std::string_view residue) {
  if (is_martini_bead(name, residue)) return gemmi::element_name(El::X);
  const std::string bare = capitals(name), of_residue = capitals(residue);
  const El known = in_known_residue(bare, of_residue);
  const El told = known != El::X ? known : of_bare_name(bare);
  return gemmi::element_name(!residue.empty() && is_dummy(told, bare, of_residue) ? El::X : told);
}

const char* element_of_symbol(std::string_view symbol) {
  symbol = trimmed(symbol);
  std::size_t letters = 0;
  while (letters < symbol.size() && is_letter(symbol[letters])) ++letters;
  if (letters == 0 || letters > 2) return gemmi::element_name(El::X);
  if (letters == 1 && upper_case(symbol[0]) == 'T') return gemmi::element_name(El::H);
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
