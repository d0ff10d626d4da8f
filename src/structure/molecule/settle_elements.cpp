// Decides elements by looking at whole residues, after all atoms have been read. elements.hpp says
// in which cases.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <gemmi/model.hpp>
#include <span>
#include <tuple>

#include "core/letters.hpp"
#include "structure/molecule/each_residue.hpp"
#include "structure/molecule/elements.hpp"
#include "structure/molecule/site.hpp"
#include "structure/read/hierarchy.hpp"

namespace vdwmesh {
namespace {

using gemmi::El;

// How far a Drude particle may lie from its atom, Å. They lie within 0.2 Å in simulations, and a
// bound deuterium 0.95 Å away.
constexpr double kMostDrude = 0.5;

// Elements whose symbol more often is a light element with a letter of position behind it, even
// where it begins in column 13: alpha carbon, gamma hydrogen, hydrogen of an oxygen.
constexpr std::array kDoubtful{El::Ca, El::Cd, El::Ce, El::Na, El::Nb, El::Nd, El::Ne,
                               El::Pa, El::Pb, El::He, El::Hf, El::Hg, El::Ho};

El element_by_letters(const Site& site) {
  return gemmi::find_element(
      element_of_bare_name(site.atom->name.view(), site.place->residue->name));
}

// Whether read_element() took the atom for a dummy, by its name that begins with D alone.
bool is_dummy_by_name(const AtomRecord& atom) { return atom.is_virtual && atom.element_guessed; }

// Whether the name of a D is that of an atom with D in front, as of Drude particles and dummies.
bool may_be_drude(const AtomRecord& atom) {
  return is_dummy_by_name(atom) ||
         (atom.element == El::D && atom.name.view().size() > 1 && is_letter(atom.name.view()[1]));
}

// Marks the Drude particles of one residue: an atom of the name behind the D lies at their place. A
// residue may hold many atoms of one name, so they are sorted by x.
void mark_drudes(std::span<const Site> residue) {
  if (std::none_of(residue.begin(), residue.end(),
                   [](const Site& site) { return may_be_drude(*site.atom); }))
    return;
  // Dummies without a symbol, beside some that have one.
  const bool has_dummies = std::any_of(residue.begin(), residue.end(), [](const Site& site) {
    return site.atom->element == El::X && !site.atom->element_guessed;
  });
  std::vector<const AtomRecord*> atoms;
  for (const Site& site : residue) atoms.push_back(site.atom);
  const auto before = [](const AtomRecord* a, const AtomRecord* b) {
    return std::pair(a->name.view(), a->position.x) < std::pair(b->name.view(), b->position.x);
  };
  std::sort(atoms.begin(), atoms.end(), before);
  const auto lies_on_atom = [&](const AtomRecord& drude) {
    AtomRecord first;
    first.name = drude.name.view().substr(1);
    first.position.x = drude.position.x - kMostDrude;
    for (auto at = std::lower_bound(atoms.begin(), atoms.end(), &first, before);
         at != atoms.end() && (*at)->name.view() == first.name.view() &&
         (*at)->position.x <= drude.position.x + kMostDrude;
         ++at)
      if (norm((*at)->position - drude.position) <= kMostDrude) return true;
    return false;
  };
  for (const Site& site : residue) {
    AtomRecord& atom = *site.atom;
    if (!may_be_drude(atom)) continue;
    if (lies_on_atom(atom) || (has_dummies && atom.element_guessed)) {
      atom.is_virtual = true;
      atom.element = El::X;
      atom.element_guessed = false;  // place or residue say so, not the name alone
    }
  }
}

void read_doubtful_by_letters(std::span<const Site> residue) {
  const auto is_other = [&](const Site& site) {
    return site.atom->name.view() != residue.front().atom->name.view();
  };
  if (std::none_of(residue.begin(), residue.end(), is_other)) return;
  for (const Site& site : residue)
    if (site.atom->element_guessed &&
        std::find(kDoubtful.begin(), kDoubtful.end(), site.atom->element) != kDoubtful.end())
      site.atom->element = element_by_letters(site);
}

// Whether the element's symbol has two letters, and the name begins by them.
bool begins_name(El element, std::string_view name) {
  const std::string_view symbol = gemmi::element_name(element);
  return symbol.size() == 2 && upper_case(name).starts_with(upper_case(symbol));
}

// Reads all symbols of two letters as names where a standard residue has shown that they are.
void read_symbols_as_names(const Sites& sites) {
  for (const Site& site : sites) {
    AtomRecord& atom = *site.atom;
    if (atom.element_guessed || atom.symbol_overruled ||
        !begins_name(atom.element, atom.name.view()))
      continue;
    const El letters = element_by_letters(site);
    atom.symbol_overruled = letters != El::X && letters != atom.element;
    if (atom.symbol_overruled) atom.element = letters;
  }
}

void warn_of_overruled(const Sites& sites, ParsedFile& file) {
  const auto is_overruled = [](const Site& site) { return site.atom->symbol_overruled; };
  const auto first = std::find_if(sites.begin(), sites.end(), is_overruled);
  if (first == sites.end()) return;
  file.warnings.push_back(fmt::format(
      "the symbols of {} atoms contradict the names of atom and residue, which decided: the first "
      "is {} for atom {} of {} {}",
      std::count_if(first, sites.end(), is_overruled), gemmi::element_name(first->atom->element),
      first->atom->name.view(), first->place->residue->name, first->place->residue->seqid.str()));
}

void warn_of_other_ions(const Sites& sites, ParsedFile& file) {
  const auto is_other = [](const Site& site) { return site.atom->is_other_ion; };
  const auto first = std::find_if(sites.begin(), sites.end(), is_other);
  if (first == sites.end()) return;
  file.warnings.push_back(fmt::format(
      "{} atoms are ions by symbol and name, which decided, in residues with the name of another: "
      "the first is {} in {} {}",
      std::count_if(first, sites.end(), is_other), gemmi::element_name(first->atom->element),
      first->place->residue->name, first->place->residue->seqid.str()));
}

void warn_of_dummies(const Sites& sites, ParsedFile& file) {
  const auto is_dummy = [](const Site& site) { return is_dummy_by_name(*site.atom); };
  const auto first = std::find_if(sites.begin(), sites.end(), is_dummy);
  if (first == sites.end()) return;
  file.warnings.push_back(fmt::format(
      "{} without an element are dummies by their names, which begin with D and are of no hydrogen "
      "of the residue: the first is {} of {} {}; with the symbol D they are deuterium",
      std::count_if(first, sites.end(), is_dummy), first->atom->name.view(),
      first->place->residue->name, first->place->residue->seqid.str()));
}

}  // namespace

void settle_elements(ParsedFile& file) {
  if (!file.elements_in_doubt || file.coarse_grained) return;
  const std::vector<ResiduePlace> places = numbered_residues(*file.structure);
  const Sites sites = all_sites(file, places);
  for_each_residue(sites, mark_drudes);
  for_each_residue(sites, read_doubtful_by_letters);
  // "CA" and carbon, for one.
  const bool names_as_symbols = std::any_of(sites.begin(), sites.end(), [](const Site& site) {
    const std::string begin(site.atom->name.view().substr(0, 2));
    return site.atom->symbol_overruled && gemmi::element_name(site.atom->element)[1] == '\0' &&
           gemmi::find_element(begin.c_str()) != El::X;
  });
  if (names_as_symbols) read_symbols_as_names(sites);
  warn_of_overruled(sites, file);
  warn_of_other_ions(sites, file);
  warn_of_dummies(sites, file);
}

}  // namespace vdwmesh
