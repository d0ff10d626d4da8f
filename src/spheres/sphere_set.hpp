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
inline constexpr SphereId kNoSphere = 0xffffffffu;  // stands for no sphere

struct Sphere {
  Vec3d center;   // Å
  double radius;  // Å
};

struct Box {
  Vec3d lower, upper;  // Å
};

// Largest coordinate, either way, and largest radius that a SphereSet takes, Å: their cubes and the
// boxes around them are finite. Readers of files take less, what meshes keep their digits to.
inline constexpr double kFarthestSphere = 1e30;

// Spheres in the caller's order, checked once: every coordinate at most kFarthestSphere from 0,
// every radius above 0 and at most kFarthestSphere, at most 2^32 - 2 of them. A set owns its
// spheres or looks at spheres that the caller owns.
class SphereSet {
 public:
  SphereSet() = default;
  SphereSet(const SphereSet& other);
  SphereSet(SphereSet&& other) noexcept { swap(other); }
  SphereSet& operator=(SphereSet other) noexcept {
    swap(other);
    return *this;
  }

  // Takes the spheres. Throws InvalidInput naming the first sphere that breaks the rule, as all
  // functions here do that take coordinates.
  explicit SphereSet(std::vector<Sphere> spheres);

  // Looks at the caller's spheres without a copy. They must outlive the set and its copies, and
  // must not change: after a change, look at them anew.
  static SphereSet view(std::span<const Sphere> spheres);
  // The same for an array of rows x, y, z, radius (shape (n, 4), Å). Throws InvalidInput if it does
  // not have four numbers for each row.
  static SphereSet view(std::span<const double> rows);

  // Moves the spheres to new centres (Å), in the same order; the radii stay. The set owns its
  // spheres afterwards and keeps their memory, so the frames of a trajectory go through one set.
  // Nothing changes if it throws, which it also does for another number of centres.
  void move_to(std::span<const Vec3d> centers);

  std::size_t size() const { return spheres_.size(); }
  bool empty() const { return spheres_.empty(); }
  const Sphere& operator[](std::size_t i) const { return spheres_[i]; }
  std::span<const Sphere> spheres() const { return spheres_; }

  // A number for the contents: a copy has its original's, and every other way to make or change a
  // set gives a new one. What was computed for a set is good for all sets of the same revision.
  std::uint64_t revision() const { return revision_; }

 private:
  void swap(SphereSet& other) noexcept;

  std::vector<Sphere> owned_;        // empty if the set looks at the caller's spheres
  std::span<const Sphere> spheres_;  // all of owned_, or the caller's
  std::uint64_t revision_ = 0;
};

// Smallest box around the balls, and around their centres alone. Precondition: not empty.
Box bounding_box(const SphereSet& spheres);
Box center_bounding_box(const SphereSet& spheres);

// Ids sorted by (x, y, z, r, id): the order that breaks every exact tie, so that a permuted input
// gives the same mesh with permuted labels. The second form fills an array that is there.
std::vector<SphereId> canonical_order(const SphereSet& spheres);
void canonical_order(const SphereSet& spheres, std::vector<SphereId>& order);

}  // namespace vdwmesh
