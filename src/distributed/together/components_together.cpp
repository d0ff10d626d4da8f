// join_components(): a rank has sets of connected spheres, of its share and of those near it. It
// leaves out a set without a sphere of the share, because another rank has all of it. It tells the
// owners of the other spheres in the remaining sets which set they are in. An owner thereby learns
// which sets of other ranks are parts of its own, and the first rank joins all that are
// (joined_sets.hpp). So border spheres, of which there are many, go to one rank each, and the first
// rank gets a few pairs of sets.
#include "distributed/together/components_together.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "analysis/comparison.hpp"
#include "core/buffer.hpp"
#include "distributed/together/joined_sets.hpp"

namespace vdwmesh {
namespace {

// A sphere of another rank's share, and the set that it is in on this rank.
struct SphereInSet {
  SphereId id;
  std::uint32_t set;
};

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

  // For each rank, the spheres of its share that are here in sets with spheres of this share.
  std::vector<std::vector<SphereInSet>> for_owners() const {
    std::vector<std::vector<SphereInSet>> found(static_cast<std::size_t>(ranks_.count()));
    for (std::size_t i = 0; i < share_.near.ids.size(); ++i) {
      if (share_.owner[i] == static_cast<std::uint32_t>(ranks_.number())) continue;
      const std::uint32_t set = set_of_(static_cast<SphereId>(i));
      if (has_own_[set] != 0) found[share_.owner[i]].push_back({share_.near.ids[i], set});
    }
    return found;
  }

  // Which sets of other ranks have spheres of this share in them, and so are parts of sets here: a
  // border element for each two sets. The element is the set here. Many spheres say the same.
  std::vector<BorderElement> border(const std::vector<std::vector<SphereInSet>>& from_each) const {
    std::vector<BorderElement> border;
    for (std::size_t rank = 0; rank < from_each.size(); ++rank) {
      for (const auto& [id, set] : from_each[rank]) {
        const auto here = std::ranges::lower_bound(share_.near.ids, id);
        const auto i = static_cast<SphereId>(here - share_.near.ids.begin());
        border.push_back({name(ranks_.number(), set_of_(i)), name(static_cast<int>(rank), set)});
      }
    }
    std::ranges::sort(border);
    border.erase(std::ranges::unique(border).begin(), border.end());
    const std::size_t others = border.size();
    for (std::size_t i = 0; i < others; ++i) {
      const std::uint64_t here = border[i].element;
      if (i == 0 || here != border[i - 1].element) border.push_back({here, here});
    }
    return border;
  }

 private:
  static std::uint64_t name(int rank, std::uint32_t set) {
    return static_cast<std::uint64_t>(rank) << 32 | set;
  }

  const Ranks& ranks_;
  const SphereShare& share_;
  const std::function<std::uint32_t(SphereId)>& set_of_;
  std::vector<std::uint8_t> has_own_;  // [set]
};

}  // namespace

std::uint64_t join_components(const Ranks& ranks, const SphereShare& share,
                              const std::function<std::uint32_t(SphereId)>& set_of) {
  std::optional<BallSets> sets;
  std::vector<std::vector<SphereInSet>> for_owners;
  ranks.together([&] {
    sets.emplace(ranks, share, set_of);
    for_owners = sets->for_owners();
  });
  const std::vector<std::vector<SphereInSet>> from_each = ranks.exchange(for_owners);
  std::vector<BorderElement> own_border;
  ranks.together([&] { own_border = sets->border(from_each); });
  const std::uint64_t all_sets = ranks.sum(sets->count());
  std::vector<BorderElement> border = ranks.collect(std::span<const BorderElement>(own_border));
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
