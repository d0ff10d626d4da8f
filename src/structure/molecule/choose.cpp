// Choice::run() goes through the options one after the other, on one list of sites. A site is an
// atom of the file with its residue, chain and model (site.hpp). Each step erases sites and counts
// them under its reason. The sites that are left get radii and become the atoms of the Molecule,
// once each. For an assembly, its copies are listed (assembly_copies.hpp); expanded() makes them.
#include "structure/molecule/choose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <gemmi/model.hpp>
#include <map>
#include <set>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/errors.hpp"
#include "core/letters.hpp"
#include "structure/molecule/account.hpp"
#include "structure/molecule/assembly_copies.hpp"
#include "structure/molecule/residue_elements.hpp"
#include "structure/molecule/site.hpp"
#include "structure/molecule/site_selection.hpp"
#include "structure/radii/assign_radii.hpp"
#include "structure/read/hierarchy.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

// Elements that are too common to be listed in a note when they were derived from names.
constexpr std::array<std::string_view, 7> kOrganicElements{"H", "D", "C", "N", "O", "P", "S"};

// A residue is a water by a name of the PDB alone. With a name that programs or beads have it is a
// water if it has at most one oxygen, and beside that only hydrogens and atoms without an element
// (virtual sites, beads). `sites` are all of its atoms.
bool is_water(const gemmi::Residue& residue, std::span<const Site> sites) {
  const WaterName name = water_name(upper_case(residue.name));
  if (name == WaterName::of_the_pdb) return true;
  if (name != WaterName::of_a_program && name != WaterName::of_a_bead) return false;
  std::set<std::string_view> oxygens;  // names, because alternate locations repeat an atom
  for (const Site& site : sites) {
    const gemmi::El element = site.atom->element;
    if (element == gemmi::El::O)
      oxygens.insert(site.atom->name);
    else if (!gemmi::is_hydrogen(element) && element != gemmi::El::X)
      return false;
  }
  return oxygens.size() <= 1;
}

using ElementSymbols = std::array<ShortText, static_cast<std::size_t>(gemmi::El::END)>;

// The symbols of all elements.
ElementSymbols element_symbols() {
  ElementSymbols symbols;
  for (std::size_t i = 0; i < symbols.size(); ++i)
    symbols[i] = gemmi::element_name(static_cast<gemmi::El>(i));
  return symbols;
}

// The model's name as a number; 0 if the name is no integer of 32 bits.
std::int32_t model_number(const gemmi::Model& model) {
  const std::int64_t number = whole_number(model.name).value_or(0);
  return std::in_range<std::int32_t>(number) ? static_cast<std::int32_t>(number) : 0;
}

// One call of choose_atoms(). sites_ holds the atoms that no step has dropped.
class Choice {
 public:
  Choice(ParsedFile& file, const ReadOptions& options)
      : file_(file),
        options_(options),
        places_(numbered_residues(*file.structure)),
        residue_numbers_(residue_numbers(file, places_)) {
    molecule_.path = file.path;
    molecule_.format = file.format;
    molecule_.assembly = options.assembly;
  }

  UnexpandedMolecule run(const RadiusTable& table) {
    choose_models();
    drop_by_kind(table);
    if (file_.has_labels || options_.altloc != "highest")
      choose_alternate_locations(sites_, options_.altloc, molecule_);
    select();
    refuse_if_empty();
    take_radii(table);
    drop("zero_radius", [](const Site& site) { return site.atom->radius == 0; });
    refuse_if_empty();
    mark_measured();
    mark_groups();
    molecule_.warnings.insert(molecule_.warnings.begin(), file_.warnings.begin(),
                              file_.warnings.end());
    molecule_.notes.insert(molecule_.notes.begin(), file_.notes.begin(), file_.notes.end());
    if (options_.assembly == "asymmetric")
      take_asymmetric();
    else
      take_assembly();
    refuse_if_none_measured();
    molecule_.kept = kept_by_kind(sites_);
    note_what_looks_odd(sites_, file_, options_, table, molecule_);
    count_guesses();
    return {std::move(molecule_), std::move(copies_)};
  }

 private:
  // Erases the sites for which the predicate is true, and counts them under `reason`. The predicate
  // is called once for each site, in order.
  template <class Predicate>
  void drop(const char* reason, Predicate predicate) {
    const std::size_t dropped = std::erase_if(sites_, predicate);
    if (dropped != 0) molecule_.skipped[reason] += dropped;
  }

