// Steps of `vdwmesh interface`. The library measures all pairs of sides at once; here the figures
// of atoms are added up by side, residue and polarity. Sums are wide, so that they do not depend on
// the order.
#include "steps/interface_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "command_line/names.hpp"
#include "core/sum.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

// A chain without an id goes by its segment.
using ChainKey = std::tuple<std::int32_t, std::string_view, std::string_view>;
ChainKey chain_of(const Atom& atom) {
  return {atom.model, atom.chain, atom.chain.empty() ? atom.segment.view() : std::string_view()};
}

std::string chain_name(const Atom& atom, bool has_models) {
  const std::string_view id = atom.chain.empty() ? atom.segment.view() : atom.chain.view();
  const std::string name = id.empty() ? "(no chain)" : std::string(id);
  return has_models ? fmt::format("{}/{}", atom.model, name) : name;
}

using ResidueKey = std::tuple<std::int32_t, std::string_view, std::uint32_t>;
ResidueKey residue_of(const Atom& atom) { return {atom.model, atom.chain, atom.residue}; }

// Atoms of files without names, such as XYZR, are called by their place in use, from 1.
std::string residue_name(const Molecule& molecule, SphereId id) {
  const Atom& atom = molecule.atoms[id];
  if (atom.residue_name.empty()) return fmt::format("atom {}", id + 1);
  return fmt::format("{}/{} {}", atom.chain.view(), atom.residue_number.view(),
                     atom.residue_name.view());
}

SideReport side_of(const Molecule& molecule, std::span<const std::int32_t> of_atom,
                   std::int32_t side, const Interfaces& found, const Interface& pair) {
  const GroupAreas& group = found.groups[static_cast<std::size_t>(side)];
  const double buried = side == pair.a ? pair.buried_a : pair.buried_b;
  SideReport report{group.alone, group.alone - buried, group.in_whole, buried, 0, 0};
  std::set<ResidueKey> residues;
  for (const InterfaceAtom& atom : pair.atoms) {
    if (of_atom[atom.sphere] != side || atom.buried() < kLeastBurial) continue;
    ++report.atoms;
    residues.insert(residue_of(molecule.atoms[atom.sphere]));
  }
  report.residues = residues.size();
  return report;
}

std::optional<AreaByPolarity> buried_by_polarity(const Molecule& molecule, const Interface& pair) {
  if (!molecule.has_polarity) return std::nullopt;
  ResidueSum sum;
  for (const InterfaceAtom& atom : pair.atoms) sum.add(molecule.atoms[atom.sphere], atom.buried());
  const ResidueAreas areas = sum.areas();
  return AreaByPolarity{areas.polar, areas.apolar, sum.unclassified_area()};
}

std::vector<ResidueContact> residue_contacts(const Molecule& molecule, const Interface& pair) {
  std::map<std::pair<ResidueKey, ResidueKey>, std::size_t> known;
  std::vector<ResidueContact> contacts;
  std::vector<WideSum> areas;
  for (const AtomContact& contact : pair.contacts) {
    const std::size_t next = contacts.size();
    const std::size_t place = known
                                  .try_emplace({residue_of(molecule.atoms[contact.a]),
                                                residue_of(molecule.atoms[contact.b])},
                                               next)
                                  .first->second;
    if (place == next) {
      contacts.push_back({residue_name(molecule, contact.a), residue_name(molecule, contact.b), 0});
      areas.emplace_back();
    }
    areas[place].add(contact.area);
  }
  for (std::size_t i = 0; i < contacts.size(); ++i) contacts[i].area = areas[i].value();
  std::ranges::stable_sort(contacts, std::greater(), &ResidueContact::area);
  return contacts;
}

// The pair as it is without the other side, for selections that do not touch.
Interface apart(std::int32_t a, std::int32_t b, const Interfaces& found) {
  Interface none{};
  none.a = a;
  none.b = b;
  none.area_a = found.groups[static_cast<std::size_t>(a)].alone;
  none.area_b = found.groups[static_cast<std::size_t>(b)].alone;
  return none;
}

