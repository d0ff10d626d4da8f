// The crease-exact mesh of the union's boundary: the second mesher, beside marching cubes.
//
// Corners lie on three spheres, vertices of arcs on two, all others on one, each to rounding; each
// triangle belongs to one sphere, lies in that sphere's power cell, and is inscribed. Arcs are
// sampled once for the patches on both sides, so the mesh is watertight.
//
// Topology: which corners, arcs and patches there are is decided exactly, and the mesh has the
// topology of the union unless features are too small for double coordinates: arcs shorter than
// 1e-8 of the radius, circles below 1e-6, curves nearer to each other than 1e-8. Those become
// points, at which surfaces that meet there only are parted. If that changes the topology, the
// mesher tries again with features of 1e-11 and 1e-9; if curves cannot be told apart, with coarser
// ones, at last 1e-5 and 1e-4. What became a point is counted and the mesh compared with the exact
// complex: `stats` says by how much it differs.
#pragma once

#include <cstdint>

#include "core/monitor.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct ExactMeshOptions {
  double edge_length = 0.35;                    // Å; smaller where the boundary asks for it
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes
  Monitor* monitor = nullptr;
};

struct ExactMeshStats {
  std::uint64_t arcs = 0, corners = 0;  // of the boundary, with a size
  std::uint64_t points = 0;    // arcs of no length: more than three spheres through one point
  std::uint64_t contacts = 0;  // circles of no size: balls that touch in a point, parted
  std::uint64_t joins = 0;     // curves of one sphere joined in a point where they all but touch
  // What was reduced to points, by the radius of the smaller sphere: arcs up to this length,
  // circles up to this radius.
  double arc_size = 0, circle_size = 0;
  // Mesh less union: the Euler characteristic (with 2 more for each two balls that touch in one
  // point, which the mesh doubles) and the number of closed surfaces. 0 where points, contacts and
  // joins are 0.
  std::int64_t euler_difference = 0, shell_difference = 0;
  std::uint64_t pieces = 0;  // of the arcs
  std::uint64_t split = 0;   // pieces that were split on the way
  double arrangement_seconds = 0, seconds = 0;
};

struct ExactMesh {
  IndexedMesh mesh;  // with triangle_spheres, without opposite half-edges
  ExactMeshStats stats;
};

// Vertex labels are the ids of the spheres it lies on, ascending. A function of its arguments: the
// same in every call and for any number of threads; a permuted input permutes labels only. Throws
// InvalidInput (an empty set, an edge length that is not finite and positive), Cancelled;
// LimitExceeded before memory is taken, or later where curves of the boundary lie too close to be
// told apart.
ExactMesh mesh_union(const SphereSet& spheres, const ExactMeshOptions& options = {});

}  // namespace vdwmesh
