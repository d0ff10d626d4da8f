// The steps that verbs are made of. Each fills its part of the report.
#pragma once

#include "core/monitor.hpp"
#include "mesh/surface_mesh.hpp"
#include "mesh/surface_mesh_builder.hpp"
#include "options.hpp"
#include "report.hpp"
#include "spheres/sphere_set.hpp"
#include "structure/molecule.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::apps {

// Reads the structure or sample. A text too large for `memory_limit` bytes is refused.
Molecule load(const InputOptions& options, std::uint64_t memory_limit, Report& report);

// Radii grown by the probe. Throws InvalidInput naming the first atom whose radius would not be
// positive.
SphereSet to_spheres(const Molecule& molecule, double probe);

// Who hears of a mesh while it is made; each may be empty.
struct MeshObservers {
  LevelObserver on_level;
  MeshSizeObserver on_size;  // of marching cubes
};

// What of a mesh is made; a refined one has normals and half-edges anyway.
struct MeshParts {
  Connectivity connectivity = Connectivity::triangles;
  Normals normals = Normals::gradients;
};

// Extraction and refinement on the backend asked for. Throws InvalidInput when no grid node lies
// inside the surface, so that the mesh would be empty.
IndexedMesh make_mesh(const SphereSet& spheres, const SurfaceOptions& surface,
                      const MeshParts& parts, const MachineOptions& machine, Monitor* monitor,
                      Report& report, const MeshObservers& observers = {});

// What runs where `requested` was asked for and `used` was chosen.
BackendReport describe_backend(Backend requested, Backend used);

// Corrects the report where the CPU made the mesh that a device was to make: `fallback` is why, as
// the pipeline says it; nothing is done where it is empty.
void account_for_fallback(const std::string& fallback, Report& report);

// Beyond this many triangles self-intersections are counted only on request.
inline constexpr std::uint64_t kSelfIntersectionTriangles = 1'000'000;
enum class SelfIntersections { small_meshes, count, skip };
bool counts_self_intersections(SelfIntersections wanted, std::uint64_t triangles);

// Topology, measures and quality of the mesh.
void measure(const IndexedMesh& mesh, SelfIntersections self_intersections, Monitor* monitor,
             Report& report);

// Size, measures and quality of the mesh at each level of a refinement, for make_mesh().
LevelObserver record_levels(SelfIntersections self_intersections, std::vector<LevelReport>& levels);

// CGAL's measures of the OpenMesh mesh. Where the mesh is too large for the choice, or has no
// half-edge structure, the report says so and they stay empty.
enum class CgalCheck { small_meshes, run, skip };
bool checks_with_cgal(CgalCheck wanted, std::uint64_t triangles);
void check_with_cgal(const IndexedMesh& mesh, CgalCheck check, Report& report);

void measure_exactly(const SphereSet& spheres, const ExactOptions& options, Monitor* monitor,
                     Report& report);

// Mesh beside exact union, which both must be in the report, and the distances between them.
void compare_with_exact(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceChoice& choice, std::uint64_t memory_limit, Monitor* monitor,
                        Report& report);

// Warns of balls that the mesh lacks, or has joined to others, where no exact union was made: the
// pieces of the union are counted by the pairs of balls that overlap.
void warn_of_lost_balls(const SphereSet& spheres, Report& report);

// The half-edge mesh with normals, atoms and CPK colours, where the builder makes it.
void build_surface_mesh(const IndexedMesh& mesh, const Molecule& molecule,
                        SurfaceMeshBuilder& builder, Report& report);

// Prints the report and writes its JSON, where asked for. Warnings go to standard error where the
// text does not go to standard output.
void deliver(const Report& report, const OutputOptions& output, Verbosity verbosity);

// One line each on standard error.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace vdwmesh::apps