// Adds the pairs of sides that do not touch, in order.
void add_pairs_apart(Interfaces& found) {
  const auto is_before = [](const Interface& p, const Interface& q) {
    return std::pair(p.a, p.b) < std::pair(q.a, q.b);
  };
  const auto sides = static_cast<std::int32_t>(found.groups.size());
  for (std::int32_t a = 0; a < sides; ++a) {
    for (std::int32_t b = a + 1; b < sides; ++b) {
      const Interface none = apart(a, b, found);
      const auto place = std::ranges::lower_bound(found.pairs, none, is_before);
      if (place == found.pairs.end() || is_before(none, *place)) found.pairs.insert(place, none);
    }
  }
}

// Atoms nearer than half of the sum of their radii are bonded or clash. One line for all pairs,
// with the deepest overlap.
void warn_of_clashes(const Molecule& molecule, const std::vector<Interface>& pairs, double probe,
                     Report& report) {
  const Interface* deepest = nullptr;
  std::uint64_t count = 0;
  for (const Interface& pair : pairs) {
    if (pair.atoms.empty()) continue;
    const double sum =
        molecule.atoms[pair.deepest_a].radius + molecule.atoms[pair.deepest_b].radius;
    if (pair.overlap - 2 * probe <= sum / 2) continue;
    ++count;
    if (deepest == nullptr || pair.overlap > deepest->overlap) deepest = &pair;
  }
  if (deepest == nullptr) return;
  const SphereId a = deepest->deepest_a, b = deepest->deepest_b;
  report.warn_if(true,
                 "{} {} with atoms that clash or are bonded: {} {} and {} {} overlap by {:.2f} Å",
                 count, count == 1 ? "interface" : "interfaces", residue_name(molecule, a),
                 molecule.atoms[a].name.view(), residue_name(molecule, b),
                 molecule.atoms[b].name.view(), deepest->overlap - 2 * probe);
}

InterfaceReport report_of(const Structure& structure, const Sides& sides, const Interfaces& found,
                          const Interface& pair) {
  const Molecule& molecule = structure.molecule;
  return {.a = sides.names[static_cast<std::size_t>(pair.a)],
          .b = sides.names[static_cast<std::size_t>(pair.b)],
          .buried_area = pair.buried_area(),
          .contact_area = pair.contact_area,
          .side_a = side_of(molecule, sides.of_atom, pair.a, found, pair),
          .side_b = side_of(molecule, sides.of_atom, pair.b, found, pair),
          .buried_by_polarity = buried_by_polarity(molecule, pair),
          .contacts = residue_contacts(molecule, pair),
          .complementarity = {},
          .excluded = {}};
}

SphereSet atoms_of_side(const Molecule& molecule, const Sides& sides, std::int32_t side) {
  std::vector<Sphere> atoms;
  for (std::size_t i = 0; i < molecule.atoms.size(); ++i)
    if (sides.of_atom[i] == side)
      atoms.push_back({molecule.atoms[i].position, molecule.atoms[i].radius});
  return SphereSet(std::move(atoms));
}

Complementarity fit_of(const Molecule& molecule, const Sides& sides, const Interface& pair,
                       const InputOptions& input, const DistanceChoice& fit,
                       const Session& session) {
  ComplementarityOptions options;
  options.probe = input.probe;
  options.density = fit.samples_per_area;
  options.most_density = std::max(options.most_density, 2 * fit.samples_per_area);
  options.seed = fit.seed;
  options.monitor = session.monitor;
  return complementarity(atoms_of_side(molecule, sides, pair.a),
                         atoms_of_side(molecule, sides, pair.b), options);
}

