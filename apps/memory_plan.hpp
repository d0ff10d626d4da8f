// What a run will need, stage by stage, asked before it begins and again when the mesh is there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "analysis/stage_bytes.hpp"
#include "options.hpp"
#include "spheres/sphere_set.hpp"
#include "steps.hpp"

namespace vdwmesh::apps {

// What is done with the mesh, and beside it.
struct MemoryDemand {
  std::uint64_t spheres = 0;
  double area = 0;                        // Å² of the union, about
  double exposed = 1;                     // that part of the spheres' own area
  std::optional<SurfaceOptions> surface;  // empty: no mesh is made here
  Backend backend = Backend::cpu;         // that makes it
  Connectivity connectivity = Connectivity::triangles;
  Normals normals = Normals::gradients;
  MeshSize mesh;                            // of the finished mesh, where it is known
  std::optional<std::uint64_t> mesh_bytes;  // of one that is not made here, where it is known
  Switch build = Switch::off;               // OpenMesh
  Switch early = Switch::off;               // room for it is made before the mesh is measured
  Switch measures = Switch::on;
  SelfIntersections self_intersections = SelfIntersections::skip;
  CgalCheck cgal_check = CgalCheck::skip;
  std::optional<UnionMethod> exact;  // empty: no exact union
  Switch distances = Switch::off;
};

// The method whose memory the exact measures take: a certificate, and the excluded surface, have
// the triangulation as well.
inline UnionMethod method_for_memory(const ExactOptions& exact) {
  const bool triangulates = exact.certify == Switch::on || exact.surface == ExactSurface::excluded;
  const bool more = triangulates && exact.method == UnionMethod::arcs;
  return more ? UnionMethod::both : exact.method;
}

// Room of the labels of vertices that make_mesh() gives.
LabelWidth label_width(const SurfaceOptions& surface);

struct MemoryNeed {
  std::string stage;
  std::uint64_t bytes = 0;      // of the whole process while the stage runs
  std::uint64_t triangles = 0;  // of the finished mesh
};

// The stage that needs the most. Where the mesh is not known yet, its size follows from the area:
// good to a few per cent for vdw, to about ten for the blended fields.
MemoryNeed estimate_memory(const MemoryDemand& demand);

// Throws LimitExceeded when it is more than `limit` bytes: names stage, bytes, and the options that
// would fit. Returns the bytes.
std::uint64_t check_memory(const MemoryDemand& demand, std::uint64_t limit);

// The same before anything is made. Fills in what `demand` has of the spheres if a mesh is made or
// memory is scarce, and gives `early` up where it would take too much.
std::uint64_t check_memory_before(MemoryDemand& demand, const SphereSet& spheres,
                                  std::uint64_t limit);

// Whether the mesh, whose size is known now, leaves what `early` takes.
bool early_build_fits(const MemoryDemand& demand, const MeshSize& mesh, std::uint64_t limit);

// The same for what follows a mesh that is there.
void check_memory_after(MemoryDemand& demand, const SphereSet& spheres, const IndexedMesh& mesh,
                        std::uint64_t limit);

}  // namespace vdwmesh::apps
