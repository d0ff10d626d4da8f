// Every check looks at the sites once. Thresholds are far from what molecules have, so that a note
// is right where it stands; where it is in doubt there is none.
#include "structure/molecule/account.hpp"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <gemmi/model.hpp>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "structure/molecule/each_residue.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kNamesInAMessage = 8;

std::string kind_as_text(const std::string& residue) {
  switch (kind_of_residue(residue)) {
    case ResidueKind::protein:
      return "protein";
    case ResidueKind::nucleic:
      return "nucleic acid";
    case ResidueKind::water:
      return "water";
    case ResidueKind::other:
      break;
  }
  return residue;
}

std::string list_of(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kNamesInAMessage);
  std::string list = fmt::format(
      "{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  return shown < names.size() ? fmt::format("{} and {} more", list, names.size() - shown) : list;
}

// "CA of ALA A/10".
std::string name_of(const Site& site) {
  const gemmi::Residue& residue = *site.place->residue;
  return fmt::format("{} of {} {}/{}", site.atom->name.view(), residue.name,
                     site.place->chain->name, residue.seqid.num ? residue.seqid.str() : "");
}

// The median, over the first atoms of the file, of the distance to the nearest other atom of their
// residue; 0 if too few atoms have one. In molecules it is the length of a bond, 0.9 to 2.5 Å.
double usual_distance(const Sites& sites) {
  constexpr std::size_t kFew = 8, kEnough = 2000, kLargeResidue = 100;  // atoms
  std::vector<double> distances;
  for_each_residue(sites, [&](std::span<const Site> residue) {
    if (distances.size() >= kEnough || residue.size() > kLargeResidue) return;
    for (const Site& a : residue) {
      double least = 0;
      for (const Site& b : residue) {
        const double d = norm(a.atom->position - b.atom->position);
        if (d > 0 && (least == 0 || d < least)) least = d;
      }
      if (least > 0) distances.push_back(least);
    }
  });
  if (distances.size() < kFew) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

void warn_of_units(const Sites& sites, Molecule& molecule) {
  const double usual = usual_distance(sites);
  const auto is_bond_in = [usual](double unit) { return usual > 0.8 * unit && usual < 2.6 * unit; };
  const auto is_within_cell = [](const Site& site) {
    const Vec3d& p = site.atom->position;
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 2;
  };
  std::string looks;
  if (is_bond_in(0.1))
    looks = "as if in nm; add --units nm";
  else if (is_bond_in(100))
    looks = "as if in pm; add --units pm";
  else if (usual > 0 && usual < 0.08 && std::ranges::all_of(sites, is_within_cell))
    looks =
        "as if these were fractions of a cell, which are read from a CIF with _atom_site_fract_x";
  if (!looks.empty())
    molecule.warnings.push_back(
        fmt::format("atoms of a residue are {:.3g} Å apart, {}", usual, looks));
}

// Selects all but the chain of the atom, or but its residue, or but itself, whichever of these the
// other atom is not in.
std::string selection_without(const Site& atom, const Site& other) {
  const std::string &chain = atom.place->chain->name, residue = atom.place->residue->seqid.str();
  if (chain != other.place->chain->name && !chain.empty())
    return fmt::format("not chain {}", chain);
  const std::string within = chain.empty() ? "" : fmt::format("chain {} and ", chain);
  const std::string name = atom.place == other.place
                               ? fmt::format(" and name {}", atom.atom->name.view())
                               : std::string();
  return fmt::format("not ({}resi {}{})", within, residue, name);
}

void warn_of_common_places(const Sites& sites, const ReadOptions& options, Molecule& molecule) {
  const auto key = [](const Site* site) {
    const Vec3d& p = site->atom->position;
    return std::tuple(p.x, p.y, p.z, site->atom);
  };
  std::vector<const Site*> sorted;
  sorted.reserve(sites.size());
  for (const Site& site : sites) sorted.push_back(&site);
  tbb::parallel_sort(sorted.begin(), sorted.end(),
                     [key](const Site* a, const Site* b) { return key(a) < key(b); });
  std::uint64_t count = 0;
  const Site *first = nullptr, *second = nullptr;  // the first of the file that is not alone
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (!(sorted[i]->atom->position == sorted[i - 1]->atom->position)) continue;
    ++count;
    if (!second || sorted[i]->atom < second->atom) first = sorted[i - 1], second = sorted[i];
  }
  if (count == 0) return;
  std::string remedy = fmt::format("--select '{}'", selection_without(*second, *first));
  if (options.model == "all" && first->place->model != second->place->model)
    remedy = "--model first";
  else if (options.altloc == "all")
    remedy = "--altloc highest";
  molecule.warnings.push_back(
      fmt::format("{} atoms lie where another one does, the first {} with {}; {} leaves such out",
                  count, name_of(*second), name_of(*first), remedy));
}

// One atom of each residue is a trace of the chain, not its surface.
void warn_of_trace(const Sites& sites, Molecule& molecule) {
  constexpr std::size_t kFew = 8;  // residues
  std::size_t residues = 0, single = 0;
  std::string_view of_trace;
  for_each_residue(sites, [&](std::span<const Site> residue) {
    const ResidueKind kind = kind_of_residue(residue.front().place->residue->name);
    if (kind != ResidueKind::protein && kind != ResidueKind::nucleic) return;
    ++residues;
    const std::string_view name = residue.front().atom->name.view();
    if (residue.size() != 1 || (name != "CA" && name != "P")) return;
    ++single;
    of_trace = name;
  });
  if (residues < kFew || single != residues) return;
  molecule.warnings.push_back(fmt::format(
      "each of the {} residues has its {} alone: this is a trace of the chain, and no surface of "
      "its atoms; --radii bondi,FILE with lines RESIDUE ATOM RADIUS makes beads of them",
      residues, of_trace));
}

