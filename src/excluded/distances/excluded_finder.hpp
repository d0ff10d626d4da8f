// ExcludedFinder: signed distances from many points to the excluded surface. For the library's own
// use.
//
// Let σ be the signed distance of a point to the accessible surface, positive outside the grown
// balls, and p the probe's radius. docs/excluded_surface.md proves:
//  - Where σ >= 0 or σ <= -p, the signed distance to the excluded surface is σ + p.
//  - Elsewhere it is at least σ + p. Let x be an accessible point nearest to the point, and z the
//    point in which the ray from x through the point leaves the probe at x. If no other probe
//    reaches z, the distance is σ + p. Otherwise it is the distance to the nearest crease or cusp.
//  - It is never more than the distance to the nearest atom.
// So it is for the exterior surface, if the accessible points are those of the outer region alone.
// σ is then the signed distance to that region's border, and negative in cavities too.
#pragma once

#include <optional>
#include <span>

#include "analysis/distances/exposed_surface.hpp"
#include "excluded/distances/judged_surface.hpp"

namespace vdwmesh::excluded {

// What a point's distance comes from, lengths in Å.
struct JudgedPoint {
  double distance;  // as find() writes it
  double depth;     // -σ: the distance from the nearest accessible point; 0 at such points
  std::optional<Vec3d> foot;  // that point; empty if there are several
  double to_curves;           // to the nearest crease or cusp, or the reach if that is less
  bool by_curve;              // `distance` is that to the nearest crease or cusp, and not σ + p
};

class ExcludedFinder {
 public:
  // `accessible` is the boundary of all grown balls of `surface`, `probe` the radius, Å. `world`
  // must contain all grown balls and all later query points. Both surfaces must outlive this.
  ExcludedFinder(const ExposedSurface& accessible, const JudgedSurface& surface, double probe,
                 const Box& world);

  // Writes the signed distance of each point to `found`, Å. The search is fast if consecutive
  // points are near each other.
  void find(std::span<const Vec3d> points, double* found) const;
  // The same with reasons. Creases and cusps are looked for within a reach for each point.
  void judge(std::span<const Vec3d> points, std::span<const double> reach,
             JudgedPoint* found) const;
  double tolerance() const { return tolerance_; }  // Å: distances may be wrong by so much

 private:
  const JudgedSurface& surface_;
  const ByListPlace<SphereId> sphere_of_;
  const double probe_;
  double tolerance_;  // Å
  SurfaceFinder accessible_;
  BoxTree curve_tree_, arc_tree_;
};

}  // namespace vdwmesh::excluded
