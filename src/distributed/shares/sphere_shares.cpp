// Shares of spheres. A prefix sum over the counts of layers, block by block, gives every sphere of
// a block its number, and the number tells which part the sphere belongs to. A sphere is near to a
// part if its interval along the axis meets that of the part.
#include "distributed/shares/sphere_shares.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>
#include <utility>

#include "core/fixed_blocks.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

// Layers across an axis, in which the spheres of a set are counted, so that they can be divided
// into parts of equal numbers without being sorted. It says which layer a sphere is in.
class LayerScale {
 public:
  static constexpr std::size_t kLayers = 4096;

  // `box` is that of the centres of all spheres.
  LayerScale(const Box& box, int axis) : axis_(axis), lower_(box.lower[axis]) {
    const double height = box.upper[axis] - lower_;
    scale_ = height > 0 ? kLayers / height : 0;
  }

  std::size_t layer_of(const Sphere& s) const {
    const double layer = (s.center[axis_] - lower_) * scale_;
    return static_cast<std::size_t>(std::clamp(layer, 0.0, kLayers - 1.0));
  }

 private:
  int axis_;
  double lower_, scale_;
};

// Relative margins. kSlack is relative to the lengths that are compared, and larger than the gap at
// which spheres are still taken to touch (arcs/doubts.hpp). kRounding is relative to the
// coordinates, and larger than the rounding of their differences.
constexpr double kSlack = 1e-6, kRounding = 1e-14;

int longest_axis(const Box& box) {
  const Vec3d size = box.upper - box.lower;
  int longest = 0;
  for (int axis = 1; axis < 3; ++axis) {
    if (size[axis] > size[longest]) longest = axis;
  }
  return longest;
}

// The first number of each part, and the end of the last one.
std::vector<std::uint64_t> even_runs(std::uint64_t count, std::size_t parts) {
  std::vector<std::uint64_t> begins;
  for (std::size_t part = 0; part <= parts; ++part)
    begins.push_back(begin_of_part(count, part, parts));
  return begins;
}

Box join_boxes(const std::vector<Box>& boxes) {
  Box all = empty_box();
  for (const Box& box : boxes) include(all, box);
  return all;
}

// Adds up the extents that all ranks have of all parts. Collective.
void join_extents(const Ranks& ranks, std::vector<PartExtent>& parts) {
  const std::vector<PartExtent> all = ranks.collect(std::span<const PartExtent>(parts));
  for (std::size_t i = 0; i < all.size(); ++i) parts[i % parts.size()].add(all[i]);
  ranks.share(parts);
}

void add_to(std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& terms) {
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += terms[i];
}

// What work(i, block i) returns for all blocks, which all cores take.
template <class Work>
auto of_each(std::vector<SphereBlock>& blocks, const Work& work) {
  std::vector<std::invoke_result_t<const Work&, std::size_t, SphereBlock&>> results(blocks.size());
  tbb::parallel_for(std::size_t{0}, blocks.size(),
                    [&](std::size_t i) { results[i] = work(i, blocks[i]); });
  return results;
}

// The run of spheres that a rank looks at, as blocks for its cores. Nothing depends on where one
// block ends and the next one begins.
class OwnBlocks {
 public:
  OwnBlocks(const Ranks& ranks, const SphereSet& spheres)
      : parts_(static_cast<std::size_t>(ranks.count())) {
    constexpr std::size_t kSpheresPerBlock = std::size_t{1} << 17;
    const auto rank = static_cast<std::size_t>(ranks.number());
    const std::size_t end = begin_of_part(spheres.size(), rank + 1, parts_);
    for (std::size_t first = begin_of_part(spheres.size(), rank, parts_); first < end;
         first += kSpheresPerBlock) {
      blocks_.emplace_back(spheres, first, std::min(first + kSpheresPerBlock, end), parts_);
    }
  }

  // Each of these is what one block of all these spheres would return.
  Box box_of_centers() {
    return join_boxes(
        of_each(blocks_, [](std::size_t, SphereBlock& b) { return b.box_of_centers(); }));
  }
  std::vector<std::uint64_t> count_layers(const Box& box) {
    counts_ = of_each(blocks_, [&](std::size_t, SphereBlock& b) { return b.count_layers(box); });
    std::vector<std::uint64_t> sums(LayerScale::kLayers);
    for (const std::vector<std::uint64_t>& counts : counts_) add_to(sums, counts);
    return sums;
  }
  std::vector<PartExtent> divide(std::span<const std::uint64_t> all,
                                 std::vector<std::uint64_t> before) {
    std::vector<std::vector<std::uint64_t>> before_each;
    for (const std::vector<std::uint64_t>& counts : counts_) {
      before_each.push_back(before);
      add_to(before, counts);
    }
    const std::vector<std::vector<PartExtent>> of_blocks = of_each(
        blocks_, [&](std::size_t i, SphereBlock& b) { return b.divide(all, before_each[i]); });
    std::vector<PartExtent> parts(parts_);
    for (const std::vector<PartExtent>& extents : of_blocks) {
      for (std::size_t part = 0; part < parts_; ++part) parts[part].add(extents[part]);
    }
    return parts;
  }
  std::vector<std::vector<NamedSphere>> choose(std::span<const PartExtent> parts) {
    const std::vector<std::vector<std::vector<NamedSphere>>> of_blocks =
        of_each(blocks_, [&](std::size_t, SphereBlock& b) { return b.choose(parts); });
    std::vector<std::vector<NamedSphere>> all(parts_);
    for (const std::vector<std::vector<NamedSphere>>& chosen : of_blocks) {
      append_to_each(all, chosen);
    }
    return all;
  }

