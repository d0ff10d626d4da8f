// The crease-exact mesh of the union's boundary: the second mesher, beside marching cubes.
//
// Corners lie on three spheres, vertices of arcs on two, all others on one, each to rounding; each
// triangle belongs to one sphere, lies in that sphere's power cell, and is inscribed. Arcs are
// sampled once for the patches on both sides, so the mesh is watertight and has the topology of the
// union; points of contact are doubled.
#pragma once

#include <cstdint>

#include "core/monitor.hpp"
#include "extract/extractor.hpp"
#include "extract/indexed_mesh.hpp"

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
  std::uint64_t pieces = 0;    // of the arcs
  std::uint64_t split = 0;     // pieces that were split on the way
  double arrangement_seconds = 0, seconds = 0;
};

struct ExactMesh {
  IndexedMesh mesh;  // with triangle_spheres, without opposite half-edges
  ExactMeshStats stats;
};

// Vertex labels are the ids of the spheres it lies on, ascending. The same for any number of
// threads; a permuted input permutes labels only. Throws InvalidInput (an empty set, an edge length
// that is not finite and positive), Cancelled; LimitExceeded before memory is taken, or later where
// curves of the boundary lie too close to be told apart.
ExactMesh mesh_union(const SphereSet& spheres, const ExactMeshOptions& options = {});

}  // namespace vdwmesh