  // Whether the options ask for this model. Numbers compare as numbers, so "01" finds model 1.
  bool is_chosen(std::size_t index) const {
    if (options_.model == "all") return true;
    if (options_.model == "first") return index == 0;
    const std::string name = model_name(index);
    const auto wanted = whole_number(options_.model);
    return name == options_.model || (wanted && wanted == whole_number(name));
  }

  // Fills sites_ with the atoms of the chosen models, in the order of gemmi's hierarchy.
  void choose_models() {
    const std::vector<gemmi::Model>& models = file_.structure->models;
    std::set<const gemmi::Model*> others;
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (is_chosen(i))
        molecule_.model = options_.model == "all" ? "all" : model_name(i);
      else
        others.insert(&models[i]);
    }
    if (others.size() == models.size())
      throw InvalidInput(
          fmt::format("{}: has no model {}; it has {}", file_.path, options_.model, model_names()));
    sites_ = all_sites(file_, places_);
    molecule_.atoms_read = sites_.size();
    if (!others.empty())
      drop("other_models", [&](const Site& site) { return others.contains(site.place->model); });
  }

  // The name of the model; its number in the file's order, from 1, if it has no name.
  std::string model_name(std::size_t index) const {
    const std::string& name = file_.structure->models[index].name;
    return name.empty() ? std::to_string(index + 1) : name;
  }

  std::string model_names() const {
    const std::size_t count = file_.structure->models.size();
    if (count == 1) return model_name(0);
    return fmt::format("{} models, {} to {}", count, model_name(0), model_name(count - 1));
  }

  // The atoms of a residue stand together, so one test for each residue is enough.
  void drop_waters() {
    auto end = sites_.begin();  // of those that stay
    for (auto first = sites_.begin(); first != sites_.end();) {
      const auto last = std::find_if(
          first, sites_.end(), [first](const Site& site) { return site.place != first->place; });
      if (is_water(*first->place->residue, {first, last})) {
        molecule_.skipped["waters"] += static_cast<std::uint64_t>(last - first);
        first = last;
      } else {
        end = end == first ? last : std::copy(first, last, end);  // dropped none so far, or some
        first = last;
      }
    }
    sites_.erase(end, sites_.end());
  }

  void drop_by_kind(const RadiusTable& table) {
    if (options_.waters == Inclusion::drop) drop_waters();
    drop_virtual_sites();
    drop_hydrogens(table);
    if (options_.hetero_atoms != Inclusion::keep)
      drop("hetatm", [](const Site& site) { return site.atom->hetero; });
  }

  // Virtual sites are no atoms. A note names the first of them.
  void drop_virtual_sites() {
    if (!file_.elements_in_doubt) return;
    const auto is_virtual = [](const Site& site) { return site.atom->is_virtual; };
    const auto first = std::find_if(sites_.begin(), sites_.end(), is_virtual);
    if (first == sites_.end()) return;
    const std::string name(first->atom->name.view()), residue = first->place->residue->name;
    drop("virtual_sites", is_virtual);
    molecule_.notes.push_back(fmt::format(
        "left out: {} virtual sites, lone pairs, dummies or alpha spheres, which are no atoms, the "
        "first {} of {}; one with the symbol of an element counts as an atom",
        molecule_.skipped["virtual_sites"], name, residue));
  }

  void select() {
    if (options_.select.empty()) return;
    const SiteSelection selection(options_.select, file_);
    const auto is_selected = [&](const Site& site) { return selection.contains(site); };
    if (std::ranges::none_of(sites_, is_selected)) refuse_selection(options_.select, sites_);
    drop("not_selected", [&](const Site& site) { return !is_selected(site); });
  }

  // What there is beside a selection that matches nothing: other atoms, and the same in capitals.
  std::string alternatives_to(const std::string& selection, const Sites& sites) const {
    const std::string capitals = upper_case(selection);
    const bool is_small = is_in_words(selection) && capitals != selection &&
                          std::ranges::any_of(sites, test_in_words(capitals));
    const std::string there = names_of_what_is_there(sites);
    return fmt::format("{}{}{}",
                       is_small ? fmt::format("; {} matches some", in_quotes(capitals)) : "",
                       there.empty() ? "" : "; there are " + there,
                       molecule_.skipped.contains("waters") ? "; --waters keeps the waters" : "");
  }

  [[noreturn]] void refuse_selection(const std::string& selection, const Sites& sites) const {
    throw InvalidInput(fmt::format("{}: selection {} matches none of the {} atoms in use{}",
                                   file_.path, in_quotes(selection), sites.size(),
                                   alternatives_to(selection, sites)));
  }

  // Marks the sites that are to be measured. All are if nothing else was asked for.
  void mark_measured() {
    if (options_.measure.empty()) return;
    const SiteSelection selection(options_.measure, file_);
    for (const Site& site : sites_) site.atom->measured = selection.contains(site);
  }

  // A group without atoms is more likely a slip than meant.
  void mark_groups() {
    for (std::size_t g = 0; g < options_.groups.size(); ++g) {
      const SiteSelection selection(options_.groups[g], file_);
      bool is_empty = true;
      for (const Site& site : sites_) {
        if (!selection.contains(site)) continue;
        const std::int32_t other = site.atom->group;
        if (other != kNoGroup && options_.shared_atoms == SharedAtoms::refused)
          throw InvalidInput(
              fmt::format("{}: selections {} and {} share atoms; an atom can be on one side only",
                          file_.path, in_quotes(options_.groups[static_cast<std::size_t>(other)]),
                          in_quotes(options_.groups[g])));
        site.atom->group = static_cast<std::int32_t>(g);
        is_empty = false;
      }
      if (is_empty) refuse_selection(options_.groups[g], sites_);
    }
  }

  // An empty sum would be an area of 0, which is not what a mistyped selection should give.
  void refuse_if_none_measured() const {
    const auto is_measured = [](const Atom& atom) { return atom.measured; };
    if (std::any_of(molecule_.atoms.begin(), molecule_.atoms.end(), is_measured)) return;
    throw InvalidInput(fmt::format(
        "{}: selection {} of the atoms to measure matches none of the {} atoms in use{}",
        file_.path, in_quotes(options_.measure), count_atoms(molecule_, copies_),
        alternatives_to(options_.measure, sites_)));
  }

  // Throws if no atom is left, and lists how many each step dropped.
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

  // The radii of united atoms include the hydrogens, which therefore go without being asked for.
  void drop_hydrogens(const RadiusTable& table) {
    const bool united = table.has_united_atoms() && !file_.own_radii;
    if (options_.hydrogens == Inclusion::keep && !united) return;
    drop("hydrogens", [](const Site& site) { return gemmi::is_hydrogen(site.atom->element); });
    const auto dropped = molecule_.skipped.find("hydrogens");
    if (options_.hydrogens == Inclusion::drop || dropped == molecule_.skipped.end()) return;
    molecule_.notes.push_back(
        fmt::format("{} hydrogens were left out: the radii of the set {} include them",
                    dropped->second, radii_or_default(options_)));
  }

  // Gives the sites the radii of the file, or those of the table.
  void take_radii(const RadiusTable& table) {
    molecule_.radius_set = file_.own_radii ? "file" : radii_or_default(options_);
    if (!file_.own_radii) assign_radii(sites_, file_, table, molecule_);
  }

  // Counts the atoms whose elements were derived from names, and adds a note for the user. Files
  // with radii of their own get no note, because their radii do not depend on elements.
  void count_guesses() {
    if (!has_guesses_) return;
    std::map<std::tuple<std::string, std::string, std::string>, std::uint64_t> unusual;
    for (const Site& site : sites_) {
      const gemmi::El element = site.atom->element;
      if (!site.atom->element_guessed || element == gemmi::El::X) continue;
      ++molecule_.elements_guessed;
      const std::string_view symbol = gemmi::element_name(element);
      if (std::ranges::find(kOrganicElements, symbol) == kOrganicElements.end())
        ++unusual[{std::string(symbol), site.place->residue->name, site.atom->name.str()}];
    }
    for (const auto& [key, count] : unusual)
      molecule_.unusual_elements_guessed.push_back(
          {std::get<0>(key), std::get<1>(key), std::get<2>(key), count});
    if (molecule_.elements_guessed != 0 && !file_.own_radii)
      molecule_.notes.push_back(note_of_guesses(molecule_));
  }

  // Appends the atom of the site to the molecule.
  void take(const Site& site) {
    const AtomRecord& from = *site.atom;
    if (site.place != place_) enter(*site.place);
    has_guesses_ |= from.element_guessed;
    molecule_.atoms.emplace_back(
        from.position, from.radius, symbols_[static_cast<std::size_t>(from.element)], from.name,
        residue_name_, chain_, residue_number_, from.serial, model_number_, from.hetero,
        from.measured, from.group, from.polarity,
        residue_numbers_.empty() ? from.residue : residue_numbers_[index_of(site)], from.b_iso,
        segment_);
  }

  // Makes the texts that the atoms of a residue share.
  void enter(const ResiduePlace& place) {
    const gemmi::Residue& residue = *place.residue;
    residue_name_ = residue.name;
    segment_ = residue.segment;
    residue_number_ = residue.seqid.num ? residue.seqid.str() : std::string();
    if (!place_ || place.chain != place_->chain) chain_ = place.chain->name;
    if (!place_ || place.model != place_->model) model_number_ = model_number(*place.model);
    place_ = &place;
  }

  void take_asymmetric() {
    // The atoms of a residue stand together, while the file may interleave residues. The records
    // are in the order of the file.
    const auto in_order = [](const Site& a, const Site& b) { return a.atom < b.atom; };
    if (!std::is_sorted(sites_.begin(), sites_.end(), in_order))
      std::stable_sort(sites_.begin(), sites_.end(), in_order);
    take_all();
    note_assembly();
  }

  // Tells of the first assembly of the file if it has other atoms than the asymmetric unit, of
  // which nobody need have known.
  void note_assembly() {
    const std::vector<std::string> names = assembly_names(file_.assemblies);
    if (names.empty()) return;
    double atoms = 0;
    try {
      std::vector<bool> used(file_.atoms.size());
      atoms =
          count_copies(make_recipe(file_.assemblies, names[0], file_.path), file_, sites_, used);
    } catch (const Error&) {
      return;  // nobody asked for it
    }
    if (atoms == 0 || atoms == static_cast<double>(sites_.size())) return;
    molecule_.notes.push_back(
        fmt::format("assembly {} of the file has {:.0f} atoms, and {} are taken, those of the "
                    "asymmetric unit; --assembly {} takes all of it",
                    names[0], atoms, sites_.size(), names[0]));
  }

  // Each site once.
  void take_all() {
    reserve_atoms(sites_.size(), molecule_);
    for (const Site& site : sites_) take(site);
    molecule_.atoms_used = sites_.size();
  }

  void take_assembly() {
    const AssemblyRecipe recipe = recipe_of(file_, options_.assembly);
    molecule_.warnings.insert(molecule_.warnings.end(), recipe.warnings.begin(),
                              recipe.warnings.end());
    std::vector<bool> used(file_.atoms.size());  // by index of the atom in the file
    const double atoms = count_copies(recipe, file_, sites_, used);
    drop("not_in_assembly", [&](const Site& site) { return !used[index_of(site)]; });
    refuse_if_empty();
    refuse_if_too_many(atoms, file_.path, options_);
    take_all();
    // choose_models() made the sites of a model consecutive, and no step has sorted them since.
    copies_ = list_copies(recipe, file_, sites_);
  }

  std::size_t index_of(const Site& site) const { return index_in(file_, site); }

  ParsedFile& file_;
  const ReadOptions& options_;
  const std::vector<ResiduePlace> places_;            // of the residues of all models
  const std::vector<std::uint32_t> residue_numbers_;  // by atom; see residue_numbers()
  Sites sites_;
  Molecule molecule_;
  std::vector<ChainCopy> copies_;
  const ElementSymbols symbols_ = element_symbols();
  const ResiduePlace* place_ = nullptr;  // of the atom appended last, as the texts below
  bool has_guesses_ = false;  // some atom in the molecule has an element that was guessed
  std::int32_t model_number_ = 0;
  ShortText residue_name_, chain_, residue_number_, segment_;
};

}  // namespace

UnexpandedMolecule choose_atoms(ParsedFile&& file, const ReadOptions& options,
                                const RadiusTable& table) {
  return Choice(file, options).run(table);
}

}  // namespace vdwmesh
