// Sets on borders are numbered by a sorted list of their names. Union-find joins those that stand
// beside the same element, once the elements are sorted.
#include "distributed/together/joined_sets.hpp"

#include <algorithm>

namespace vdwmesh {
namespace {

std::vector<std::uint64_t> names_of(const std::vector<BorderElement>& border) {
  std::vector<std::uint64_t> names;
  names.reserve(border.size());
  for (const BorderElement& b : border) names.push_back(b.set);
  std::ranges::sort(names);
  names.erase(std::ranges::unique(names).begin(), names.end());
  return names;
}

}  // namespace

JoinedSets::JoinedSets(std::vector<BorderElement> border)
    : names_(names_of(border)), joined_(names_.size()) {
  std::ranges::sort(border, {}, &BorderElement::element);
  for (std::size_t i = 1; i < border.size(); ++i) {
    if (border[i].element != border[i - 1].element) continue;
    joined_.join(place_of(border[i].set), place_of(border[i - 1].set));
  }
}

std::uint32_t JoinedSets::place_of(std::uint64_t set) const {
  return static_cast<std::uint32_t>(std::ranges::lower_bound(names_, set) - names_.begin());
}

std::optional<std::uint32_t> JoinedSets::number_of(std::uint64_t set) {
  const std::uint32_t place = place_of(set);
  if (place == names_.size() || names_[place] != set) return std::nullopt;
  return joined_.find(place);
}

}  // namespace vdwmesh
