// Shares of spheres. A prefix sum over the counts of layers, block by block, gives every sphere of
// a block its number, and the number tells which part the sphere belongs to. A sphere is near to a
// part if its interval along the axis meets that of the part.
#include "distributed/sphere_shares.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "distributed/layers.hpp"
#include "surface/box.hpp"

namespace vdwmesh {
namespace {

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

// The first sphere or number of each part or block, and the end of the last one.
std::vector<std::uint64_t> even_runs(std::uint64_t count, std::size_t parts) {
  std::vector<std::uint64_t> begins;
  for (std::size_t part = 0; part <= parts; ++part) begins.push_back(count * part / parts);
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

SphereBlock::SphereBlock(const SphereSet& spheres, std::size_t block, std::size_t parts)
    : all_(spheres.size()), parts_(parts) {
  const std::vector<std::uint64_t> begins = even_runs(all_, parts);
  first_ = begins[block];
  spheres_ = spheres.spheres().subspan(first_, begins[block + 1] - first_);
}

Box SphereBlock::box_of_centers() const {
  Box box = empty_box();
  for (const Sphere& s : spheres_) include(box, s.center);
  return box;
}

std::vector<std::uint64_t> SphereBlock::count_layers(const Box& box) {
  axis_ = longest_axis(box);
  const LayerScale scale(box, axis_);
  std::vector<std::uint64_t> counts(LayerScale::kLayers);
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
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    const std::uint64_t number = next[layers_[i]]++;
    const auto behind = std::ranges::upper_bound(begins, number);
    const auto owner = static_cast<std::uint32_t>(behind - begins.begin() - 1);
    owners_.push_back(owner);
    parts[owner].add(spheres_[i], axis_);
  }
  return parts;
}

std::vector<std::vector<SentSphere>> SphereBlock::choose(std::span<const PartExtent> parts) const {
  std::vector<std::vector<SentSphere>> chosen(parts.size());
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    const auto id = static_cast<SphereId>(first_ + i);
    for (std::size_t part = 0; part < parts.size(); ++part) {
      if (!parts[part].may_touch(spheres_[i], axis_)) continue;
      chosen[part].push_back({spheres_[i], id, owners_[i]});
    }
  }
  return chosen;
}

SphereShare gather_share(std::size_t part, const std::vector<std::vector<SentSphere>>& from_each) {
  SphereShare share;
  for (const std::vector<SentSphere>& from : from_each) {
    for (const auto& [sphere, id, owner] : from) {
      if (owner == part) share.own.push_back(static_cast<SphereId>(share.near.ids.size()));
      share.near.spheres.push_back(sphere);
      share.near.ids.push_back(id);
      share.owner.push_back(owner);
    }
  }
  return share;
}

SphereShare share_of_spheres(const Ranks& ranks, const SphereSet& spheres) {
  SphereBlock block(spheres, static_cast<std::size_t>(ranks.number()),
                    static_cast<std::size_t>(ranks.count()));
  const Box box = join_boxes(ranks.of_all(block.box_of_centers()));
  std::vector<std::uint64_t> all, before;
  ranks.together([&] {
    all = block.count_layers(box);
    before = all;
  });
  ranks.add_up(all);
  ranks.add_up_before(before);
  std::vector<PartExtent> parts;
  ranks.together([&] { parts = block.divide(all, before); });
  join_extents(ranks, parts);
  std::vector<std::vector<SentSphere>> sent;
  ranks.together([&] { sent = block.choose(parts); });
  const std::vector<std::vector<SentSphere>> received = ranks.exchange(sent);
  SphereShare share;
  ranks.together([&] { share = gather_share(static_cast<std::size_t>(ranks.number()), received); });
  return share;
}

}  // namespace vdwmesh
