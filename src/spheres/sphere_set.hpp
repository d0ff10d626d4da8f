// SphereSet: the balls whose union is the molecule. All lengths are in Å.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3.hpp"

namespace vdwmesh {

// Index of a sphere in its SphereSet.
using SphereId = std::uint32_t;
inline constexpr SphereId kNoSphere = 0xffffffffu;  // stands for no sphere

struct Sphere {
  Vec3d center;   // Å
  double radius;  // Å
};

struct Box {
  Vec3d lower, upper;  // Å
};

// Largest magnitude of a coordinate, and largest radius, that a SphereSet accepts, Å. Cubes of such
// numbers, and boxes around such balls, are finite in double.
inline constexpr double kFarthestSphere = 1e30;

// Spheres in the caller's order. They are checked when they enter the set: every coordinate is
// between -kFarthestSphere and kFarthestSphere, every radius is above 0 and at most
// kFarthestSphere, and there are at most 2^32 - 2 spheres. A set owns its spheres or looks at
// spheres that the caller owns.
class SphereSet {
 public:
  SphereSet() = default;
  SphereSet(const SphereSet& other);
  SphereSet(SphereSet&& other) noexcept { swap(other); }
  SphereSet& operator=(SphereSet other) noexcept {
    swap(other);
    return *this;
  }

  // Takes the spheres. Throws InvalidInput if there are too many, or with the number of the first
  // sphere that breaks a rule above. So do all functions of the class that take coordinates.
  explicit SphereSet(std::vector<Sphere> spheres);

  // A set that looks at the caller's spheres without a copy. The spheres must outlive the set and
  // its copies, and must not change; after a change, the caller makes a new view.
  static SphereSet view(std::span<const Sphere> spheres);
  // The same for an array of rows (x, y, z, radius), Å. Throws InvalidInput also if the number of
  // elements is not a multiple of 4.
  static SphereSet view(std::span<const double> rows);

  // Moves the spheres to new centres (Å), one per sphere in the same order; the radii stay. The set
  // owns its spheres afterwards, and further calls reuse their memory, so one set can serve all
  // frames of a trajectory. Throws InvalidInput also if the number of centres is not size(). If the
  // function throws, the set is unchanged.
  void move_to(std::span<const Vec3d> centers);

  std::size_t size() const { return spheres_.size(); }
  bool empty() const { return spheres_.empty(); }
  const Sphere& operator[](std::size_t i) const { return spheres_[i]; }
  std::span<const Sphere> spheres() const { return spheres_; }

  // A number for the contents. A default-constructed set has 0, and a copy has the number of its
  // original; every other way to make or change a set gives it a new number. So sets of equal
  // revision have equal spheres, and what was computed for one is valid for the other.
  std::uint64_t revision() const { return revision_; }

 private:
  void swap(SphereSet& other) noexcept;

  std::vector<Sphere> owned_;        // empty if the set looks at the caller's spheres
  std::span<const Sphere> spheres_;  // all of owned_, or the caller's spheres
  std::uint64_t revision_ = 0;
};

// The balls with `by` (Å) added to every radius. Throws InvalidInput as the constructor does.
SphereSet grown(std::span<const Sphere> balls, double by);

// The smallest box around the balls, and the smallest box around their centres. Precondition: the
// set is not empty.
Box bounding_box(const SphereSet& spheres);
Box center_bounding_box(const SphereSet& spheres);

// The ids sorted by (x, y, z, radius, id). All stages break exact ties in this order, so that
// permuted spheres give the same mesh with permuted labels. The second form overwrites an existing
// array.
std::vector<SphereId> canonical_order(const SphereSet& spheres);
void canonical_order(const SphereSet& spheres, std::vector<SphereId>& order);

}  // namespace vdwmesh
