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

}  // namespace

std::vector<std::uint32_t> residue_numbers(const ParsedFile& file,
                                           const std::vector<ResiduePlace>& places) {
  const std::vector<AtomRecord>& atoms = file.atoms;
  const std::vector<std::uint32_t> firsts = first_places(places);
  const auto by_residue = [](const AtomRecord& a, const AtomRecord& b) {
    return a.residue < b.residue;
  };
  // No place has the key of an earlier one if each is the first of its own.
  const bool plain =
      std::adjacent_find(firsts.begin(), firsts.end(), std::greater_equal()) == firsts.end() &&
      std::is_sorted(atoms.begin(), atoms.end(), by_residue);
  if (plain) return {};
  std::vector<std::uint32_t> numbers;
  numbers.reserve(atoms.size());
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> current(places.size(), kNone);  // by first place: its last residue
  std::set<std::tuple<std::uint32_t, std::string_view, char>> held;  // residue, name, label
  std::uint32_t residues = 0;
  for (auto first = atoms.begin(); first != atoms.end();) {
    const std::uint32_t place = firsts[first->residue];
    const auto last = std::find_if(
        first, atoms.end(), [&](const AtomRecord& atom) { return firsts[atom.residue] != place; });
    std::uint32_t& number = current[place];
    const bool again = number != kNone && std::any_of(first, last, [&](const AtomRecord& atom) {
                         return held.contains({number, atom.name.view(), atom.altloc});
                       });
    if (number == kNone || again) number = residues++;
    for (; first != last; ++first) {
      numbers.push_back(number);
      held.emplace(number, first->name.view(), first->altloc);
    }
  }
  return numbers;
}

}  // namespace vdwmesh
