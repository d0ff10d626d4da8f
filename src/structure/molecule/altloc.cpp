// Chooses among alternate locations; site.hpp states the rules. A "position" below is a sequence
// position of a chain: one residue, or several residues with the same number (microheterogeneity).
// A "label" is the character of an alternate location, '\0' for none.
//
// The atoms of a position are brought together, so positions are handled one after the other:
// 1. For "highest", labels are ranked by the mean occupancy of their atoms at the position. A label
//    that the user asks for holds at the positions that have it, and "highest" at the others.
// 2. PositionChoice marks for removal every atom that has another label than the chosen one, or
//    that is in a residue that was not chosen.
// 3. For "highest", an atom loses its mark if the residue would otherwise lack its name.
// 4. Unlabelled copies of atoms that stay are marked too, and marked atoms are removed and counted.
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gemmi/model.hpp>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "structure/molecule/site.hpp"
#include "structure/read/parsed_file.hpp"

namespace vdwmesh {
namespace {

// Means that differ by no more than this count as equal. Occupancies have two or three decimals, so
// the means of n and of m atoms are either equal or at least 1e-3 / (n m) apart. For up to 30 atoms
// each that exceeds the tolerance, so different means count as different. Storing occupancies as
// floats changes the means by 3e-8 at most, so equal means count as equal.
constexpr double kSameOccupancy = 1e-6;

// The mean occupancy of a group of atoms: those with one label at a position, or those with one
// label in one residue of the position.
struct MeanOccupancy {
  char label;
  const gemmi::Residue* residue;  // of the first atom of the group
  double sum = 0;                 // of occupancies
  int count = 0;
  double value() const { return sum / count; }
};

// The atoms of one position: the first, and the end.
using Range = std::pair<Sites::iterator, Sites::iterator>;

// The end of the run of atoms that share the sequence position of `first`.
Sites::iterator end_of_position(Sites::iterator first, Sites::iterator last) {
  return std::find_if(first, last, [first](const Site& site) {
    return site.place->residue != first->place->residue &&
           (site.place->chain != first->place->chain ||
            site.place->residue->seqid != first->place->residue->seqid ||
            site.place->residue->segment != first->place->residue->segment);
  });
}

// Adds the atom's occupancy to the mean of its group, for which `same` is true; begins a new mean
// if there is none. The means are in the order of the first atoms of their groups.
template <class Same>
void entry(std::vector<MeanOccupancy>& means, const Site& site, Same same) {
  auto found = std::find_if(means.begin(), means.end(), same);
  if (found == means.end()) {
    means.push_back({site.atom->altloc, site.place->residue});
    found = means.end() - 1;
  }
  found->sum += static_cast<double>(site.atom->occupancy);
  ++found->count;
}

// The highest mean. The first one wins ties, which are differences up to kSameOccupancy.
const MeanOccupancy& highest(const std::vector<MeanOccupancy>& means) {
  const MeanOccupancy* best = &means.front();
  for (const MeanOccupancy& mean : means)
    if (mean.value() > best->value() + kSameOccupancy) best = &mean;
  return *best;
}

// One mean for each label at the position, in the order of the file.
std::vector<MeanOccupancy> means_by_label(Range place) {
  std::vector<MeanOccupancy> means;
  for (auto site = place.first; site != place.second; ++site)
    if (site->atom->altloc != '\0')
      entry(means, *site, [site](const MeanOccupancy& m) { return m.label == site->atom->altloc; });
  return means;
}

// Whether all atoms of the residue have labels. Only such a residue is an alternative to the other
// residues of the position; a residue with unlabelled atoms is always there.
bool wholly_labelled(Range place, const gemmi::Residue* residue) {
  return std::all_of(place.first, place.second, [residue](const Site& site) {
    return site.place->residue != residue || site.atom->altloc != '\0';
  });
}

// The one of the wholly labelled residues of the position that stays: its atoms with the chosen
// label have the highest mean occupancy. Null if no such residue has an atom with the label.
const gemmi::Residue* residue_that_stays(Range place, char label) {
  std::vector<MeanOccupancy> means;
  for (auto site = place.first; site != place.second; ++site)
    if (site->atom->altloc == label && wholly_labelled(place, site->place->residue))
      entry(means, *site,
            [site](const MeanOccupancy& m) { return m.residue == site->place->residue; });
  return means.empty() ? nullptr : highest(means).residue;
}

// The labels of the position in descending order of their means; ties keep the order of the file.
// The highest is selected repeatedly, because std::sort cannot compare with a tolerance: equality
// within a tolerance is not transitive.
std::vector<char> labels_by_mean(Range place) {
  std::vector<MeanOccupancy> means = means_by_label(place);
  std::vector<char> labels;
  while (!means.empty()) {
    labels.push_back(highest(means).label);
    std::erase_if(means, [&](const MeanOccupancy& mean) { return mean.label == labels.back(); });
  }
  return labels;
}

// The decision about every atom at one position. decisions_[i] belongs to the i-th atom of the
// position, site(i). An atom is marked if its decision is not `stays`.
class PositionChoice {
 public:
  explicit PositionChoice(Range place)
      : place_(place),
        decisions_(static_cast<std::size_t>(place.second - place.first), Decision::stays) {}

