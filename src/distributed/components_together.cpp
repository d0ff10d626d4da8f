// join_components(): a rank has sets of connected spheres, of its share and of those near it. It
// leaves out a set without a sphere of the share, because another rank has all of it. In the
// remaining sets, a sphere of another share is on the border. All ranks get the list of these
// spheres, and say which of their sets they are in. Sets with a sphere in common are one
// (joined_sets.hpp).
#include "distributed/components_together.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "analysis/comparison.hpp"
#include "core/buffer.hpp"
#include "distributed/joined_sets.hpp"

namespace vdwmesh {
namespace {

class BallSets {
 public:
  BallSets(const Ranks& ranks, const SphereShare& share,
           const std::function<std::uint32_t(SphereId)>& set_of)
      : ranks_(ranks), share_(share), set_of_(set_of), has_own_(share.near.ids.size()) {
    for (const SphereId i : share.own) has_own_[set_of(i)] = 1;
  }

  // How many sets have a sphere of the share in them.
  std::uint64_t count() const {
    return static_cast<std::uint64_t>(std::ranges::count(has_own_, 1));
  }

  // Puts the spheres of other shares in these sets on the border. Returns their ids in the whole.
  std::vector<SphereId> add_others() {
    std::vector<SphereId> others;
    for (std::size_t i = 0, own = 0; i < share_.near.ids.size(); ++i) {
      if (own < share_.own.size() && share_.own[own] == i) {
        ++own;
      } else if (add(static_cast<SphereId>(i))) {
        others.push_back(share_.near.ids[i]);
      }
    }
    return others;
  }

  // Puts the spheres of the share that others have named, in any order, on the border.
  void add_own(std::vector<SphereId> named) {
    std::ranges::sort(named);
    for (const SphereId i : share_.own) {
      if (std::ranges::binary_search(named, share_.near.ids[i])) add(i);
    }
  }

  const std::vector<BorderElement>& border() const { return border_; }

 private:
  bool add(SphereId i) {
    const std::uint32_t set = set_of_(i);
    if (has_own_[set] == 0) return false;
    const auto rank = static_cast<std::uint64_t>(ranks_.number());
    border_.push_back({share_.near.ids[i], rank << 32 | set});
    return true;
  }

  const Ranks& ranks_;
  const SphereShare& share_;
  const std::function<std::uint32_t(SphereId)>& set_of_;
  std::vector<std::uint8_t> has_own_;  // [set]
  std::vector<BorderElement> border_;
};

}  // namespace

std::uint64_t join_components(const Ranks& ranks, const SphereShare& share,
                              const std::function<std::uint32_t(SphereId)>& set_of) {
  std::optional<BallSets> sets;
  std::vector<SphereId> others;
  ranks.together([&] {
    sets.emplace(ranks, share, set_of);
    others = sets->add_others();
  });
  std::vector<SphereId> named = ranks.collect(std::span<const SphereId>(others));
  ranks.share(named);
  ranks.together([&] { sets->add_own(std::move(named)); });
  const std::uint64_t all_sets = ranks.sum(sets->count());
  std::vector<BorderElement> border = ranks.collect(std::span(sets->border()));
  std::uint64_t components = 0;
  ranks.together([&] {
    if (ranks.is_first()) components = JoinedSets(std::move(border)).count(all_sets);
  });
  return components;
}

std::uint64_t components_together(const Ranks& ranks, const SphereSet& spheres) {
  const SphereShare share = share_of_spheres(ranks, spheres);
  Buffer<std::uint32_t> sets;
  ranks.together([&] {
    if (!share.own.empty()) sets = connected_balls(SphereSet::view(share.near.spheres));
  });
  return join_components(ranks, share, [&](SphereId i) { return sets[i]; });
}

}  // namespace vdwmesh
