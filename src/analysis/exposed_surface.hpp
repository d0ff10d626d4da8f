// The boundary of a union of balls as patches, each with its circles and corners, from a cell list;
// distances to it.
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

// A point of a sphere counts as exposed where no other ball covers it by more than this angle,
// roughly: in units of the sphere's radius, behind the radical plane. A corner is wrong by some 10
// roundings over the product of the squared sines at which its three planes meet: this is enough
// down to angles of about 0.1°, and distances are those to a boundary whose radii are wrong by as
// much.
inline constexpr double kExposureTolerance = 1e-10;

// What a neighbour covers of a sphere.
struct Cover {
  arcs::Cap cap;        // relative to the sphere, in units of its radius
  std::uint32_t place;  // of the neighbour, in the cell list
};

// A corner: where the sphere meets two others.
struct Corner {
  Vec3d position;  // relative to the sphere, in units of its radius
  bool first;      // seen from the sphere that comes first of the three
};

// The exposed part of one sphere. Of its covers the first `circles` have exposed arcs.
struct Patch {
  Sphere ball;
  std::uint32_t place;  // in the cell list
  std::uint32_t circles;
  std::span<const Cover> covers;
  std::span<const Corner> corners;
};

class ExposedSurface {
 public:
  // Precondition: not empty. Buried spheres have no patch; of exact duplicates the lowest id has
  // the patch. Time grows with the square of the neighbours that cross a sphere.
  explicit ExposedSurface(const SphereSet& spheres, Monitor* monitor = nullptr);
  ExposedSurface(const ExposedSurface&) = delete;
  ExposedSurface& operator=(const ExposedSurface&) = delete;

  const CellListView& list() const { return list_.view(); }
  std::span<const Patch> patches() const { return patches_; }
  // Whether p is in one of the balls.
  bool contains(const Vec3d& p) const;

 private:
  CellList list_;
  std::vector<Patch> patches_;
  // What the patches refer to, for each block of spheres.
  std::vector<std::vector<Cover>> covers_;
  std::vector<std::vector<Corner>> corners_;
};

inline constexpr std::size_t kNoCover = ~std::size_t{0};

// Whether no cover but `skip` takes the direction, a unit vector from the centre.
inline bool is_exposed(std::span<const Cover> covers, const Vec3d& direction,
                       std::size_t skip = kNoCover) {
  for (std::size_t i = 0; i < covers.size(); ++i) {
    const arcs::Cap& cap = covers[i].cap;
    if (arcs::inner(cap.axis, direction) > cap.cosine + kExposureTolerance && i != skip)
      return false;
  }
  return true;
}

// Lowers `squared` (Å²) to the squared distance from p to the patch, where that is less.
bool improve(const Patch& patch, const Vec3d& p, double& squared);

// Directions at right angles to a unit vector and each other (Duff et al. 2017).
struct Frame {
  Vec3d first, second;
};
inline Frame frame_of(const Vec3d& axis) {
  const double sign = axis.z < 0 ? -1.0 : 1.0;
  const double a = -1 / (sign + axis.z);
  const double b = axis.x * axis.y * a;
  return {{1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x},
          {b, sign + axis.y * axis.y * a, -axis.y}};
}

// Distances from any point of `world` to the surface.
class SurfaceFinder {
 public:
  // Beyond the surface's own box, `world` may be as large as the queries are far.
  SurfaceFinder(const ExposedSurface& surface, const Box& world);

  // Å, >= 0. `hint` is the patch to try first and becomes the one found; it starts at 0.
  double distance(const Vec3d& p, std::uint32_t& hint) const;

 private:
  const ExposedSurface& surface_;
  BoxTree tree_;
};

}  // namespace vdwmesh
