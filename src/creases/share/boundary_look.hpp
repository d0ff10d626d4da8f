// The first look at the boundary of a patch, in memory of fixed capacity: its points and pieces are
// triangulated in the plane, and pieces that are too long for the patch are found. For host and
// device; a kernel looks at one boundary with each thread.
//
// A look makes the bits of mesh_patch() with Demand::quality and PatchStage::boundary, but for the
// splits for the area, which need the boundary alone and are left to the host. It fails at what
// happens to few boundaries: pieces that cross, double or block each other, points on pieces, and
// all that bounded memory fails at (patch_memory.hpp). Then the host looks at the boundary itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "creases/plane/bounded_patch.hpp"
#include "creases/plane/piece_insertion.hpp"

namespace vdwmesh {

// The sizes of a boundary that has no triangulation yet and gets no points inside.
inline PatchSizes look_sizes(const PatchBoundary& b) {
  const auto count = [](const auto& list) { return static_cast<std::uint32_t>(list.size()); };
  return {count(b.points), count(b.pieces), count(b.caps), count(b.through), 0, count(b.points)};
}

// Where the arrays of a look begin, in bytes. Its state is the triangulation that it leaves: the
// arrays of PlaneTypes::State, which are full. PlaneTypes::State::largest is the abscissa of the
// frame's second corner, points[1].
struct BoundedLook {
  PatchSizes sizes;
  std::uint64_t input, state, work;
  double edge_length;  // as in PatchOptions
};

struct LookMemory {
  std::byte *input, *state, *work;
};

// The memory of a look besides its input and its state: the scratch arrays, and the image of the
// boundary's points.
VDWMESH_HD inline std::span<PlanePoint> place_look(const PatchSizes& sizes, PatchFailure* failure,
                                                   ArrayPlaces& places,
                                                   PatchWork<BoundedMemory>& work) {
  work.visit_boundary_scratch(ArrayPlacer{sizes, failure, places});
  return {places.next<PlanePoint>(sizes.points), sizes.points};
}

// Inserts all points and then all pieces, in their order, as mesh_patch() does with few points.
// Returns false at the first one that cannot be inserted.
VDWMESH_HD inline bool insert_all(const PatchBoundaryView& boundary,
                                  std::span<const PlanePoint> plane_points,
                                  PatchWork<BoundedMemory>& work) {
  PlaneTriangulationOf<BoundedMemory>& plane = work.plane;
  plane.start(plane_points, &work.circles);
  std::uint32_t near = 0;  // the triangle from which the next point is searched for
  for (std::uint32_t i = 0; i < boundary.points.size() && !plane.has_failed(); ++i) {
    const PlaneTypes::Location at = plane.locate(plane.point(i), near);
    const bool is_free =
        at.place == PlaneTypes::Place::inside || at.place == PlaneTypes::Place::on_edge;
    if (!is_free) return false;
    plane.insert(i, at);
    near = plane.triangle_at(i);
  }
  for (std::uint32_t p = 0; p < boundary.pieces.size() && !plane.has_failed(); ++p) {
    const BoundaryPiece& piece = boundary.pieces[p];
    if (plane.insert_piece(piece.from, piece.to, p) != PlaneTypes::Outcome::inserted) return false;
  }
  return !plane.has_failed();
}

// Looks at one boundary. The outcome has requests, with repetitions, and neither points inside nor
// triangles; the triangulation is in its part of the states. Precondition: fewer than
// kReorderedPoints points.
VDWMESH_HD inline PatchOutcome look_at_boundary(const BoundedLook& look, const LookMemory& memory) {
  const PatchSizes& n = look.sizes;
  ArrayPlaces inputs(memory.input + look.input), states(memory.state + look.state),
      arrays(memory.work + look.work);
  PatchInput in;
  place_boundary(n, inputs, in);
  const PatchBoundaryView boundary = in.view(n);
  PatchFailure failure = PatchFailure::none;
  PatchWork<BoundedMemory> work{BoundedMemory(&failure)};
  const std::span<PlanePoint> plane_points = place_look(n, &failure, arrays, work);
  work.plane.visit_state(ArrayPlacer{n, &failure, states});
  work.circles.assign(boundary);
  const Stereographic projection(buried_pole(boundary));
  for (std::uint32_t i = 0; i < n.points; ++i) {
    plane_points[i] = projection.project(boundary.points[i]);
  }
  PatchOutcome outcome{};
  if (!insert_all(boundary, plane_points, work)) {
    outcome.failure = failure == PatchFailure::none ? PatchFailure::not_simple : failure;
    return outcome;
  }
  FixedLattice no_lattice{};
  triangulator::PatchTriangulator<BoundedMemory, FixedLattice>(boundary, look.edge_length,
                                                               no_lattice, work, nullptr)
      .run(Demand::quality, PatchStage::boundary);
  outcome.failure = failure;
  outcome.splits = static_cast<std::uint32_t>(work.splits.size());
  outcome.first_split = work.splits.data();
  return outcome;
}

}  // namespace vdwmesh
