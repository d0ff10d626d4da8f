#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <gemmi/model.hpp>
#include <set>
#include <utility>

#include "core/errors.hpp"
#include "structure/site.hpp"

namespace vdwmesh {
namespace {

// Occupancies are given to two or three decimals; means closer than this are equal.
constexpr double kSameOccupancy = 1e-6;

// Mean occupancy of what shares a label, or a label and a residue name.
struct Mean {
  char label;
  const gemmi::Residue* residue;
  double sum = 0;
  int count = 0;
  double value() const { return sum / count; }
};

using Range = std::pair<Sites::iterator, Sites::iterator>;

// The atoms at one place of the chain: one residue, or several with the same number.
Sites::iterator end_of_place(Sites::iterator first, Sites::iterator last) {
  return std::find_if(first, last, [first](const Site& site) {
    return site.chain != first->chain || site.residue->seqid != first->residue->seqid ||
           site.residue->segment != first->residue->segment;
  });
}

template <class Same>
void entry(std::vector<Mean>& means, const Site& site, Same same) {
  auto found = std::find_if(means.begin(), means.end(), same);
  if (found == means.end()) {
    means.push_back({site.atom->altloc, site.residue});
    found = means.end() - 1;
  }
  found->sum += static_cast<double>(site.atom->occ);
  ++found->count;
}

// The first of those that are highest but for rounding.
const Mean& highest(const std::vector<Mean>& means) {
  const Mean* best = &means.front();
  for (const Mean& mean : means)
    if (mean.value() > best->value() + kSameOccupancy) best = &mean;
  return *best;
}

std::vector<Mean> means_by_label(Range place) {
  std::vector<Mean> means;
  for (auto site = place.first; site != place.second; ++site)
    if (site->atom->altloc != '\0')
      entry(means, *site, [site](const Mean& m) { return m.label == site->atom->altloc; });
  return means;
}

bool wholly_labelled(Range place, const gemmi::Residue* residue) {
  return std::all_of(place.first, place.second, [residue](const Site& site) {
    return site.residue != residue || site.atom->altloc != '\0';
  });
}

// Of several residues at one place that all bear labels, the one that stays: that of the chosen
// label with the highest mean. Null where there is no such choice.
const gemmi::Residue* residue_that_stays(Range place, char label) {
  std::vector<Mean> means;
  for (auto site = place.first; site != place.second; ++site)
    if (site->atom->altloc == label && wholly_labelled(place, site->residue))
      entry(means, *site, [site](const Mean& m) { return m.residue == site->residue; });
  return means.empty() ? nullptr : highest(means).residue;
}

// The labels of a place, that of the highest mean first.
std::vector<char> labels_by_mean(Range place) {
  std::vector<Mean> means = means_by_label(place);
  std::vector<char> labels;
  while (!means.empty()) {
    labels.push_back(highest(means).label);
    std::erase_if(means, [&](const Mean& mean) { return mean.label == labels.back(); });
  }
  return labels;
}

// The choice at one place of the chain.
class PlaceChoice {
 public:
  explicit PlaceChoice(Range place)
      : place_(place), fates_(static_cast<std::size_t>(place.second - place.first), Fate::stays) {}

  // Keeps the atoms of `label` and those without one.
  void choose(char label) {
    const gemmi::Residue* first = place_.first->residue;
    const bool mixed = std::any_of(place_.first, place_.second,
                                   [first](const Site& site) { return site.residue != first; });
    chosen_ = mixed ? residue_that_stays(place_, label) : nullptr;
    for (std::size_t i = 0; i < fates_.size(); ++i) {
      if (mixed && site(i).residue != chosen_ && wholly_labelled(place_, site(i).residue))
        fates_[i] = Fate::other_residue;
      else if (site(i).atom->altloc != '\0' && site(i).atom->altloc != label)
        fates_[i] = Fate::other_label;
    }
  }

  // Some files leave the label of one conformation blank. Such an atom, which is there in part
  // only, goes if the label kept has one of its name.
  void drop_blank_twins() {
    std::set<std::pair<const gemmi::Residue*, std::string>> labelled;
    for (std::size_t i = 0; i < fates_.size(); ++i)
      if (fates_[i] == Fate::stays && site(i).atom->altloc != '\0')
        labelled.emplace(site(i).residue, site(i).atom->name);
    for (std::size_t i = 0; i < fates_.size(); ++i) {
      const gemmi::Atom& atom = *site(i).atom;
      const bool blank = fates_[i] == Fate::stays && atom.altloc == '\0' && atom.occ < 1;
      if (blank && labelled.count({site(i).residue, atom.name}) != 0) fates_[i] = Fate::other_label;
    }
  }

  // Takes back atoms whose names the residue would lack, from the first of `labels` that has them.
  // Where one of several residues was chosen, only it is completed: what is left of another belongs
  // to both.
  void complete(const std::vector<char>& labels) {
    std::set<std::pair<const gemmi::Residue*, std::string>> held;
    for (std::size_t i = 0; i < fates_.size(); ++i)
      if (fates_[i] == Fate::stays) held.emplace(site(i).residue, site(i).atom->name);
    for (const char label : labels) {
      const auto before = held;  // an atom may stand twice under one label
      for (std::size_t i = 0; i < fates_.size(); ++i) {
        if (fates_[i] != Fate::other_label || site(i).atom->altloc != label) continue;
        if (chosen_ && site(i).residue != chosen_) continue;
        const std::pair name(site(i).residue, site(i).atom->name);
        if (before.count(name) != 0) continue;
        fates_[i] = Fate::stays;
        held.insert(name);
      }
    }
  }

  // Takes the atoms away that do not stay, and counts them.
  void carry_out(SkippedAtoms& skipped) {
    for (std::size_t i = 0; i < fates_.size(); ++i) {
      if (fates_[i] == Fate::stays) continue;
      ++skipped[fates_[i] == Fate::other_label ? "alternate_locations" : "microheterogeneity"];
      site(i).atom = nullptr;
    }
  }

 private:
  enum class Fate : std::uint8_t { stays, other_label, other_residue };
  Site& site(std::size_t i) const { return place_.first[static_cast<std::ptrdiff_t>(i)]; }

  Range place_;
  std::vector<Fate> fates_;
  const gemmi::Residue* chosen_ = nullptr;  // of several at the place; null: no such choice
};

bool has_labels(Range place) {
  return std::any_of(place.first, place.second,
                     [](const Site& site) { return site.atom->altloc != '\0'; });
}

void choose_at(Range place, const std::string& label, SkippedAtoms& skipped) {
  PlaceChoice choice(place);
  if (label == "highest") {
    const std::vector<char> labels = labels_by_mean(place);
    choice.choose(labels.front());
    choice.complete(labels);
  } else {
    choice.choose(label[0]);
  }
  choice.drop_blank_twins();
  choice.carry_out(skipped);
}

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

}  // namespace

void choose_alternate_locations(Sites& sites, const std::string& label, const std::string& path,
                                SkippedAtoms& skipped) {
  if (label == "all") return;
  check_label(sites, label, path);
  for (auto first = sites.begin(); first != sites.end();) {
    const Range place{first, end_of_place(first, sites.end())};
    first = place.second;
    if (has_labels(place)) choose_at(place, label, skipped);
  }
  std::erase_if(sites, [](const Site& site) { return site.atom == nullptr; });
}

}  // namespace vdwmesh
