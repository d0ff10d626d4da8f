// What the meshing of one patch needs besides its boundary: its arrays, in growing or in bounded
// memory (patch_memory.hpp).
#pragma once

#include <array>
#include <cstdint>

#include "creases/plane/patch_triangles.hpp"
#include "creases/plane/plane_triangulation.hpp"

namespace vdwmesh {

// Why pieces of the boundary are split: to make the triangles valid and well shaped (`quality`), or
// only to make them valid (`validity`). A triangle is valid if it faces outwards and would not fold
// over when arcs replace its chords.
enum class Demand : std::uint8_t { quality, validity };

// How far a patch is meshed: only its boundary is triangulated and tested for pieces to split, or
// all of it is meshed.
enum class PatchStage : std::uint8_t { boundary, triangles };

// How much there is of a patch, and room for how many points.
struct PatchSizes {
  std::uint32_t points, pieces, caps, through;  // of the boundary
  std::uint32_t plane_triangles;                // of its triangulation in the plane; 0: none yet
  std::uint32_t most_points;                    // of the boundary and inside

  VDWMESH_HD std::uint32_t plane_points() const { return points + 3; }
};

// A triangle and its vertices when it was queued. Insertions change triangles, so one whose
// vertices have changed is another triangle.
struct TriangleCandidate {
  std::uint32_t triangle;
  std::array<std::uint32_t, 3> vertices;
};

// An edge that is no piece of the boundary, seen from one of its two triangles.
struct InnerEdge {
  TriangleCandidate candidate;
  std::uint32_t opposite;  // the corner that is no end of the edge
};

template <class Memory>
struct PatchWork {
  template <class T>
  using Array = typename Memory::template Array<T>;

  PatchWork() = default;
  VDWMESH_HD explicit PatchWork(const Memory& memory) : plane(memory) {}

  PointCirclesOf<Memory> circles;
  PlaneTriangulationOf<Memory> plane;
  SmoothingScratchOf<Memory> smoothing;
  PatchTrianglesOf<Memory> patch;
  Array<std::uint32_t> numbers;  // by triangle or by point
  Array<double> margins;         // by cap: the cosine of its angular radius with its margin
  Array<TriangleCandidate> queue;
  Array<InnerEdge> inner_edges;
  Array<std::uint32_t> pieces;
  // The outcome, as in PatchMesh; but a piece may have several requests.
  Array<PieceSplit> splits;
  Array<Vec3d> interior;
  Array<std::array<std::uint32_t, 3>> triangles;

  // Calls visit(array, kind) for arrays, to give bounded ones their memory: for those that
  // PatchStage::boundary needs besides the triangulation's state, and for all.
  template <class Visit>
  VDWMESH_HD void visit_boundary_scratch(const Visit& visit) {
    circles.visit_arrays(visit);
    plane.visit_scratch(visit);
    visit(patch.points, PatchArray::points);
    visit(numbers, PatchArray::triangles);
    visit(pieces, PatchArray::requests);
    visit(splits, PatchArray::requests);
  }
  template <class Visit>
  VDWMESH_HD void visit_arrays(const Visit& visit) {
    visit_boundary_scratch(visit);
    plane.visit_state(visit);
    smoothing.stars.visit_arrays([&](auto& rows) { visit(rows, PatchArray::star_rows); },
                                 [&](auto& entries) { visit(entries, PatchArray::star_entries); });
    visit(smoothing.changed, PatchArray::lists);
    visit(smoothing.sweep, PatchArray::lists);
    visit(patch.triangles, PatchArray::triangles);
    visit(margins, PatchArray::caps);
    visit(queue, PatchArray::queue);
    visit(inner_edges, PatchArray::lists);
    visit(interior, PatchArray::points);
    visit(triangles, PatchArray::triangles);
  }
};

}  // namespace vdwmesh
