// The boundary of a union of balls, as one patch for each exposed sphere, and distances to it.
//
// The patches (patch.hpp) are enough to decide whether a direction is exposed and to find the
// nearest point. No triangulation is needed: a cell list gives the neighbours of each sphere.
// Spheres are named by their list places, their indices in this cell list (ExposedSurface::list()).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/distances/distances_tree.hpp"
#include "analysis/distances/surface_search.hpp"
#include "analysis/survey/patch.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

class Monitor;

class ExposedSurface {
 public:
  // Precondition: `spheres` is not empty. Spheres without exposed points have no patch; of equal
  // balls the one with the lowest id has the patch. For a sphere with n covers the circles of all
  // n² / 2 pairs are intersected. Each intersection is compared with caps until one covers it:
  // mostly one of the first, because large caps come first, and at worst all n. Where n is large,
  // covers that others cover together are left out before, in the time of a power cell.
  explicit ExposedSurface(const SphereSet& spheres, Monitor* monitor = nullptr);
  ExposedSurface(const ExposedSurface&) = delete;
  ExposedSurface& operator=(const ExposedSurface&) = delete;

  const CellListView& list() const { return list_.view(); }
  std::span<const Patch> patches() const { return std::span(patches_).first(exposed_); }
  // These patches, and behind them one without an exposed point for each sphere that other balls
  // cover together. The inside of such a ball may be covered by no other, so whether a point is
  // outside of the union depends on it.
  std::span<const Patch> searched() const { return patches_; }

 private:
  CellList list_;
  std::vector<Patch> patches_;
  std::size_t exposed_ = 0;  // of the patches: those with exposed points, which come first
  // The patches point into these arrays: one inner vector for each block of spheres.
  std::vector<std::vector<Cover>> covers_;
  std::vector<std::vector<SphereCorner>> corners_;
};

// Finds signed distances from points to the exposed surface.
class SurfaceFinder {
 public:
  // `world` must contain all balls and all later query points.
  SurfaceFinder(const ExposedSurface& surface, const Box& world);

  // Writes the signed distance of each point to `found`, Å: positive outside the union, negative
  // inside. The search is fast if consecutive points are near each other.
  void find(std::span<const Vec3d> points, double* found) const;

  // Returns the larger of `largest` and the largest unsigned distance of the points, Å, as find()
  // computes it. Points whose distance is proven to be at most the largest so far are not searched
  // for, so a maximum alone costs a small part of all distances.
  double largest_distance(std::span<const Vec3d> points, double largest) const;

  // Writes the ball of least gap of each point: the first half of find(), from which the functions
  // of surface_search.hpp go on.
  void find_gaps(std::span<const Vec3d> points, LeastGap* found) const;

  const PatchTreeView& view() const { return view_; }

 private:
  std::vector<Sphere> balls_;  // of the patches
  BoxTree tree_;
  PatchTreeView view_;
};

}  // namespace vdwmesh
