// Meshes one patch on the host: triangulates its boundary in the plane (boundary_insertion.cpp),
// then runs the steps of patch_triangulator.hpp.
#include "arrangement/mesher/patch_mesher.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "arrangement/mesher/boundary_insertion.hpp"
#include "arrangement/mesher/flat_boundary.hpp"
#include "arrangement/mesher/patch_area.hpp"
#include "arrangement/mesher/patch_triangulator.hpp"
#include "core/multiversion.hpp"

namespace vdwmesh {

// If a split of one piece was asked for several times, the largest number of halvings counts, then
// the largest cut. It comes first in descending order, and unique() keeps it.
void sort_requests(PatchVector<PieceSplit>& splits) {
  std::sort(splits.begin(), splits.end(), std::greater<>());
  const auto same = [](const PieceSplit& a, const PieceSplit& b) { return a.piece == b.piece; };
  splits.erase(std::unique(splits.begin(), splits.end(), same), splits.end());
}

// The steps after the insertion of the boundary.
static inline void triangulate(const PatchBoundary& boundary, const PatchOptions& options,
                               PatchScratch& scratch, PatchMesh& mesh) {
  triangulator::PatchTriangulator<GrowingMemory, SpherePoints> triangulator(
      boundary, options.edge_length, scratch.lattice, scratch, options.monitor,
      options.widest_view);
  std::optional<AngleBound> bound;
  if (options.min_angle > 0 && options.stage == PatchStage::triangles) {
    bound.emplace(boundary, options.min_angle, options.edge_length);
    if (options.demand == Demand::quality && options.splits_for_angles)
      triangulator.bound_angles(*bound);
  }
  std::optional<AngleFloors> floors;
  if (options.arcs) {
    floors.emplace(boundary, *options.arcs, options.edge_length);
    if (options.raises_angles) triangulator.keep_floors(*floors);
  }
  const bool has_small_angle = triangulator.run(options.demand, options.stage);
  mesh.interior = scratch.interior;
  mesh.triangles = scratch.triangles;
  mesh.splits = scratch.splits;
  if (bound && mesh.splits.empty()) mesh.below = bound->count(scratch.patch);
  if (floors && has_small_angle) mesh.below_floor = floors->count(scratch.patch);
}

// The frame has three corners.
void make_room_for_splits(std::size_t points, PlaneTriangulation::State& plane) {
  points = with_room_for_splits(points);
  plane.points.reserve(points + 3);
  plane.star.reserve(points + 3);
  plane.triangles.reserve(2 * points + 1);
}

VDWMESH_MULTIVERSION PatchMesh mesh_patch(PatchProgress& progress, const PatchOptions& options,
                                          PatchScratch& scratch) {
  const PatchBoundary& boundary = progress.boundary;
  scratch.circles.assign(boundary);
  const Stereographic projection(buried_pole(boundary));
  // A test of the boundary adds nothing that the next round may not have, so it needs no copy.
  scratch.plane_is_swapped = options.stage == PatchStage::boundary;
  if (scratch.plane_is_swapped) {
    if (!progress.is_triangulated) make_room_for_splits(boundary.points.size(), progress.plane);
    scratch.plane.swap(progress.plane);
  }
  PatchMesh mesh;
  for (const std::uint32_t p : insert_boundary(progress, projection, options, scratch)) {
    mesh.splits.push_back({boundary.pieces[p].source, 1});
  }
  if (mesh.splits.empty()) {
    triangulate(boundary, options, scratch, mesh);
  }
  if (options.area > 0 && options.demand == Demand::quality &&
      options.stage == PatchStage::boundary) {
    split_for_area(boundary, options.area, options.edge_length, mesh.splits);
  }
  if (scratch.plane_is_swapped) scratch.plane.swap(progress.plane);
  sort_requests(mesh.splits);
  mesh.exact_tests = scratch.plane.exact_tests();
  return mesh;
}

}  // namespace vdwmesh
