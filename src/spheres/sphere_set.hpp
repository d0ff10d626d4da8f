// The balls whose union is the molecule. Lengths in Å.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.hpp"

namespace vdwmesh {

// Index of a sphere in the SphereSet it came from.
using SphereId = std::uint32_t;
inline constexpr SphereId kNoSphere = 0xffffffffu;

struct Sphere {
  Vec3d center;   // Å
  double radius;  // Å
};

struct Box {
  Vec3d lower, upper;
};

// Largest coordinate, either way, and largest radius that a SphereSet takes, Å: their cubes and the
// boxes around them are finite. Readers of files take less, what meshes keep their digits to.
inline constexpr double kFarthestSphere = 1e30;

// Spheres in the caller's order, checked once: every coordinate at most kFarthestSphere from 0,
// every radius above 0 and at most kFarthestSphere, at most 2^32 - 2 of them.
class SphereSet {
 public:
  SphereSet() = default;
  // Throws InvalidInput naming the first sphere that breaks the rule.
  explicit SphereSet(std::vector<Sphere> spheres);

  std::size_t size() const { return spheres_.size(); }
  bool empty() const { return spheres_.empty(); }
  const Sphere& operator[](std::size_t i) const { return spheres_[i]; }
  std::span<const Sphere> spheres() const { return spheres_; }

 private:
  std::vector<Sphere> spheres_;
};

// Smallest box around the balls, and around their centres alone. Precondition: not empty.
Box bounding_box(const SphereSet& spheres);
Box center_bounding_box(const SphereSet& spheres);

// Ids sorted by (x, y, z, r, id): the order that breaks every exact tie, so that a permuted input
// gives the same mesh with permuted labels.
std::vector<SphereId> canonical_order(const SphereSet& spheres);

}  // namespace vdwmesh
