// The boundary of a union of balls, as one patch for each exposed sphere, and distances to it.
//
// A patch lists the caps that other balls cover and the corners on its border. This is enough to
// decide whether a direction is exposed and to find the nearest point of the patch. No
// triangulation is needed; neighbours come from a cell list.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "analysis/distances_tree.hpp"
#include "arrangement/arcs/arc_cap.hpp"
#include "core/monitor.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// A point of a sphere counts as covered only if it lies beyond the radical plane of another ball by
// more than this, in units of the sphere's radius. Without a tolerance, rounding would make corners
// seem covered by other balls that meet in the same point. The error of a corner is about 10
// roundings (1e-15) divided by the product of the squared sines of the angles at which its planes
// meet. The tolerance suffices for one angle down to about 0.2°, with sin² = 1e-5. In return the
// distances are distances to a boundary whose radii are changed by about this relative amount.
inline constexpr double kExposureTolerance = 1e-10;

// The part of a sphere that one other ball covers.
struct Cover {
  arcs::Cap cap;        // relative to the sphere, in units of its radius
  std::uint32_t place;  // the list place of the other ball
};

// A corner: an exposed point where the sphere meets two others. All three patches list it.
struct Corner {
  Vec3d position;  // relative to the centre of the sphere, in units of its radius
  bool first;      // whether this sphere has the smallest list place of the three
};

// The exposed part of one sphere.
struct Patch {
  Sphere ball;
  std::uint32_t place;            // the list place of the sphere
  std::uint32_t circles;          // the first so many covers have exposed arcs on their circles
  std::span<const Cover> covers;  // all caps on the sphere, without caps within others
  std::span<const Corner> corners;
};

class ExposedSurface {
 public:
  // Precondition: `spheres` is not empty. Buried spheres have no patch; of equal balls the one with
  // the lowest id has the patch. For n covers of a sphere all n² / 2 pairs are intersected; most
  // intersections are found covered by one of the first caps, at worst all n are compared.
  explicit ExposedSurface(const SphereSet& spheres, Monitor* monitor = nullptr);
  ExposedSurface(const ExposedSurface&) = delete;
  ExposedSurface& operator=(const ExposedSurface&) = delete;

  const CellListView& list() const { return list_.view(); }
  std::span<const Patch> patches() const { return patches_; }
  // Returns whether p is in the interior of some ball.
  bool contains(const Vec3d& p) const;

 private:
  CellList list_;
  std::vector<Patch> patches_;
  // The spans of the patches refer to these arrays, one of each for every block of spheres.
  std::vector<std::vector<Cover>> covers_;
  std::vector<std::vector<Corner>> corners_;
};

inline constexpr std::size_t kNoCover = ~std::size_t{0};

// Returns whether no cover contains the direction, a unit vector from the centre of the sphere. The
// cover with the index `skip` is ignored; points on its circle would be undecided by rounding.
inline bool is_exposed(std::span<const Cover> covers, const Vec3d& direction,
                       std::size_t skip = kNoCover) {
  for (std::size_t i = 0; i < covers.size(); ++i) {
    const arcs::Cap& cap = covers[i].cap;
    if (arcs::inner(cap.axis, direction) > cap.cosine + kExposureTolerance && i != skip)
      return false;
  }
  return true;
}

// Lowers `squared` (Å²) to the squared distance from p to the patch if that is smaller, and returns
// whether it was.
bool update_nearest(const Patch& patch, const Vec3d& p, double& squared);

// Finds the distance from a point to the exposed surface.
class SurfaceFinder {
 public:
  // `world` must contain all balls and all later query points.
  SurfaceFinder(const ExposedSurface& surface, const Box& world);

  // Returns the distance, Å, >= 0. `hint` is the index, in surface.patches(), of the patch that is
  // measured first; a near one makes the search short. It is set to the nearest patch. The caller
  // starts with 0 and passes the same variable for neighbouring points.
  double distance(const Vec3d& p, std::uint32_t& hint) const;

 private:
  const ExposedSurface& surface_;
  BoxTree tree_;
};

}  // namespace vdwmesh