// Measures each side once, when its first pair comes.
class SideSurfaces {
 public:
  SideSurfaces(const Molecule& molecule, const Sides& sides, double probe, Monitor* monitor)
      : molecule_(molecule), sides_(sides), probe_(probe), monitor_(monitor) {}

  ExcludedBurial burial(const Interface& pair) {
    std::vector<Sphere> both;
    for (const std::int32_t side : {pair.a, pair.b}) {
      const SphereSet atoms = atoms_of_side(molecule_, sides_, side);
      both.insert(both.end(), atoms.spheres().begin(), atoms.spheres().end());
      if (!alone_.contains(side)) alone_[side] = surface_of_side(atoms, probe_, monitor_);
    }
    return excluded_burial(alone_[pair.a], alone_[pair.b],
                           surface_of_side(SphereSet(std::move(both)), probe_, monitor_));
  }

 private:
  const Molecule& molecule_;
  const Sides& sides_;
  double probe_;
  Monitor* monitor_;
  std::map<std::int32_t, ExcludedSurface> alone_;
};

}  // namespace

Sides chains_of(const Molecule& molecule) {
  Sides sides;
  std::map<ChainKey, std::int32_t> known;
  for (const Atom& atom : molecule.atoms) {
    const auto next = static_cast<std::int32_t>(sides.names.size());
    const std::int32_t side = known.try_emplace(chain_of(atom), next).first->second;
    if (side == next) sides.names.push_back(chain_name(atom, molecule.model == "all"));
    sides.of_atom.push_back(side);
  }
  return sides;
}

Sides sides_of(const Molecule& molecule, const std::vector<std::string>& selections) {
  Sides sides = selections.empty() ? chains_of(molecule) : Sides{selections, {}};
  if (!selections.empty())
    for (const Atom& atom : molecule.atoms) sides.of_atom.push_back(atom.group);
  refuse_if(sides.names.size() < 2,
            "{}: has one chain, {}, and so no interface; name two sides, such as A/1-50 A/51-99",
            molecule.path, sides.names.front());
  return sides;
}

Interfaces measure_interfaces(const Structure& structure, const Sides& sides,
                              const InputOptions& input, const InterfaceChoice& choice,
                              Session& session) {
  Interfaces found = interfaces(structure.spheres, sides.of_atom, session.monitor);
  if (!input.read.groups.empty()) add_pairs_apart(found);
  std::vector<InterfaceReport>& reports = session.report.interfaces.emplace();
  SideSurfaces surfaces(structure.molecule, sides, input.probe, session.monitor);
  for (const Interface& pair : found.pairs) {
    reports.push_back(report_of(structure, sides, found, pair));
    InterfaceReport& report = reports.back();
    if (choice.fit.distances == Switch::on)
      report.complementarity = fit_of(structure.molecule, sides, pair, input, choice.fit, session);
    if (choice.surface == ExactSurface::excluded) report.excluded = surfaces.burial(pair);
  }
  warn_of_clashes(structure.molecule, found.pairs, input.probe, session.report);
  if (found.pairs.empty()) session.report.notes.emplace_back("no two chains touch");
  session.end_stage(&Timing::exact);
  return found;
}

AtomColumns interface_figures(const Interfaces& found, InterfaceFigure first) {
  std::vector<double> buried(found.alone.size()), contact(found.alone.size());
  for (const Interface& pair : found.pairs) {
    for (const InterfaceAtom& atom : pair.atoms)
      buried[atom.sphere] += std::max(atom.buried(), 0.0);
    for (const auto& [a, b, area] : pair.contacts) contact[a] += area, contact[b] += area;
  }
  AtomColumns columns{{name_of(InterfaceFigure::buried), std::move(buried)},
                      {name_of(InterfaceFigure::contact), std::move(contact)},
                      {name_of(InterfaceFigure::area), found.alone}};
  std::swap(columns.front(), columns[static_cast<std::size_t>(first)]);
  return columns;
}

}  // namespace vdwmesh::apps
