#include "structure/choose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <gemmi/assembly.hpp>
#include <gemmi/polyheur.hpp>
#include <gemmi/select.hpp>
#include <memory>
#include <set>
#include <string_view>
#include <utility>

#include "core/errors.hpp"
#include "core/large_pages.hpp"
#include "structure/lines.hpp"
#include "structure/site.hpp"

namespace vdwmesh {
namespace {

constexpr std::array<std::string_view, 4> kAlwaysWater{"HOH", "DOD", "WAT", "H2O"};
// Of simulation programs; also names of other things, so their atoms must be those of a water.
constexpr std::array<std::string_view, 15> kSolvent{"SOL",  "TIP", "TIP2", "TIP3", "TIP4",
                                                    "TIP5", "TP3", "TP4",  "TP5",  "T3P",
                                                    "T4P",  "SPC", "SPCE", "TP3M", "OH2"};

template <class Names>
bool listed(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_water(const gemmi::Residue& residue) {
  std::string name = residue.name;
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  if (listed(kAlwaysWater, name)) return true;
  if (!listed(kSolvent, name)) return false;
  std::set<std::string> oxygens;  // by name: alternate locations repeat them
  for (const gemmi::Atom& atom : residue.atoms) {
    if (atom.element == gemmi::El::O)
      oxygens.insert(atom.name);
    else if (!atom.is_hydrogen() && atom.element != gemmi::El::X)
      return false;
  }
  return oxygens.size() <= 1;
}

std::string name_of(const Site& site, const AtomRecord& record) {
  std::string chain = site.chain->name.empty() ? "" : " of chain " + site.chain->name;
  return fmt::format("atom {} of residue {} {}{} (serial {}, {} {})", site.atom->name,
                     site.residue->name, site.residue->seqid.str(), chain, record.serial,
                     record.line == 0 ? "number" : "line", record.line);
}

// 0 where the file calls it by something else than a number.
std::int32_t number_of(const gemmi::Model& model) {
  const std::int64_t number = whole_number(model.name).value_or(0);
  return std::in_range<std::int32_t>(number) ? static_cast<std::int32_t>(number) : 0;
}

class Choice {
 public:
  Choice(const ParsedFile& file, const ReadOptions& options) : file_(file), options_(options) {
    molecule_.path = file.path;
    molecule_.format = file.format;
    molecule_.assembly = options.assembly;
    molecule_.warnings = file.warnings;
  }

  Molecule run(const RadiusTable& table) {
    choose_models();
    drop_by_kind();
    choose_alternate_locations(sites_, options_.altloc, file_.path, molecule_.skipped);
    select();
    refuse_if_empty();
    assign_radii(table);
    drop("zero_radius", [](const Site& site) { return site.radius == 0; });
    refuse_if_empty();
    if (options_.assembly == "asymmetric")
      take_asymmetric();
    else
      take_assembly();
    return std::move(molecule_);
  }

 private:
  template <class Predicate>
  void drop(const char* reason, Predicate predicate) {
    const std::size_t dropped = std::erase_if(sites_, predicate);
    if (dropped != 0) molecule_.skipped[reason] += dropped;
  }

  bool is_chosen(std::size_t index) const {
    if (options_.model == "all") return true;
    if (options_.model == "first") return index == 0;
    const std::string& name = file_.structure->models[index].name;
    const auto wanted = whole_number(options_.model);
    return name == options_.model || (wanted && wanted == whole_number(name));
  }

  void choose_models() {
    const std::vector<gemmi::Model>& models = file_.structure->models;
    sites_.reserve(file_.atoms.size());
    for (std::size_t i = 0; i < models.size(); ++i) {
      std::uint64_t count = 0;
      const bool chosen = is_chosen(i);
      if (chosen) molecule_.model = options_.model == "all" ? "all" : models[i].name;
      for (const gemmi::Chain& chain : models[i].chains)
        for (const gemmi::Residue& residue : chain.residues) {
          count += residue.atoms.size();
          if (!chosen) continue;
          for (const gemmi::Atom& atom : residue.atoms)
            sites_.push_back({&models[i], &chain, &residue, &atom});
        }
      molecule_.atoms_read += count;
      if (!chosen && count != 0) molecule_.skipped["other_models"] += count;
    }
    if (molecule_.model.empty())
      throw InvalidInput(
          fmt::format("{}: has no model {}; it has {}", file_.path, options_.model, model_names()));
  }

  std::string model_names() const {
    const std::vector<gemmi::Model>& models = file_.structure->models;
    if (models.size() == 1) return models[0].name;
    return fmt::format("{} models, {} to {}", models.size(), models.front().name,
                       models.back().name);
  }

  void drop_by_kind() {
    if (options_.waters == Inclusion::drop) {
      const gemmi::Residue* seen = nullptr;
      bool water = false;
      drop("waters", [&](const Site& site) {
        if (site.residue != seen) water = is_water(*(seen = site.residue));
        return water;
      });
    }
    if (options_.hydrogens == Inclusion::drop)
      drop("hydrogens", [](const Site& site) { return site.atom->is_hydrogen(); });
    if (options_.hetero_atoms == Inclusion::drop)
      drop("hetatm", [this](const Site& site) { return record(site).hetero; });
  }

  void select() {
    if (options_.select.empty()) return;
    gemmi::Selection selection;
    try {
      selection = gemmi::Selection(options_.select);
    } catch (const std::exception& error) {
      throw InvalidInput(
          fmt::format("selection {} is not understood ({}); for example A/10-40/CA "
                      "or /1/A,B",
                      in_quotes(options_.select), one_line(error.what())));
    }
    if (!selection.entity_types.all) gemmi::setup_entities(*file_.structure);
    drop("not_selected", [&](const Site& site) {
      return !selection.matches(*site.model) || !selection.matches(*site.chain) ||
             !selection.matches(*site.residue) || !selection.matches(*site.atom);
    });
  }

  void refuse_if_empty() const {
    if (!sites_.empty()) return;
    std::string reasons;
    for (const auto& [reason, count] : molecule_.skipped)
      reasons += fmt::format("{}{} {}", reasons.empty() ? "" : ", ", count, reason);
    throw InvalidInput(
        fmt::format("{}: none of its {} atoms is left to mesh (dropped: {}); change "
                    "the options that dropped them",
                    file_.path, molecule_.atoms_read, reasons));
  }

  void assign_radii(const RadiusTable& table) {
    std::map<std::string, AssumedRadius> assumed;
    for (Site& site : sites_) {
      if (file_.own_radii) {
        site.radius = record(site).radius;
        continue;
      }
      const char* element = site.atom->element.name();
      const auto entry = table.find(site.residue->name, site.atom->name, element);
      if (!entry) refuse_radius(site);
      site.radius = entry->radius;
      if (entry->assumed)
        ++assumed.try_emplace(element, AssumedRadius{element, entry->radius, 0})
              .first->second.count;
    }
    for (auto& [element, radius] : assumed) molecule_.radii_assumed.push_back(radius);
    molecule_.radius_set = file_.own_radii ? "file" : options_.radii;
  }

  [[noreturn]] void refuse_radius(const Site& site) const {
    const std::string name = name_of(site, record(site));
    if (site.atom->element == gemmi::El::X)
      throw InvalidInput(
          fmt::format("{}: the element of {} cannot be told; give --radii FILE with "
                      "a line '{} {} RADIUS'",
                      file_.path, name, site.residue->name, site.atom->name));
    throw InvalidInput(fmt::format(
        "{}: the radius set {} has no radius for element {} of {}; give "
        "--radii FILE with a line '{} RADIUS'",
        file_.path, options_.radii, site.atom->element.name(), name, site.atom->element.name()));
  }

  const AtomRecord& record(const Site& site) const {
    return file_.atoms[static_cast<std::size_t>(site.atom->serial)];
  }

  void take(const gemmi::Model& model, const gemmi::Chain& chain, const gemmi::Residue& residue,
            const gemmi::Atom& atom, double radius) {
    const AtomRecord& record = file_.atoms[static_cast<std::size_t>(atom.serial)];
    if (&residue != numbered_) {
      numbered_ = &residue;
      residue_number_ = residue.seqid.num ? residue.seqid.str() : std::string();
    }
    Atom& taken = molecule_.atoms.emplace_back();
    taken.position = {atom.pos.x, atom.pos.y, atom.pos.z};
    taken.radius = radius;
    taken.element = atom.element.name();
    taken.name = atom.name;
    taken.residue_name = residue.name;
    taken.chain = chain.name;
    taken.residue_number = residue_number_;
    taken.serial = record.serial;
    taken.model = number_of(model);
    taken.hetero = record.hetero;
  }

  void take_asymmetric() {
    // gemmi gathers the atoms of a residue; the file may interleave them.
    const auto in_order = [](const Site& a, const Site& b) {
      return a.atom->serial < b.atom->serial;
    };
    if (!std::is_sorted(sites_.begin(), sites_.end(), in_order))
      std::stable_sort(sites_.begin(), sites_.end(), in_order);
    molecule_.atoms.reserve(sites_.size());
    advise_large_pages(molecule_.atoms.data(), sites_.size());
    for (const Site& site : sites_)
      take(*site.model, *site.chain, *site.residue, *site.atom, site.radius);
    molecule_.atoms_used = sites_.size();
  }

  const gemmi::Assembly& assembly() const {
    const gemmi::Structure& structure = *file_.structure;
    for (const gemmi::Assembly& assembly : structure.assemblies)
      if (assembly.name == options_.assembly) return assembly;
    std::string names;
    for (const gemmi::Assembly& assembly : structure.assemblies) names += " " + assembly.name;
    throw InvalidInput(fmt::format("{}: has no assembly {}; there is asymmetric{}{}", file_.path,
                                   options_.assembly, names.empty() ? " only" : " and", names));
  }

  void take_assembly() {
    const gemmi::Assembly& wanted = assembly();
    std::vector<double> radius_of(file_.atoms.size());
    std::set<int> used;
    for (auto first = sites_.begin(); first != sites_.end();) {
      const auto last = std::find_if(
          first, sites_.end(), [first](const Site& site) { return site.model != first->model; });
      for (auto site = first; site != last; ++site)
        radius_of[static_cast<std::size_t>(site->atom->serial)] = site->radius;
      const gemmi::Model copies = gemmi::make_assembly(
          wanted, chosen_part(first, last), gemmi::HowToNameCopiedChain::AddNumber, nullptr);
      numbered_ = nullptr;  // these residues may be where others were
      for (const gemmi::Chain& chain : copies.chains)
        for (const gemmi::Residue& residue : chain.residues)
          for (const gemmi::Atom& atom : residue.atoms) {
            used.insert(atom.serial);
            take(copies, chain, residue, atom, radius_of[static_cast<std::size_t>(atom.serial)]);
          }
      first = last;
    }
    drop("not_in_assembly", [&](const Site& site) { return used.count(site.atom->serial) == 0; });
    refuse_if_empty();
    molecule_.atoms_used = sites_.size();
  }

  // A model of the chosen atoms alone.
  static gemmi::Model chosen_part(Sites::const_iterator first, Sites::const_iterator last) {
    gemmi::Model part(first->model->name);
    const gemmi::Chain* chain = nullptr;
    const gemmi::Residue* residue = nullptr;
    for (; first != last; ++first) {
      if (first->chain != chain) part.chains.emplace_back((chain = first->chain)->name);
      std::vector<gemmi::Residue>& residues = part.chains.back().residues;
      if (first->residue != residue) residues.push_back((residue = first->residue)->empty_copy());
      residues.back().atoms.push_back(*first->atom);
    }
    return part;
  }

  const ParsedFile& file_;
  const ReadOptions& options_;
  Sites sites_;
  Molecule molecule_;
  const gemmi::Residue* numbered_ = nullptr;  // whose number residue_number_ is
  std::string residue_number_;
};

}  // namespace

Molecule choose_atoms(const ParsedFile& file, const ReadOptions& options,
                      const RadiusTable& table) {
  return Choice(file, options).run(table);
}

}  // namespace vdwmesh
