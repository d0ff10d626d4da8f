// The boundary of a union of balls, as one patch for each exposed sphere, and distances to it.
//
// A point of a sphere is exposed if no other ball covers it. The patch of a sphere is its exposed
// part; it lists the caps that other balls cover and the corners on its border. This is enough to
// decide whether a direction is exposed and to find the nearest point of the patch. No
// triangulation is needed: a cell list gives the neighbours of each sphere. Spheres are named by
// their list places, their indices in this cell list (ExposedSurface::list()).
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
// more than this, in units of the sphere's radius. Without a tolerance, rounding could make a
// corner seem covered by a further ball whose sphere passes through the same point. The error of a
// corner is about 10 roundings (1e-15) divided by the product of the squared sines of the angles at
// which its planes meet. The tolerance suffices if one of these angles is as small as 0.2°, where
// sin² = 1e-5. Its price: distances are measured to a boundary whose radii are changed by about
// this relative amount.
inline constexpr double kExposureTolerance = 1e-10;

// The part of a sphere that one other ball covers.
struct Cover {
  arcs::Cap cap;        // relative to the sphere, in units of its radius
  std::uint32_t place;  // the list place of the other ball
};

// A corner: an exposed point where the sphere meets two others. All three patches list it.
struct Corner {
  Vec3d position;  // relative to the centre of the sphere, in units of its radius
  bool first;      // whether the sphere of this patch has the smallest list place of the three
};

// The exposed part of one sphere.
struct Patch {
  Sphere ball;
  std::uint32_t place;  // the list place of the sphere
  // The circle of a cover is the border of its cap. Exactly the covers [0, circles) have exposed
  // arcs on their circles.
  std::uint32_t circles;
  std::span<const Cover> covers;  // all caps on the sphere, without caps within others
  std::span<const Corner> corners;
};

class ExposedSurface {
 public:
  // Precondition: `spheres` is not empty. Buried spheres have no patch; of equal balls the one with
  // the lowest id has the patch. For a sphere with n covers the circles of all n² / 2 pairs are
  // intersected. Each intersection is compared with caps until one covers it: mostly one of the
  // first, because large caps come first, and at worst all n.
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
  // The spans of the patches refer to these arrays: one inner vector for each block of spheres.
  std::vector<std::vector<Cover>> covers_;
  std::vector<std::vector<Corner>> corners_;
};

inline constexpr std::size_t kNoCover = ~std::size_t{0};

// Returns whether no cover contains the direction, a unit vector from the centre of the sphere. The
// cover with the index `skip` is ignored. Callers name the cover on whose circle the point lies,
// because there rounding alone would decide.
inline bool is_exposed(std::span<const Cover> covers, const Vec3d& direction,
                       std::size_t skip = kNoCover) {
  for (std::size_t i = 0; i < covers.size(); ++i) {
    const arcs::Cap& cap = covers[i].cap;
    if (arcs::inner(cap.axis, direction) > cap.cosine + kExposureTolerance && i != skip)
      return false;
  }
  return true;
}

// Lowers `squared` (Å²) to the squared distance from p to the patch if that distance is smaller.
// Returns whether `squared` was lowered.
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