  // Marks the atoms of other labels and of the residues that were not chosen. Unlabelled atoms
  // stay. `mixed`: the position has several residues.
  void choose(char label) {
    const gemmi::Residue* first = place_.first->place->residue;
    const bool mixed = std::any_of(place_.first, place_.second, [first](const Site& site) {
      return site.place->residue != first;
    });
    chosen_ = mixed ? residue_that_stays(place_, label) : nullptr;
    for (std::size_t i = 0; i < decisions_.size(); ++i) {
      if (mixed && site(i).place->residue != chosen_ &&
          wholly_labelled(place_, site(i).place->residue))
        decisions_[i] = Decision::other_residue;
      else if (site(i).atom->altloc != '\0' && site(i).atom->altloc != label)
        decisions_[i] = Decision::other_label;
    }
  }

  // Marks unlabelled atoms with an occupancy below 1 if an atom of the same residue and name stays
  // with a label. Some files leave the label of one conformation blank; both atoms would overlap.
  void drop_unlabelled_copies() {
    std::set<std::pair<const gemmi::Residue*, std::string_view>> labelled;
    for (std::size_t i = 0; i < decisions_.size(); ++i)
      if (decisions_[i] == Decision::stays && site(i).atom->altloc != '\0')
        labelled.emplace(site(i).place->residue, site(i).atom->name);
    for (std::size_t i = 0; i < decisions_.size(); ++i) {
      const AtomRecord& atom = *site(i).atom;
      const bool blank =
          decisions_[i] == Decision::stays && atom.altloc == '\0' && atom.occupancy < 1;
      if (blank && labelled.count({site(i).place->residue, atom.name}) != 0)
        decisions_[i] = Decision::other_label;
    }
  }

  // Removes the marks of atoms whose names the residue would lack, with the first of `labels` that
  // has them. If one of several residues was chosen, only that residue is completed. Atoms of other
  // residues keep their marks. `held` has the residue and name of each atom that stays.
  void complete(const std::vector<char>& labels) {
    std::set<std::pair<const gemmi::Residue*, std::string_view>> held;
    for (std::size_t i = 0; i < decisions_.size(); ++i)
      if (decisions_[i] == Decision::stays)
        held.emplace(site(i).place->residue, site(i).atom->name);
    for (const char label : labels) {
      // Names are compared with the state before this label, hence the copy: a name may occur twice
      // under one label, and both atoms must come back.
      const auto before = held;
      for (std::size_t i = 0; i < decisions_.size(); ++i) {
        if (decisions_[i] != Decision::other_label || site(i).atom->altloc != label) continue;
        if (chosen_ && site(i).place->residue != chosen_) continue;
        const std::pair name(site(i).place->residue, site(i).atom->name.view());
        if (before.count(name) != 0) continue;
        decisions_[i] = Decision::stays;
        held.insert(name);
      }
    }
  }

  // Counts the marked atoms and sets their pointers to null; the caller removes such sites.
  void carry_out(SkippedAtoms& skipped) {
    for (std::size_t i = 0; i < decisions_.size(); ++i) {
      if (decisions_[i] == Decision::stays) continue;
      ++skipped[decisions_[i] == Decision::other_label ? "alternate_locations"
                                                       : "microheterogeneity"];
      site(i).atom = nullptr;
    }
  }

 private:
  enum class Decision : std::uint8_t { stays, other_label, other_residue };
  Site& site(std::size_t i) const { return place_.first[static_cast<std::ptrdiff_t>(i)]; }

