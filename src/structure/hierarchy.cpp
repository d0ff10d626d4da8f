// Walks gemmi's models, chains and residues in order. Files list atoms in this order but for few,
// whose sites are sorted by counting.
#include "structure/hierarchy.hpp"

#include <algorithm>
#include <gemmi/model.hpp>
#include <string>

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

}  // namespace vdwmesh
