// Which spheres each rank measures, and which it needs for that.
//
// The spheres are numbered layer by layer across the longest axis of the set, in their order within
// a layer, and each part has a run of these numbers. The parts have equal numbers of spheres, but
// for one. They lie one behind the other along the axis, so that few spheres are near to two parts.
// No rank looks at all spheres: each looks at a run of them, in blocks that its cores take, and
// tells the parts which of these they need. Ids are enough, since every rank has the whole set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "distributed/ranks.hpp"
#include "distributed/shares/chosen_spheres.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

struct SphereShare {
  ChosenSpheres near;                // the share, and all spheres that overlap or touch one of it
  std::vector<SphereId> own;         // the share, as indices of near.spheres, ascending
  std::vector<std::uint32_t> owner;  // [i]: the part that has near.spheres[i] in its share
};

// The share of this rank. It is empty if there are fewer spheres than ranks. Precondition: the set
// is the same on all ranks and not empty. Collective.
SphereShare share_of_spheres(const Ranks& ranks, const SphereSet& spheres);

// The interval along the axis that the spheres of a part take, Å, and the largest of their radii.
struct PartExtent {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower, radius = 0;

  void add(const PartExtent& other);
  void add(const Sphere& s, int axis);
  bool may_touch(const Sphere& s, int axis) const;
};

// A sphere as a part is told of it: its id, and the part that has it in its share.
struct NamedSphere {
  SphereId id;
  std::uint32_t owner;
};

// A run of the spheres. The functions are called one after the other; each says what it needs from
// all blocks, which have all spheres together, in their order.
class SphereBlock {
 public:
  // The spheres `first` up to `end`, of which each is to be in one of so many parts.
  SphereBlock(const SphereSet& spheres, std::size_t first, std::size_t end, std::size_t parts);

  Box box_of_centers() const;
  // How many spheres of the block each layer has. `box` is around all centres.
  std::vector<std::uint64_t> count_layers(const Box& box);
  // What each part has of this block. `all` are the sums of the counts over all blocks, `before`
  // those over the blocks before this one.
  std::vector<PartExtent> divide(std::span<const std::uint64_t> all,
                                 std::span<const std::uint64_t> before);
  // The spheres that each part needs. `parts` are the extents of the parts, of all blocks together.
  std::vector<std::vector<NamedSphere>> choose(std::span<const PartExtent> parts) const;

 private:
  std::size_t first_, all_, parts_;  // the first sphere of the block; all spheres; all parts
  std::span<const Sphere> spheres_;  // of the block
  int axis_ = 0;
  std::vector<std::uint16_t> layers_;  // by sphere of the block
  std::vector<std::uint32_t> owners_;  // likewise
};

// What this part was told, [i]: by rank i.
SphereShare gather_share(std::size_t part, const SphereSet& spheres,
                         const std::vector<std::vector<NamedSphere>>& from_each);

}  // namespace vdwmesh
