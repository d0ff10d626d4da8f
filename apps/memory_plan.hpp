// Estimates the memory that a run needs, stage by stage: before it begins, and again when the size
// of the mesh is known.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "analysis/survey/stage_bytes.hpp"
#include "options.hpp"
#include "spheres/sphere_set.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {

// What a run does, as far as its memory depends on it.
struct MemoryDemand {
  std::uint64_t spheres = 0;
  double area = 0;                        // Å² of the union, estimated
  double exposed = 1;                     // `area` as a share of the area of all whole spheres
  std::optional<SurfaceOptions> surface;  // empty: no mesh is made
  Backend backend = Backend::cpu;         // that makes the mesh
  Connectivity connectivity = Connectivity::triangles;
  Normals normals = Normals::gradients;
  // Of a mesh that is refined, in triangles, as in WantedMesh.
  std::uint64_t half_edges_up_to = std::numeric_limits<std::uint64_t>::max();
  MeshSize mesh;                            // of the finished mesh, once it is known
  std::optional<std::uint64_t> mesh_bytes;  // of a mesh that was read from a file
  // The exact union is measured while the mesh is made, and distances while the mesh is measured.
  Switch beside = Switch::off;
  Switch measures = Switch::on;
  SelfIntersections self_intersections = SelfIntersections::skip;
  CgalCheck cgal_check = CgalCheck::skip;
  std::optional<UnionMethod> exact;  // empty: no exact union
  Switch distances = Switch::off;
  Switch page = Switch::off;  // a page is written, with the mesh if there is one; remedies are then
                              // those of view
};

// The method whose memory the exact measures take. A certificate and the excluded surface need the
// triangulation even if the measures come from arcs.
inline UnionMethod method_for_memory(const ExactOptions& exact) {
  const bool triangulates = exact.certify || exact.surface == ExactSurface::excluded;
  const bool more = triangulates && exact.method == UnionMethod::arcs;
  return more ? UnionMethod::both : exact.method;
}

// The width of the vertex labels of the mesh that make_mesh() makes.
LabelWidth label_width(const SurfaceOptions& surface);

struct MemoryNeed {
  std::string stage;
  std::uint64_t bytes = 0;      // of the whole process while the stage runs
  std::uint64_t triangles = 0;  // of the finished mesh
};

// Returns the stage that needs the most memory. If the size of the mesh is not known yet, it is
// estimated from the area, to a few per cent for vdw and to about ten for the blended fields.
MemoryNeed estimate_memory(const MemoryDemand& demand);

// Returns the bytes of that stage. Throws LimitExceeded if they exceed `limit`; the message names
// the stage, the bytes, and options that would fit.
std::uint64_t check_memory(const MemoryDemand& demand, std::uint64_t limit);

// The same before the first stage. Sets the members of `demand` that describe the spheres, if a
// mesh is made or memory is scarce. Switches `beside` off if it would need too much.
std::uint64_t check_memory_before(MemoryDemand& demand, const SphereSet& spheres,
                                  std::uint64_t limit);

// Lengthens the edges until the estimate is at most `most_triangles`; takes marching cubes where
// arcs alone make more.
// Precondition: the surface is the boundary of the spheres, to be meshed along the creases.
SurfaceOptions with_few_triangles(const SurfaceOptions& surface, const SphereSet& spheres,
                                  std::uint64_t most_triangles);

// check_memory() for the stages that follow a mesh that has been made. Switches `beside` off if it
// would need too much.
void check_memory_after(MemoryDemand& demand, const SphereSet& spheres, const IndexedMesh& mesh,
                        std::uint64_t limit);

}  // namespace vdwmesh::apps
