// What a triangle mesh is, by itself: size, topology, quality.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Percentiles by nearest rank: the value of rank ceil(p n), exact. All NaN where there are no
// values.
struct Distribution {
  double min, p01, median, p99, max, mean;
};

// Triangles are connected where they share an edge; two shells may still touch in a vertex.
struct MeshTopology {
  bool closed;    // every edge on two triangles
  bool manifold;  // every edge on at most two triangles, every vertex one fan
  bool oriented;  // neighbours run their shared edge in opposite directions
  std::uint64_t vertices, edges, triangles;
  std::uint64_t isolated_vertices;    // on no triangle; counted in `vertices`, not in χ
  std::uint64_t shells;               // connected pieces
  std::int64_t euler_characteristic;  // V - E + F
  // Of closed, oriented meshes only; shells of volume 0 are neither:
  std::optional<std::uint64_t> components;  // shells of positive volume
  std::optional<std::uint64_t> voids;       // shells of negative volume
  // Of closed, oriented, manifold meshes only:
  std::optional<std::int64_t> genus;  // shells - χ/2
};

struct MeshMeasures {
  double area;                   // Å²
  std::optional<double> volume;  // Å³, signed, outward normals positive; closed oriented only
  std::optional<double> outer_area, void_area;  // Å², of shells of positive and negative volume
};

struct MeshQuality {
  Distribution min_angle_deg;  // smallest angle of each triangle, degrees
  Distribution aspect_ratio;   // circumradius / (2 inradius): 1 is equilateral; areas > 0 only
  Distribution edge_length;    // Å, each edge once
  std::uint64_t degenerate_triangles;  // a repeated index, or area exactly 0 in double
};

// Positions, triangles; any triangle soup with shared indices (`opposite` is not looked at). Sums
// are wide, about the middle of the mesh's box and in triangle order, the same for any number of
// threads. Linear time. All throw InvalidInput for an index of no vertex, LimitExceeded beyond
// 2^31 - 1 half-edges.
MeshTopology topology(const IndexedMesh& mesh);
MeshMeasures measures(const IndexedMesh& mesh);
MeshQuality quality(const IndexedMesh& mesh);

// The smallest angle of each triangle, degrees; 0 for degenerate ones. Throws InvalidInput
// for an index of no vertex.
std::vector<float> min_angles_deg(const IndexedMesh& mesh);

// topology() and measures() from one survey of the edges, in the time of topology().
struct MeshSummary {
  MeshTopology topology;
  MeshMeasures measures;
};
MeshSummary summarize(const IndexedMesh& mesh);

// All three, with the edges gathered once: in two thirds of the time that they take apart.
struct MeshExamination {
  MeshTopology topology;
  MeshMeasures measures;
  MeshQuality quality;
};
MeshExamination examine(const IndexedMesh& mesh);

// Å² of the mesh that belong to each of `sphere_count` spheres: a triangle's area goes to its own
// sphere where triangles name them, else in thirds to the atoms of its vertices. Sums are wide.
// Empty when the mesh does not say whose it is, or names a sphere beyond the set. Linear time.
std::vector<double> mesh_area_by_sphere(const IndexedMesh& mesh, std::size_t sphere_count);

// What a measure of second order in the edge length tends to, from its values at some edge length
// and at half of it: its error is 4 times smaller there (Richardson 1911).
constexpr double extrapolate_second_order(double coarse, double fine) {
  return fine + (fine - coarse) / 3;
}

// Pairs of triangles that intersect other than in a shared vertex or edge (CGAL, exact
// predicates). Triangles of area 0 are left out. About 800,000 triangles per second and core.
std::uint64_t self_intersections(const IndexedMesh& mesh);

}  // namespace vdwmesh