 private:
  std::size_t parts_;
  std::vector<SphereBlock> blocks_;
  std::vector<std::vector<std::uint64_t>> counts_;  // by block and layer
};

}  // namespace

void PartExtent::add(const PartExtent& other) {
  lower = std::min(lower, other.lower);
  upper = std::max(upper, other.upper);
  radius = std::max(radius, other.radius);
}

void PartExtent::add(const Sphere& s, int axis) {
  add({s.center[axis] - s.radius, s.center[axis] + s.radius, s.radius});
}

bool PartExtent::may_touch(const Sphere& s, int axis) const {
  const double slack = kSlack * (s.radius + radius) + kRounding * std::abs(s.center[axis]);
  return s.center[axis] + s.radius + slack >= lower && s.center[axis] - s.radius - slack <= upper;
}

SphereBlock::SphereBlock(const SphereSet& spheres, std::size_t first, std::size_t end,
                         std::size_t parts)
    : first_(first),
      all_(spheres.size()),
      parts_(parts),
      spheres_(spheres.spheres().subspan(first, end - first)) {}

Box SphereBlock::box_of_centers() const {
  Box box = empty_box();
  for (const Sphere& s : spheres_) include(box, s.center);
  return box;
}

std::vector<std::uint64_t> SphereBlock::count_layers(const Box& box) {
  axis_ = longest_axis(box);
  const LayerScale scale(box, axis_);
  std::vector<std::uint64_t> counts(LayerScale::kLayers);
  layers_.reserve(spheres_.size());
  for (const Sphere& s : spheres_) {
    layers_.push_back(static_cast<std::uint16_t>(scale.layer_of(s)));
    ++counts[layers_.back()];
  }
  return counts;
}

std::vector<PartExtent> SphereBlock::divide(std::span<const std::uint64_t> all,
                                            std::span<const std::uint64_t> before) {
  std::vector<std::uint64_t> next(all.size());  // [layer]: number of its next sphere
  std::exclusive_scan(all.begin(), all.end(), next.begin(), std::uint64_t{0});
  for (std::size_t layer = 0; layer < next.size(); ++layer) next[layer] += before[layer];
  const std::vector<std::uint64_t> begins = even_runs(all_, parts_);
  std::vector<PartExtent> parts(parts_);
  owners_.reserve(spheres_.size());
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    const std::uint64_t number = next[layers_[i]]++;
    const auto behind = std::ranges::upper_bound(begins, number);
    const auto owner = static_cast<std::uint32_t>(behind - begins.begin() - 1);
    owners_.push_back(owner);
    parts[owner].add(spheres_[i], axis_);
  }
  return parts;
}

// From the part of a sphere on, parts are asked until a sphere cannot touch those that are left,
// joined to one extent, which reaches as far as any of theirs. So a sphere asks a few of many
// parts.
std::vector<std::vector<NamedSphere>> SphereBlock::choose(std::span<const PartExtent> parts) const {
  std::vector<PartExtent> up_to(parts.begin(), parts.end()), from = up_to;
  for (std::size_t part = 1; part < parts_; ++part) {
    up_to[part].add(up_to[part - 1]);
    from[parts_ - 1 - part].add(from[parts_ - part]);
  }
  std::vector<std::vector<NamedSphere>> chosen(parts_);
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    const auto id = static_cast<SphereId>(first_ + i);
    const auto touches = [&](const PartExtent& extent) {
      return extent.may_touch(spheres_[i], axis_);
    };
    const std::size_t owner = owners_[i];
    const NamedSphere named{id, owners_[i]};
    chosen[owner].push_back(named);
    for (std::size_t part = owner; part-- > 0 && touches(up_to[part]);) {
      if (touches(parts[part])) chosen[part].push_back(named);
    }
    for (std::size_t part = owner + 1; part < parts_ && touches(from[part]); ++part) {
      if (touches(parts[part])) chosen[part].push_back(named);
    }
  }
  return chosen;
}

SphereShare gather_share(std::size_t part, const SphereSet& spheres,
                         const std::vector<std::vector<NamedSphere>>& from_each) {
  const std::vector<NamedSphere> all = joined(from_each);
  SphereShare share;
  share.near.ids.resize(all.size());
  share.near.spheres.resize(all.size());
  share.owner.resize(all.size());
  for_each_index(all.size(), [&](std::size_t i) {
    share.near.ids[i] = all[i].id;
    share.near.spheres[i] = spheres[all[i].id];
    share.owner[i] = all[i].owner;
  });
  share.own = collect<SphereId>(all.size(), [&](std::size_t i, std::vector<SphereId>& own) {
    if (all[i].owner == part) own.push_back(static_cast<SphereId>(i));
  });
  return share;
}

SphereShare share_of_spheres(const Ranks& ranks, const SphereSet& spheres) {
  OwnBlocks blocks(ranks, spheres);
  const Box box = join_boxes(ranks.of_all(blocks.box_of_centers()));
  std::vector<std::uint64_t> all, before;
  ranks.together([&] {
    all = blocks.count_layers(box);
    before = all;
  });
  ranks.add_up(all);
  ranks.add_up_before(before);
  std::vector<PartExtent> parts;
  ranks.together([&] { parts = blocks.divide(all, std::move(before)); });
  join_extents(ranks, parts);
  std::vector<std::vector<NamedSphere>> named;
  ranks.together([&] { named = blocks.choose(parts); });
  const std::vector<std::vector<NamedSphere>> told = ranks.exchange(named);
  SphereShare share;
  ranks.together(
      [&] { share = gather_share(static_cast<std::size_t>(ranks.number()), spheres, told); });
  return share;
}

}  // namespace vdwmesh
