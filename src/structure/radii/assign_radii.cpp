// Looks every atom up in the radius table and counts what the table says about the match: radii
// assumed from another set, by element or by atom, and residues that stand in it by another name.
#include "structure/radii/assign_radii.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <gemmi/model.hpp>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "core/errors.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

// Describes an atom for a message.
std::string name_of(const Site& site, const ParsedFile& file) {
  const AtomRecord& record = *site.atom;
  const bool has_rows = file.format.ends_with("cif");
  std::string chain = site.place->chain->name.empty() ? "" : " of chain " + site.place->chain->name;
  return fmt::format("atom {} of residue {} {}{} (serial {}, {} {}{})", site.atom->name.view(),
                     site.place->residue->name, site.place->residue->seqid.str(), chain,
                     record.serial, has_rows ? "row" : "line", record.line,
                     has_rows ? " of _atom_site" : "");
}

// How to call the radii with one more file. A file alone replaces the sets, and a set may complete
// it.
std::string completed(const std::string& radii) {
  const std::string first = RadiusTable::parts_of(radii).front();
  const std::vector<std::string>& sets = RadiusTable::names();
  const bool has_set = std::find(sets.begin(), sets.end(), first) != sets.end();
  return has_set ? radii + ",FILE" : "bondi," + radii;
}

[[noreturn]] void refuse_radius(const Site& site, const ParsedFile& file,
                                const std::string& radius_set) {
  const std::string name = name_of(site, file), radii = completed(radius_set),
                    symbol = gemmi::element_name(site.atom->element),
                    line = fmt::format("'{} {} RADIUS'", site.place->residue->name,
                                       site.atom->name.view());
  if (file.coarse_grained && symbol == "X")
    throw InvalidInput(
        fmt::format("{}: {} is a bead of a coarse-grained (Martini) model, which stands for "
                    "several atoms and has no element; give --radii FILE with a line 'X RADIUS' "
                    "for all beads, or {}",
                    file.path, name, line));
  if (symbol == "X")
    throw InvalidInput(
        fmt::format("{}: the element of {} cannot be told; give --radii {} with a line {} in the "
                    "file, or leave such atoms out by --select '[!X]'",
                    file.path, name, radii, line));
  throw InvalidInput(
      fmt::format("{}: the radius set {} has no radius for element {} of {}; give --radii {}{}",
                  file.path, radius_set, symbol, name, radii,
                  radii.ends_with(",FILE")
                      ? fmt::format(" with a line '{} RADIUS' in the file", symbol)
                      : fmt::format(", which completes the file by a set, or add a line '{} "
                                    "RADIUS' to it",
                                    symbol)));
}

// What was assumed, by element; of united atoms also by residue and atom.
class RadiusAccount {
 public:
  explicit RadiusAccount(bool by_atom) : by_atom_(by_atom) {}

  void add(const Site& site, const AtomRadius& entry) {
    if (entry.renamed) ++renamed_[site.place->residue->name];
    if (entry.line != AtomRadius::kNoLine) lines_.insert(entry.line);
    if (!entry.assumed) return;
    const std::string residue = by_atom_ ? site.place->residue->name : "",
                      atom(by_atom_ ? site.atom->name.view() : std::string_view()),
                      element = gemmi::element_name(site.atom->element);
    const AssumedRadius first{element, entry.radius, 0, residue, atom};
    ++assumed_.try_emplace({residue, atom, element}, first).first->second.count;
  }

  void write_to(Molecule& molecule, const std::vector<std::string>& lines) const {
    for (const auto& [key, radius] : assumed_) molecule.radii_assumed.push_back(radius);
    note_unused(molecule, lines);
    if (renamed_.empty()) return;
    std::string names;
    for (const auto& [residue, count] : renamed_)
      names += fmt::format("{}{} ({}x)", names.empty() ? "" : ", ", residue, count);
    molecule.notes.push_back(
        fmt::format("the radius set {} has atoms of these residues by other names, those of the "
                    "standard residue in the PDB: {}",
                    molecule.radius_set, names));
  }

 private:
  // A misspelt name would go unnoticed: its line changes nothing.
  void note_unused(Molecule& molecule, const std::vector<std::string>& lines) const {
    constexpr std::size_t kMostNamed = 8;
    const std::size_t unused = lines.size() - lines_.size();
    if (unused == 0) return;
    std::string names;
    std::size_t named = 0;
    for (int i = 0; named < std::min(unused, kMostNamed); ++i) {
      if (lines_.contains(i)) continue;
      names += (named++ == 0 ? "" : ", ") + lines[static_cast<std::size_t>(i)];
    }
    if (unused > named) names += fmt::format(" and {} more", unused - named);
    molecule.notes.push_back(
        fmt::format("lines of radius files that no atom in use takes its radius from: {}", names));
  }

  bool by_atom_;
  std::set<int> lines_;  // that atoms take their radii from
  std::map<std::tuple<std::string, std::string, std::string>, AssumedRadius> assumed_;
  std::map<std::string, std::uint64_t> renamed_;  // residue name -> atoms
};

}  // namespace

void assign_radii(Sites& sites, const ParsedFile& file, const RadiusTable& table,
                  Molecule& molecule) {
  RadiusAccount account(table.has_united_atoms());
  // What a table knows by the element alone is looked up once for each element.
  std::array<std::optional<AtomRadius>, static_cast<std::size_t>(gemmi::El::END)> found;
  for (const Site& site : sites) {
    const gemmi::El element = site.atom->element;
    std::optional<AtomRadius>& entry = found[static_cast<std::size_t>(element)];
    if (!table.is_by_element() || !entry)
      entry = table.find(site.place->residue->name, site.atom->name, gemmi::element_name(element));
    if (!entry) refuse_radius(site, file, molecule.radius_set);
    site.atom->radius = entry->radius;
    site.atom->polarity = entry->polarity;
    account.add(site, *entry);
  }
  account.write_to(molecule, table.lines());
  molecule.has_polarity = table.has_united_atoms();
}

}  // namespace vdwmesh
