// Measures of a triangle mesh by itself: topology, area and volume, quality of its triangles, and
// self-intersections.
//
// The functions read positions and triangles of an IndexedMesh and accept any triangle soup with
// shared vertex indices; `IndexedMesh::opposite` is not used. Sums of areas, volumes, angles and
// lengths are exact and rounded once, so results do not depend on the number of threads, nor on the
// order of the triangles. All but self_intersections() take linear time.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "extract/grid.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Monitor;

// The distribution of n values. p01 and p99 are the 1st and 99th percentile: the values of rank
// ceil(n / 100) and ceil(99 n / 100), counted from 1. All members are NaN if there are no values.
struct Distribution {
  double min, p01, median, p99, max, mean;
};

// A shell is a piece of the mesh whose triangles are connected across edges. Two shells may still
// touch in a vertex.
struct MeshTopology {
  bool closed;  // every edge is on exactly two triangles
  // Every edge is on at most two triangles, the triangles around every vertex form one fan, and no
  // triangle has a repeated index.
  bool manifold;
  bool oriented;  // neighbouring triangles run along their shared edge in opposite directions
  std::uint64_t vertices, edges, triangles;
  std::uint64_t isolated_vertices;  // on no triangle; included in `vertices`, but not in χ
  std::uint64_t shells;
  std::int64_t euler_characteristic;  // χ = V - E + F
  // These two have values for closed, oriented meshes only. The volume of a shell is positive if
  // its triangles face outwards. A shell of volume 0 counts in neither.
  std::optional<std::uint64_t> components;  // shells of positive volume
  std::optional<std::uint64_t> voids;       // shells of negative volume
  // The genus has a value for closed, oriented, manifold meshes only: the sum of the genera of all
  // shells, which is shells - χ/2.
  std::optional<std::int64_t> genus;
};

struct MeshMeasures {
  double area;  // Å²
  // The members below have values for closed, oriented meshes only. The volume is signed: positive
  // if the triangles face outwards.
  std::optional<double> volume;                 // Å³
  std::optional<double> outer_area, void_area;  // Å², of shells of positive and negative volume
};

struct MeshQuality {
  Distribution min_angle_deg;  // smallest angle of each triangle, degrees
  // Circumradius / (2 inradius), 1 for equilateral triangles; degenerate triangles are left out.
  Distribution aspect_ratio;
  Distribution edge_length;            // Å, each edge once
  std::uint64_t degenerate_triangles;  // with a repeated index, or area exactly 0 in double
};

// These three functions throw InvalidInput if a triangle names a vertex that does not exist, and
// LimitExceeded for more than 2^31 - 1 half-edges.
MeshTopology topology(const IndexedMesh& mesh);
MeshMeasures measures(const IndexedMesh& mesh);
MeshQuality quality(const IndexedMesh& mesh);

// Returns the smallest angle of each triangle, in degrees; 0 for degenerate triangles. Throws
// InvalidInput if a triangle names a vertex that does not exist.
std::vector<float> min_angles_deg(const IndexedMesh& mesh);

// The results of topology() and measures() together, in the time of topology() alone.
struct MeshSummary {
  MeshTopology topology;
  MeshMeasures measures;
};
MeshSummary summarize(const IndexedMesh& mesh);

// The results of topology(), measures() and quality() together. The edges are surveyed once,
// not once for each.
struct MeshExamination {
  MeshTopology topology;
  MeshMeasures measures;
  MeshQuality quality;
};
MeshExamination examine(const IndexedMesh& mesh);

// Returns the area of the mesh, in Å², that belongs to each of `sphere_count` spheres. If triangles
// have labels, the area of each goes to its sphere; otherwise a third of it goes to the atom of
// each vertex. The result is empty if the mesh has no labels or names a sphere id of `sphere_count`
// or above.
std::vector<double> mesh_area_by_sphere(const IndexedMesh& mesh, std::size_t sphere_count);

// Extrapolates a measure whose error is of second order in the edge length, given its values at
// some edge length and at half of it (L. F. Richardson, 1911). The error of `fine` is a quarter of
// the error of `coarse`, thus a third of their difference.
constexpr double extrapolate_second_order(double coarse, double fine) {
  return fine + (fine - coarse) / 3;
}

// Counts the pairs of triangles that intersect other than in their shared vertices or their shared
// edge. Vertices are shared by index: triangles that touch in equal positions intersect. Triangles
// of area 0 are left out. The count is exact for all finite coordinates: the signs of volumes are
// computed in double where an error bound proves them, else by CGAL's exact predicates. Throws
// Cancelled if the monitor asks for it, and LimitExceeded where more than ten million intersect.
//
// If the edges are known to be paired, most neighbours need no search. Then the mesh must be closed
// and oriented, as topology() finds. If a grid is given on which marching cubes may have made the
// mesh, the search tries its cells first, which takes an eighth of the time if the mesh lies in
// them. Whether it does is found out, so any grid will do.
enum class MeshEdges : std::uint8_t { unknown, paired };
std::uint64_t self_intersections(const IndexedMesh& mesh, Monitor* monitor = nullptr,
                                 MeshEdges edges = MeshEdges::unknown,
                                 const std::optional<GridSpec>& grid = std::nullopt);
inline MeshEdges edges_of(const MeshTopology& topology) {
  return topology.closed && topology.oriented ? MeshEdges::paired : MeshEdges::unknown;
}

// The pairs that self_intersections() counts, the lower index first, in rising order.
using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
TrianglePairs intersecting_pairs(const IndexedMesh& mesh, Monitor* monitor = nullptr,
                                 MeshEdges edges = MeshEdges::unknown,
                                 const std::optional<GridSpec>& grid = std::nullopt);

}  // namespace vdwmesh
