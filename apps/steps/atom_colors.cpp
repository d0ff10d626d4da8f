// Colours of chains are Okabe and Ito's, which most eyes tell apart, then turns of the wheel of
// hues; those of kinds of residues are the ones of the page of `view`.
#include "steps/atom_colors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "batch/molecule_spheres.hpp"
#include "measures/exact_union.hpp"
#include "mesh/element_color.hpp"
#include "report/per_atom.hpp"
#include "request/refuse.hpp"
#include "structure/reference_areas.hpp"
#include "structure/residue_classes.hpp"

namespace vdwmesh::apps {
namespace {

using Bytes = std::array<std::uint8_t, 3>;

constexpr Bytes kChains[] = {{86, 180, 233}, {230, 159, 0}, {0, 158, 115}, {204, 121, 167},
                             {240, 228, 66}, {0, 114, 178}, {213, 94, 0}};

struct KindOfResidue {
  std::string_view name;
  Bytes color;
};
// In the order of ResidueClass.
constexpr std::array<KindOfResidue, kResidueClasses> kKinds{{{"hydrophobic", {225, 170, 80}},
                                                             {"polar", {110, 190, 120}},
                                                             {"acidic", {214, 75, 75}},
                                                             {"basic", {80, 120, 220}},
                                                             {"nucleotide", {150, 110, 200}},
                                                             {"other", {160, 160, 160}}}};

Rgb rgb(const Bytes& c) {
  constexpr float kMost = 255;
  return {static_cast<float>(c[0]) / kMost, static_cast<float>(c[1]) / kMost,
          static_cast<float>(c[2]) / kMost};
}

// Hues are golden sections of the wheel apart, so none comes again.
Bytes color_of_chain(std::size_t i) {
  if (i < std::size(kChains)) return kChains[i];
  constexpr double kGoldenSection = 0.618034, kLeast = 100, kSpan = 120;
  const double hue = std::fmod(static_cast<double>(i) * kGoldenSection, 1);
  Bytes color{};
  for (std::size_t k = 0; k < color.size(); ++k) {
    const double away = std::abs(std::remainder(hue - static_cast<double>(k) / 3, 1));
    color[k] = static_cast<std::uint8_t>(kLeast + kSpan * std::clamp(2 - 6 * away, 0.0, 1.0));
  }
  return color;
}

// "A #56b4e9" for the first dozen.
std::string key_of(const std::vector<std::pair<std::string, Bytes>>& entries) {
  constexpr std::size_t kMost = 12;
  std::string key;
  for (std::size_t i = 0; i < std::min(entries.size(), kMost); ++i) {
    const auto& [name, c] = entries[i];
    key += fmt::format("{}{} #{:02x}{:02x}{:02x}", i > 0 ? ", " : "", name, c[0], c[1], c[2]);
  }
  if (entries.size() > kMost) key += fmt::format(" and {} more", entries.size() - kMost);
  return key;
}

}  // namespace

AtomColors colors_of_elements(const Molecule& molecule) {
  AtomColors found;
  for (const Atom& atom : molecule.atoms) {
    const auto c = element_color(atom.element);
    found.colors.push_back(rgb({c[0], c[1], c[2]}));
  }
  return found;
}

AtomColors colors_of_chains(const Molecule& molecule) {
  AtomColors found;
  std::vector<std::pair<std::string, Bytes>> chains;
  for (const Atom& atom : molecule.atoms) {
    const std::string name = atom.chain.empty() ? "(no chain)" : std::string(atom.chain);
    auto chain = std::ranges::find(chains, name, &std::pair<std::string, Bytes>::first);
    if (chain == chains.end()) chain = chains.insert(chain, {name, color_of_chain(chains.size())});
    found.colors.push_back(rgb(chain->second));
  }
  found.key = key_of(chains);
  return found;
}

AtomColors colors_of_residues(const Molecule& molecule) {
  AtomColors found;
  std::array<bool, kResidueClasses> seen{};
  for (const Atom& atom : molecule.atoms) {
    const auto kind = static_cast<std::size_t>(residue_class(atom.residue_name));
    seen.at(kind) = true;
    found.colors.push_back(rgb(kKinds.at(kind).color));
  }
  std::vector<std::pair<std::string, Bytes>> entries;
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    if (seen.at(k)) entries.emplace_back(kKinds.at(k).name, kKinds.at(k).color);
  found.key = key_of(entries);
  return found;
}

std::vector<float> atom_hydropathies(const Molecule& molecule) {
  std::vector<float> found;
  for (const Atom& atom : molecule.atoms)
    found.push_back(static_cast<float>(hydropathy(atom.residue_name).value_or(std::nan(""))));
  return found;
}

std::vector<float> atom_exposures(const Molecule& molecule, Monitor* monitor) {
  UnionOptions options;
  options.method = UnionMethod::arcs;
  options.topology = TopologyRequest::none;
  options.monitor = monitor;
  const ExactUnion exact = exact_union(to_spheres(molecule, kReferenceProbe), options);
  const std::vector<double> found =
      residue_exposure({molecule, kReferenceProbe, exact, {}, AtomGroup::residue});
  return {found.begin(), found.end()};
}

std::vector<float> atom_b_factors(const Molecule& molecule) {
  constexpr std::string_view kWith[] = {"pdb", "mmcif", "bcif"};
  refuse_if(std::ranges::count(kWith, molecule.format) == 0,
            "--color b-factor: {} is a file of kind {}, which has none; name a PDB or mmCIF file",
            molecule.path, molecule.format);
  std::vector<float> found;
  for (const Atom& atom : molecule.atoms) found.push_back(atom.b_factor);
  return found;
}

}  // namespace vdwmesh::apps