  Range place_;
  std::vector<Decision> decisions_;
  // The residue that stays, if the position has several. Null if it has one, or if none has the
  // label.
  const gemmi::Residue* chosen_ = nullptr;
};

bool has_labels(Range place) {
  return std::any_of(place.first, place.second,
                     [](const Site& site) { return site.atom->altloc != '\0'; });
}

// Chooses at one position. `label` is "highest" or one character. Where no atom has that label, it
// counts as "highest"; returns how many atoms with other labels stay then.
std::uint64_t choose_at(Range place, const std::string& label, SkippedAtoms& skipped) {
  PositionChoice choice(place);
  const std::vector<char> labels = labels_by_mean(place);
  const bool is_there = label != "highest" && std::count(labels.begin(), labels.end(), label[0]);
  choice.choose(is_there ? label[0] : labels.front());
  if (!is_there) choice.complete(labels);
  choice.drop_unlabelled_copies();
  choice.carry_out(skipped);
  if (is_there || label == "highest") return 0;
  return static_cast<std::uint64_t>(std::count_if(place.first, place.second, [](const Site& site) {
    return site.atom && site.atom->altloc != '\0';
  }));
}

// Throws if no atom has the label that the user asked for; the message lists the labels there are.
// "highest" is not a label, and always fits.
void check_label(const Sites& sites, const std::string& label, const std::string& path) {
  if (label == "highest") return;
  std::set<char> labels;
  for (const Site& site : sites)
    if (site.atom->altloc != '\0') labels.insert(site.atom->altloc);
  if (label.size() == 1 && labels.count(label[0]) != 0) return;
  std::string known;
  for (const char c : labels) known += fmt::format("{}{}", known.empty() ? "" : " ", c);
  throw InvalidInput(fmt::format("{}: no atom has the alternate location {}; {}", path, label,
                                 known.empty()
                                     ? "the file has none"
                                     : fmt::format("there are {}, or highest, or all", known)));
}

// Brings residues together that are alternatives to each other but do not stand side by side: they
// have one position and different names, and all their atoms have labels. A residue of the same
// name is none: numbers of waters come again. Returns whether anything was moved.
bool gather_positions(Sites& sites) {
  using Position = std::tuple<const gemmi::Chain*, std::string_view, int, char>;
  std::map<Position, std::vector<const ResiduePlace*>> found;
  std::map<const ResiduePlace*, const ResiduePlace*> moved;  // to stand behind
  for (auto first = sites.begin(); first != sites.end();) {
    const ResiduePlace* const place = first->place;
    const auto last =
        std::find_if(first, sites.end(), [place](const Site& site) { return site.place != place; });
    const bool labelled =
        std::all_of(first, last, [](const Site& site) { return site.atom->altloc != '\0'; });
    first = last;
    if (!labelled) continue;
    const gemmi::Residue& residue = *place->residue;
    auto& alike =
        found[{place->chain, residue.segment, residue.seqid.num.value, residue.seqid.icode}];
    const bool is_new = std::all_of(alike.begin(), alike.end(), [&](const ResiduePlace* other) {
      return other->residue->name != residue.name;
    });
    if (is_new && !alike.empty() && place != alike.front() + alike.size())
      moved[place] = alike.front();
    alike.push_back(place);
  }
  if (moved.empty()) return false;
  const auto stand_of = [&moved](const Site& site) {
    const auto to = moved.find(site.place);
    return to == moved.end() ? site.place : to->second;
  };
  std::stable_sort(sites.begin(), sites.end(),
                   [&](const Site& a, const Site& b) { return stand_of(a) < stand_of(b); });
  return true;
}

}  // namespace

void choose_alternate_locations(Sites& sites, const std::string& label, Molecule& molecule) {
  if (label == "all") return;
  check_label(sites, label, molecule.path);
  const bool was_moved = gather_positions(sites);
  std::uint64_t others = 0;  // atoms that stay without the label
  for (auto first = sites.begin(); first != sites.end();) {
    const Range place{first, end_of_position(first, sites.end())};
    first = place.second;
    if (has_labels(place)) others += choose_at(place, label, molecule.skipped);
  }
  std::erase_if(sites, [](const Site& site) { return site.atom == nullptr; });
  if (was_moved) {
    std::stable_sort(sites.begin(), sites.end(),
                     [](const Site& a, const Site& b) { return a.place < b.place; });
  }
  if (others == 0) return;
  molecule.notes.push_back(
      fmt::format("{} atoms have no alternate location {}: they have the one of highest occupancy "
                  "that there is",
                  others, label));
}

}  // namespace vdwmesh
