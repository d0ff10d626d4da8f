// FootOracle: the point of the excluded surface nearest to a point that is near it. For the
// library's own use.
//
// A foot of x is a nearest point on a sphere of a grown atom, on the circle on which a probe rolls,
// or a probe's centre, if no grown atom covers it: a probe can stand there. Let f be the foot
// nearest to x, at the distance d, and p the probe's radius. The surface is where d = p, and its
// outward normal there points to f. For x near the surface, the point y at the distance p from f
// on the ray from f to x is the nearest one, unless another probe reaches y; then y is tried in
// place of x, which ends on the crease between the two.
//
// Completeness: the foot of a point of a patch is of that patch, and it is at most twice as far
// from that of a point x near by as x is from the surface; so the patches with a point within the
// reach are enough for all x within the reach.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "remesh/cell_lists.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::remesh {

// A vertex is on the surface if its foot is as far as the probe's radius up to this, Å.
inline constexpr double kOnSurface = 1e-10;

struct Foot {
  Vec3d point;          // on the surface, Å
  Vec3d normal;         // outward unit normal there
  double height;        // Å: height of x above the surface, negative inside the solid
  std::uint32_t patch;  // on which the point is
};

class FootOracle {
 public:
  // `surface` is the exact mesh of these atoms, `reach` how far from it points may be, Å. The
  // surface must outlive this.
  FootOracle(const PatchedMesh& surface, const SphereSet& atoms, double probe, double reach);

  double probe() const { return probe_; }
  // The nearest foot; with a hint (an outward direction) only of those whose normal is at most 90°
  // from it, so that a point near a thin wall keeps to its side. Empty if there is none.
  std::optional<Foot> nearest(const Vec3d& x, const Vec3d* hint) const;
  // A point of the surface, near x and on the side of the hint. Empty if none was found.
  std::optional<Foot> project(const Vec3d& x, const Vec3d& hint) const;
  bool is_on_surface(const Vec3d& x) const;

 private:
  bool is_covered(const Vec3d& x) const;
  void list_patches(const PatchedMesh& surface);
  void list_atoms();

  const std::vector<SurfacePatch>& patches_;
  std::vector<Sphere> grown_;
  double probe_, reach_;
  CellLists near_;                         // patches by cell
  CellLists covers_;                       // grown atoms by cell
  std::vector<std::uint8_t> all_covered_;  // by cell: one grown atom covers all of it
};

}  // namespace vdwmesh::remesh
