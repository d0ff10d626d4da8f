// Cells that cover the excluded surface: pieces of the spheres of atoms and probes, and of saddles.
// For the library's own use.
#pragma once

#include <array>
#include <vector>

#include "analysis/distances/exposed_surface.hpp"
#include "excluded/distances/judged_surface.hpp"
#include "surface/vertex_labels.hpp"

namespace vdwmesh::excluded {

struct SurfaceCell {
  std::uint32_t element;  // its number in SurfaceCells: spheres first, then the ranges of saddles
  // Of a sphere: unit vectors to the corners of a spherical triangle within half a sphere. Of a
  // saddle: turn along the arc and profile angle, from the first to the second.
  std::array<Vec3d, 3> corner;
};

// All points of a cell are within `radius` of the middle, Å.
struct CellBall {
  Vec3d middle;
  double radius;
  bool on_surface;       // whether the middle is a point of the surface
  bool may_meet = true;  // whether the cell may have one
};

class SurfaceCells {
 public:
  // Both must outlive this. `probe` in Å.
  SurfaceCells(const JudgedSurface& surface, const ExposedSurface& accessible, double probe);

  // Cells that cover the surface, few and large; pieces of spheres may reach beyond it.
  std::vector<SurfaceCell> all() const;
  CellBall ball_of(const SurfaceCell& cell) const;
  // Adds the parts of a cell.
  void divide(const SurfaceCell& cell, std::vector<SurfaceCell>& parts) const;

 private:
  struct RolledRange {
    std::uint32_t arc;
    ProfileAngles profile;
  };
  CellBall on_sphere(const SurfaceCell& cell) const;
  CellBall on_saddle(const SurfaceCell& cell) const;
  bool is_sphere(const SurfaceCell& cell) const { return cell.element < spheres_.size(); }

  const JudgedSurface& surface_;
  ByListPlace<SphereId> sphere_of_;
  double probe_;
  std::vector<std::vector<Cover>> covers_;  // of concave patches
  std::vector<Patch> spheres_;              // contact patches, of the atoms; then concave ones
  std::size_t contacts_;
  std::vector<RolledRange> saddles_;
};

}  // namespace vdwmesh::excluded