void note_hydrogens(const Sites& sites, const ReadOptions& options, const RadiusTable& table,
                    Molecule& molecule) {
  constexpr std::size_t kFew = 20;  // atoms
  const auto is_hydrogen = [](const Site& site) { return gemmi::is_hydrogen(site.atom->element); };
  if (!table.is_by_element() || options.hydrogens == Inclusion::drop ||
      std::ranges::any_of(sites, is_hydrogen))
    return;
  std::size_t of_protein = 0;
  for_each_residue(sites, [&](std::span<const Site> residue) {
    if (kind_of_residue(residue.front().place->residue->name) == ResidueKind::protein)
      of_protein += residue.size();
  });
  if (of_protein < kFew) return;
  molecule.notes.push_back(fmt::format(
      "there are no hydrogens, and {} has the radii of atoms without theirs; --radii protor has "
      "radii that include them",
      radii_or_default(options)));
}

void note_hetero_atoms(const Sites& sites, Molecule& molecule) {
  std::map<std::string, std::uint64_t> counts;
  std::size_t hetero = 0;
  for_each_residue(sites, [&](std::span<const Site> residue) {
    const std::string& name = residue.front().place->residue->name;
    if (!residue.front().atom->hetero) return;
    hetero += residue.size();
    if (kind_of_residue(name) == ResidueKind::other) counts[name] += residue.size();
  });
  if (counts.empty() || hetero == sites.size()) return;
  std::vector<std::string> parts;
  for (const auto& [name, count] : counts) parts.push_back(fmt::format("{} of {}", count, name));
  molecule.notes.push_back(
      fmt::format("hetero atoms are kept: {}; --no-hetatm leaves them out", list_of(parts)));
}

void note_models(const ParsedFile& file, const ReadOptions& options, Molecule& molecule) {
  const std::size_t models = file.structure->models.size();
  if (models < 2 || options.model != "first") return;
  molecule.notes.push_back(
      fmt::format("the first of {} models is taken; --model 2 takes another one", models));
}

}  // namespace

std::vector<KeptAtoms> kept_by_kind(const Sites& sites) {
  std::vector<KeptAtoms> kept;
  std::map<std::string, std::size_t> places;
  bool has_names = true;
  for_each_residue(sites, [&](std::span<const Site> residue) {
    const std::string kind = kind_as_text(residue.front().place->residue->name);
    has_names = has_names && !kind.empty();
    const std::size_t place = places.try_emplace(kind, kept.size()).first->second;
    if (place == kept.size()) kept.push_back({kind, 0});
    kept[place].atoms += residue.size();
  });
  return has_names ? kept : std::vector<KeptAtoms>();
}

std::string names_of_what_is_there(const Sites& sites) {
  std::vector<std::string> chains;
  std::set<std::string> others;
  const gemmi::Chain* chain = nullptr;
  std::string first_number, last_number;
  const auto end_chain = [&] {
    if (!chain || first_number.empty()) return;
    const bool is_one = first_number == last_number;
    chains.push_back(fmt::format("{} ({}{}{})", chain->name, first_number, is_one ? "" : "-",
                                 is_one ? "" : last_number));
  };
  for_each_residue(sites, [&](std::span<const Site> residue) {
    const ResiduePlace& place = *residue.front().place;
    if (place.chain != chain) {
      end_chain();
      chain = place.chain;
      first_number.clear();
    }
    const ResidueKind kind = kind_of_residue(place.residue->name);
    if (kind == ResidueKind::other) others.insert(place.residue->name);
    if (!place.residue->seqid.num || kind == ResidueKind::other || kind == ResidueKind::water)
      return;
    last_number = place.residue->seqid.str();
    if (first_number.empty()) first_number = last_number;
  });
  end_chain();
  std::string text;
  if (!chains.empty()) text = fmt::format("chains {}", list_of(chains));
  if (!others.empty())
    text += fmt::format("{}residues {}", text.empty() ? "" : "; ",
                        list_of({others.begin(), others.end()}));
  return text;
}

std::string note_of_guesses(const Molecule& molecule) {
  std::vector<std::string> unusual;
  for (const GuessedElement& guess : molecule.unusual_elements_guessed)
    unusual.push_back(fmt::format("{} (atom {} of {}, {}x)", guess.element, guess.atom_name,
                                  guess.residue_name, guess.count));
  return fmt::format(
      "the file does not give the elements of {} atoms: they were told from the names of atoms and "
      "residues; other than H, C, N, O, P and S: {}",
      molecule.elements_guessed, unusual.empty() ? "none" : list_of(unusual));
}

void note_what_looks_odd(const Sites& sites, const ParsedFile& file, const ReadOptions& options,
                         const RadiusTable& table, Molecule& molecule) {
  note_models(file, options, molecule);
  if (file.own_radii || file.coarse_grained) return;
  warn_of_units(sites, molecule);
  warn_of_common_places(sites, options, molecule);
  warn_of_trace(sites, molecule);
  note_hydrogens(sites, options, table, molecule);
  note_hetero_atoms(sites, molecule);
}

}  // namespace vdwmesh
