#include <fmt/format.h>

#include <algorithm>
#include <gemmi/model.hpp>
#include <set>

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
const Mean& entry(std::vector<Mean>& means, const Site& site, Same same) {
  auto found = std::find_if(means.begin(), means.end(), same);
  if (found == means.end()) {
    means.push_back({site.atom->altloc, site.residue});
    found = means.end() - 1;
  }
  found->sum += static_cast<double>(site.atom->occ);
  ++found->count;
  return *found;
}

// The first of those that are highest but for rounding.
const Mean& highest(const std::vector<Mean>& means) {
  const Mean* best = &means.front();
  for (const Mean& mean : means)
    if (mean.value() > best->value() + kSameOccupancy) best = &mean;
  return *best;
}

char label_of_highest_mean(Range place) {
  std::vector<Mean> means;
  for (auto site = place.first; site != place.second; ++site)
    if (site->atom->altloc != '\0')
      entry(means, *site, [site](const Mean& m) { return m.label == site->atom->altloc; });
  return highest(means).label;
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

class Chooser {
 public:
  Chooser(const std::string& label, SkippedAtoms& skipped) : label_(label), skipped_(skipped) {}

  // Marks what goes by taking its atom away.
  void choose(Range place) {
    if (std::all_of(place.first, place.second,
                    [](const Site& site) { return site.atom->altloc == '\0'; }))
      return;
    const char label = label_ == "highest" ? label_of_highest_mean(place) : label_[0];
    const gemmi::Residue* residue = place.first->residue;
    const bool mixed = std::any_of(place.first, place.second,
                                   [residue](const Site& site) { return site.residue != residue; });
    const gemmi::Residue* stays = mixed ? residue_that_stays(place, label) : nullptr;
    std::vector<bool> drop;
    for (auto site = place.first; site != place.second; ++site)
      drop.push_back(!keep(place, *site, label, mixed, stays));
    for (std::size_t i = 0; i < drop.size(); ++i)
      if (drop[i]) (place.first + static_cast<std::ptrdiff_t>(i))->atom = nullptr;
  }

 private:
  bool keep(Range place, const Site& site, char label, bool mixed, const gemmi::Residue* stays) {
    if (mixed && site.residue != stays && wholly_labelled(place, site.residue)) {
      ++skipped_["microheterogeneity"];
      return false;
    }
    if (site.atom->altloc == '\0' || site.atom->altloc == label) return true;
    ++skipped_["alternate_locations"];
    return false;
  }

  const std::string& label_;
  SkippedAtoms& skipped_;
};

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
  Chooser chooser(label, skipped);
  for (auto first = sites.begin(); first != sites.end();) {
    const auto last = end_of_place(first, sites.end());
    chooser.choose({first, last});
    first = last;
  }
  std::erase_if(sites, [](const Site& site) { return site.atom == nullptr; });
}

}  // namespace vdwmesh
