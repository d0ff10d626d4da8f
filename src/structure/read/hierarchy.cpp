// Walks gemmi's models, chains and residues in order. Files list atoms in this order but for few,
// whose sites are sorted by counting.
#include "structure/read/hierarchy.hpp"

#include <algorithm>
#include <functional>
#include <gemmi/model.hpp>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>

#include "core/large_pages.hpp"
#include "core/letters.hpp"
#include "structure/molecule/residue_elements.hpp"

namespace vdwmesh {

std::vector<ResiduePlace> numbered_residues(gemmi::Structure& structure) {
  std::vector<ResiduePlace> places;
  for (gemmi::Model& model : structure.models)
    for (gemmi::Chain& chain : model.chains)
      for (gemmi::Residue& residue : chain.residues) places.push_back({&model, &chain, &residue});
  return places;
}

void take_gemmi_atoms(ParsedFile& file) {
  const std::vector<ResiduePlace> places = numbered_residues(*file.structure);
  for (std::size_t number = 0; number < places.size(); ++number)
    for (const gemmi::Atom& atom : places[number].residue->atoms) {
      AtomRecord& record = file.atoms[static_cast<std::size_t>(atom.serial)];
      record.residue = static_cast<std::uint32_t>(number);
      record.position = {atom.pos.x, atom.pos.y, atom.pos.z};
      record.name = atom.name;
      record.element = atom.element;
      record.altloc = atom.altloc;
      record.occupancy = atom.occ;
      record.b_iso = atom.b_iso;
    }
}

void copy_to_gemmi(const AtomRecord& record, gemmi::Atom& atom) {
  atom.name = record.name.str();
  atom.element = record.element;
  atom.altloc = record.altloc;
  atom.occ = record.occupancy;
  atom.b_iso = record.b_iso;
  atom.pos = {record.position.x, record.position.y, record.position.z};
}

void give_gemmi_atoms(ParsedFile& file) {
  const std::vector<ResiduePlace> places = numbered_residues(*file.structure);
  const bool has_atoms = std::any_of(places.begin(), places.end(), [](const ResiduePlace& place) {
    return !place.residue->atoms.empty();
  });
  if (has_atoms) return;
  for (std::size_t i = 0; i < file.atoms.size(); ++i) {
    gemmi::Atom& atom = places[file.atoms[i].residue].residue->atoms.emplace_back();
    copy_to_gemmi(file.atoms[i], atom);
    atom.serial = static_cast<int>(i);
  }
}

Sites all_sites(ParsedFile& file, const std::vector<ResiduePlace>& places) {
  std::vector<AtomRecord>& atoms = file.atoms;
  const auto site_of = [&](AtomRecord& atom) { return Site{&places[atom.residue], &atom}; };
  Sites sites;
  sites.reserve(atoms.size());
  advise_large_pages(sites.data(), atoms.size());
  std::uint32_t last = 0;  // residue
  for (AtomRecord& atom : atoms) {
    if (atom.residue < last) break;
    last = atom.residue;
    sites.push_back(site_of(atom));
  }
  if (sites.size() == atoms.size()) return sites;
  std::vector<std::size_t> next(places.size() + 1);  // site of the next atom of each residue
  for (const AtomRecord& atom : atoms) ++next[atom.residue + 1];
  for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
  sites.resize(atoms.size());
  for (AtomRecord& atom : atoms) sites[next[atom.residue]++] = site_of(atom);
  return sites;
}

namespace {

using PlaceKey = std::tuple<const gemmi::Model*, std::string_view, std::string_view, int, char,
                            std::string_view>;

PlaceKey key_of(const ResiduePlace& place) {
  const gemmi::Residue& residue = *place.residue;
  return {place.model,         place.chain->name, residue.segment, residue.seqid.num.value,
          residue.seqid.icode, residue.name};
}

// For each place the first one with the same key.
std::vector<std::uint32_t> first_places(const std::vector<ResiduePlace>& places) {
  std::map<PlaceKey, std::uint32_t> known;
  std::vector<std::uint32_t> firsts;
  firsts.reserve(places.size());
  for (const ResiduePlace& place : places)
    // Keys mostly rise, so the end is the hint.
    firsts.push_back(
        known.try_emplace(known.end(), key_of(place), static_cast<std::uint32_t>(firsts.size()))
            ->second);
  return firsts;
}

// Least distance of atoms of one name in two residues, Å. Places of one disordered atom are mostly
// nearer to each other.
constexpr double kApart = 1.5;

using AtomIterator = std::vector<AtomRecord>::const_iterator;

bool is_same_unlabelled(const AtomRecord& atom, const AtomRecord& other) {
  return atom.altloc == '\0' && other.altloc == '\0' && atom.name == other.name;
}

// Whether each atom is called by its element alone, as programs do that know no names.
bool are_called_by_element(AtomIterator first, AtomIterator last) {
  return std::all_of(first, last, [](const AtomRecord& atom) {
    return upper_case(atom.name.view()) == upper_case(gemmi::element_name(atom.element));
  });
}

// Where residues begin among atoms that stand together and whose residues have one name and one
// number: at the first, and wherever its name comes again, apart from the place that it has in the
// residue before. Another name that comes again within a residue, but for hydrogens of water, shows
// that names are not unique in it, or that locations have no labels; then all is one residue. So it
// is if all atoms are called by their elements, or a residue would have one atom; water, ions and
// traces of chains may.
std::vector<AtomIterator> beginnings(AtomIterator first, AtomIterator last,
                                     const std::string& residue) {
  std::vector<AtomIterator> begins{first};
  const auto is_as_first = [first](const AtomRecord& atom) {
    return is_same_unlabelled(atom, *first);
  };
  if (first->name.size() == 0 || std::none_of(first + 1, last, is_as_first)) return begins;
  const std::string name = upper_case(residue);
  const bool is_water = water_name(name) != WaterName::none;
  const std::string leader = upper_case(first->name.view());
  const bool may_be_single = is_water || element_of_ion(leader, name) != gemmi::El::X ||
                             (is_standard_residue(name) && (leader == "CA" || leader == "P"));
  const std::vector<AtomIterator> one = begins;
  std::set<std::string_view> held;  // by the last residue so far, without its first atom
  bool is_single = false;           // whether a residue has one atom
  for (AtomIterator atom = first + 1; atom != last; ++atom) {
    if (is_as_first(*atom) && norm(atom->position - begins.back()->position) >= kApart) {
      is_single = is_single || atom - begins.back() == 1;
      begins.push_back(atom);
      held.clear();
    } else if (!is_water && atom->altloc == '\0' &&
               (is_as_first(*atom) || !held.insert(atom->name.view()).second)) {
      return one;
    }
  }
  is_single = is_single || last - begins.back() == 1;
  return may_be_single || (!is_single && !are_called_by_element(first, last)) ? begins : one;
}

}  // namespace

std::vector<std::uint32_t> residue_numbers(const ParsedFile& file,
                                           const std::vector<ResiduePlace>& places) {
  const std::vector<AtomRecord>& atoms = file.atoms;
  const std::vector<std::uint32_t> firsts = first_places(places);
  const auto by_residue = [](const AtomRecord& a, const AtomRecord& b) {
    return a.residue < b.residue;
  };
  // The end of the atoms that stand together in the place of the first.
  const auto end_of_place = [&](AtomIterator first) {
    const std::uint32_t place = firsts[first->residue];
    return std::find_if(first, atoms.end(), [&, place](const AtomRecord& atom) {
      return firsts[atom.residue] != place;
    });
  };
  const auto has_neighbours = [&] {
    for (auto first = atoms.begin(); first != atoms.end();) {
      const auto last = end_of_place(first);
      if (beginnings(first, last, places[first->residue].residue->name).size() > 1) return true;
      first = last;
    }
    return false;
  };
  // No place has the key of an earlier one if each is the first of its own.
  const bool plain =
      std::adjacent_find(firsts.begin(), firsts.end(), std::greater_equal()) == firsts.end() &&
      std::is_sorted(atoms.begin(), atoms.end(), by_residue);
  if (plain && !has_neighbours()) return {};
  std::vector<std::uint32_t> numbers;
  numbers.reserve(atoms.size());
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> current(places.size(), kNone);  // by first place: its last residue
  std::set<std::tuple<std::uint32_t, std::string_view, char>> held;  // residue, name, label
  std::uint32_t residues = 0;
  for (auto first = atoms.begin(); first != atoms.end();) {
    const auto end = end_of_place(first);
    std::vector<AtomIterator> ends = beginnings(first, end, places[first->residue].residue->name);
    ends.erase(ends.begin());
    ends.push_back(end);
    std::uint32_t& number = current[firsts[first->residue]];
    for (const AtomIterator last : ends) {
      const bool again = number != kNone && std::any_of(first, last, [&](const AtomRecord& atom) {
                           return held.contains({number, atom.name.view(), atom.altloc});
                         });
      if (number == kNone || again) number = residues++;
      for (; first != last; ++first) {
        numbers.push_back(number);
        held.emplace(number, first->name.view(), first->altloc);
      }
    }
  }
  return numbers;
}

}  // namespace vdwmesh
