// Meshes one patch on the host: triangulates its boundary in the plane, then runs the steps of
// patch_triangulator.hpp.
#include "creases/patch/patch_mesher.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/lanes/multiversion.hpp"
#include "creases/patch/patch_area.hpp"
#include "creases/plane/flat_boundary.hpp"
#include "creases/plane/patch_triangulator.hpp"
#include "creases/plane/stereographic.hpp"

namespace vdwmesh {

// If a split of one piece was asked for several times, the largest number of halvings counts, then
// the largest cut. It comes first in descending order, and unique() keeps it.
void sort_requests(PatchVector<PieceSplit>& splits) {
  std::sort(splits.begin(), splits.end(), std::greater<>());
  const auto same = [](const PieceSplit& a, const PieceSplit& b) { return a.piece == b.piece; };
  splits.erase(std::unique(splits.begin(), splits.end(), same), splits.end());
}

namespace {

using Outcome = PlaneTriangulation::Outcome;
using Place = PlaneTriangulation::Place;

// The first step of meshing a patch: makes the pieces of its boundary edges of a triangulation in
// the plane. If the last round could triangulate the boundary, only the chains of pieces that have
// come in place of split ones are inserted.
class BoundaryInserter {
 public:
  BoundaryInserter(PatchProgress& progress, const Stereographic& projection,
                   const PatchOptions& options, PatchScratch& scratch)
      : progress_(progress),
        boundary_(progress.boundary),
        projection_(projection),
        options_(options),
        circles_(scratch.circles),
        is_swapped_(scratch.plane_is_swapped),
        plane_(scratch.plane),
        plane_points_(scratch.plane_points) {
    plane_points_.clear();
  }

  // If only validity counts, crossings are looked for before anything is triangulated. This finds
  // all crossings of two curves side by side at once, while insertion ends at the first one. It
  // also saves the triangulation of nearly co-circular points, which is slow.
  //
  // Returns the pieces to be split, some of them more than once: those that cross, that join the
  // same points, or that have a point on them. If there are none, all pieces are edges of the
  // triangulation, and the progress keeps it for the next round. Throws CoincidentPoints,
  // Cancelled.
  std::vector<std::uint32_t> run() && {
    const bool goes_on = std::exchange(progress_.is_triangulated, false);
    if (options_.demand == Demand::validity) want_splits(flat().crossings(options_.monitor));
    if (!to_split_.empty()) return std::move(to_split_);
    const bool is_unchanged = goes_on && progress_.chains.empty();
    if (!(goes_on && insert_chains())) insert_all();
    if (!doubled_.empty()) want_splits(flat().doubles_of(doubled_));
    if (to_split_.empty()) save(is_unchanged);
    return std::move(to_split_);
  }

 private:
  void want_splits(const std::vector<std::uint32_t>& pieces) {
    for (const std::uint32_t piece : pieces) to_split_.push_back(piece);
  }

  // The projected boundary. It is projected when it is first asked for.
  FlatBoundary flat() {
    if (plane_points_.empty()) {
      for (const Vec3d& u : boundary_.points) plane_points_.push_back(projection_.project(u));
    }
    return {boundary_, plane_points_};
  }

  void save(bool is_unchanged) {
    progress_.is_triangulated = true;
    if (!is_swapped_ && !is_unchanged) plane_.save(progress_.plane);
    progress_.chains.clear();
  }

  // Inserts all points, then all pieces up to the first one that crosses another one.
  void insert_all() {
    flat();
    plane_.start(plane_points_, &circles_);
    std::uint32_t near = 0;  // the triangle from which the next point is searched for
    for (const std::uint32_t i : boundary_order(boundary_.points.size())) {
      check_cancelled(options_.monitor, i);
      insert_point(i, near);
      near = plane_.triangle_at(i);
    }
    insert_pieces(0, static_cast<std::uint32_t>(boundary_.pieces.size()));
  }

  // Inserts a point of the boundary, whose triangle is near triangle `near`. Returns false, and
  // inserts nothing, if it lies outside the frame or on a piece.
  bool insert_point(std::uint32_t i, std::uint32_t near) {
    const PlaneTriangulation::Location at = plane_.locate(plane_.point(i), near);
    if (at.place == Place::on_vertex) throw CoincidentPoints();
    if (at.place == Place::outside || plane_.is_on_piece(at)) return false;
    plane_.insert(i, at);
    return true;
  }

  // Goes on with the triangulation of the last round: puts chains of pieces in place of the pieces
  // that were split. Returns false if a point cannot be inserted.
  bool insert_chains() {
    if (is_swapped_) {
      plane_.resume_swapped(points_of_chains(), &circles_);
    } else {
      plane_.resume(progress_.plane, &circles_);
    }
    for (const SplitChain& c : progress_.chains) {
      const std::uint32_t last = c.first_part + c.parts - 2;
      plane_.remove_piece(boundary_.pieces[c.piece].from, boundary_.pieces[last].to);
    }
    for (const SplitChain& c : progress_.chains) {
      if (!insert_points_of(c)) return false;
    }
    for (const SplitChain& c : progress_.chains) {
      const bool crossed = !insert_pieces(c.piece, c.piece + 1) ||
                           !insert_pieces(c.first_part, c.first_part + c.parts - 1);
      if (crossed) break;
    }
    return true;
  }

  std::size_t points_of_chains() const {
    std::size_t count = 0;
    for (const SplitChain& c : progress_.chains) count += c.parts - 1;
    return count;
  }

  bool insert_points_of(const SplitChain& c) {
    std::uint32_t near = plane_.triangle_at(boundary_.pieces[c.piece].from);
    for (std::uint32_t i = c.first_point; i < c.first_point + c.parts - 1; ++i) {
      const std::uint32_t vertex = plane_.add_point(projection_.project(boundary_.points[i]));
      if (!insert_point(vertex, near)) return false;
      near = plane_.triangle_at(vertex);
    }
    return true;
  }

  // Inserts pieces from `begin` up to `end`, or up to the first one that crosses another one, and
  // asks for splits of those that are in the way. Returns false if a piece crosses another one.
  bool insert_pieces(std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t p = begin; p < end; ++p) {
      check_cancelled(options_.monitor, p);
      const Outcome outcome =
          plane_.insert_piece(boundary_.pieces[p].from, boundary_.pieces[p].to, p);
      if (outcome == Outcome::blocked) to_split_.push_back(p);
      if (outcome == Outcome::doubled) doubled_.push_back(p);
      if (outcome == Outcome::crossing) want_splits(flat().crossings_of(p));
      if (outcome == Outcome::crossing) return false;
    }
    return true;
  }

  PatchProgress& progress_;
  const PatchBoundary& boundary_;
  const Stereographic& projection_;
  const PatchOptions& options_;
  const PointCircles& circles_;
  bool is_swapped_;  // plane_ works in the arrays of the progress
  PlaneTriangulation& plane_;
  std::vector<PlanePoint>& plane_points_;
  std::vector<std::uint32_t> to_split_, doubled_;
};

// The steps after the insertion of the boundary.
inline void triangulate(const PatchBoundary& boundary, const PatchOptions& options,
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

}  // namespace

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
  for (const std::uint32_t p : BoundaryInserter(progress, projection, options, scratch).run()) {
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
