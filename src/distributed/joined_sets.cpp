// Sets on borders are numbered by a sorted list of their names. Union-find joins those that stand
// beside the same element, once the elements are sorted.
#include "distributed/joined_sets.hpp"

#include <algorithm>
#include <tuple>

#include "core/disjoint_sets.hpp"

namespace vdwmesh {

std::uint64_t count_joined(std::uint64_t sets, std::vector<BorderElement> border) {
  std::vector<std::uint64_t> names;
  names.reserve(border.size());
  for (const BorderElement& b : border) names.push_back(b.set);
  std::ranges::sort(names);
  names.erase(std::ranges::unique(names).begin(), names.end());
  const auto number_of = [&names](const BorderElement& b) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(names, b.set) - names.begin());
  };
  std::ranges::sort(border, {}, &BorderElement::element);
  DisjointSets joined(names.size());
  for (std::size_t i = 1; i < border.size(); ++i) {
    if (border[i].element != border[i - 1].element) continue;
    joined.join(number_of(border[i]), number_of(border[i - 1]));
  }
  return sets - names.size() + joined.count();
}

}  // namespace vdwmesh
