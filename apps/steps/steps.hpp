// The steps that verbs are made of. Each fills its part of the report.
#pragma once

#include <cstdint>
#include <future>
#include <limits>
#include <optional>
#include <vector>

#include "batch/molecule_spheres.hpp"
#include "creases/exact_mesher.hpp"
#include "mesh/element_color.hpp"
#include "mesh/surface_mesh.hpp"
#include "options.hpp"
#include "refine/refiner.hpp"
#include "report/atom_file.hpp"
#include "report/report.hpp"
#include "spheres/sphere_set.hpp"
#include "steps/session.hpp"
#include "structure/molecule.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh::apps {

// A molecule and its balls, one per atom, grown by the probe.
struct Structure {
  Molecule molecule;
  SphereSet spheres;
};

// How the input is read in this session: with its limit of memory.
ReadOptions read_options(const InputOptions& options, const Session& session);

// Writes into the session's report what is known of a molecule that was read.
void describe_input(Molecule& molecule, const InputOptions& options, Session& session);

// Reads the structure or sample. A text too large for the session's memory is refused, and so is a
// probe that leaves an atom no radius.
Structure load(const InputOptions& options, Session& session);
// Its first half; to_spheres() of batch/molecule_spheres.hpp is the second.
Molecule load_molecule(const InputOptions& options, Session& session);

// What of a mesh is made, and who hears of it meanwhile. The levels above the last one of a refined
// mesh have normals and half-edges anyway; the observer may be empty.
struct WantedMesh {
  Connectivity connectivity = Connectivity::triangles;
  Normals normals = Normals::gradients;
  std::uint64_t half_edges_up_to = std::numeric_limits<std::uint64_t>::max();  // if it is refined
  LevelObserver on_level = {};
};

// Starts the device that will make the mesh, if one will, on a thread of its own: that takes some
// 0.2 s, in which the structure can be read. What fails is met again by who uses the device. The
// destructor of the result waits for the end.
[[nodiscard]] std::future<void> start_device(const MachineOptions& machine,
                                             const SurfaceOptions& surface);

// Extraction and refinement on the backend asked for. Throws InvalidInput when no grid node lies
// inside the surface, so that the mesh would be empty.
IndexedMesh make_mesh(const SphereSet& spheres, const SurfaceOptions& surface, Session& session,
                      const WantedMesh& request = {});
// The same without ending the stage.
IndexedMesh make_mesh_untimed(const SphereSet& spheres, const SurfaceOptions& surface,
                              Session& session, const WantedMesh& request);

// How a surface was meshed, with the values that hold, not those that were typed: a preset brings
// its own. `grid` is of marching cubes.
ParametersReport describe_parameters(const SurfaceOptions& surface,
                                     const std::optional<GridSpec>& grid,
                                     std::uint64_t memory_limit);

// How a mesh of the surface is refined; without a grid and an observer.
RefineOptions refine_options(const SurfaceOptions& surface, const Session& session);
// The options of the crease-exact mesher for a surface.
ExactMeshOptions exact_mesh_options(const SurfaceOptions& surface, std::uint64_t memory_limit,
                                    Monitor* monitor);
// Writes into the report what that mesher says of its mesh.
void describe_exact_mesh(const ExactMeshStats& stats, Report& report);

// What runs where `requested` was asked for and `used` was chosen.
BackendReport describe_backend(Backend requested, Backend used);

// Corrects the report where the CPU made the mesh that a device was to make: `fallback` is why, as
// the pipeline says it; nothing is done where it is empty.
void account_for_fallback(const std::string& fallback, Report& report);

// The grid on which marching cubes made the mesh, if it was made here, for self_intersections().
std::optional<GridSpec> grid_of(const Report& report);

// Topology, measures and quality of the mesh; then its self-intersections, if wanted.
void measure(const IndexedMesh& mesh, SelfIntersections self_intersections, Session& session);
// Both halves of measure(), which do not end their stages. The first comes first.
void examine_untimed(const IndexedMesh& mesh, Session& session);
void self_intersections_untimed(const IndexedMesh& mesh, Session& session);

// Size, measures and quality of the mesh at each level of a refinement but the last, for
// make_mesh(): the last level is the finished mesh. Then, once that is measured, adds it to the
// levels, if there are any.
LevelObserver record_levels(SelfIntersections self_intersections, int last,
                            std::vector<LevelReport>& levels, Session& session);
void add_last_level(int last, std::vector<LevelReport>&& levels, MeshReport& mesh);

// Whether a mesh of so many triangles is checked with CGAL, and the most triangles of one that is.
bool checks_with_cgal(CgalCheck wanted, std::uint64_t triangles);
std::uint64_t most_checked_with_cgal(CgalCheck wanted);
// CGAL's measures of the OpenMesh mesh. Where the mesh is too large for the choice, or has no
// half-edge structure, the report says so and they stay empty.
void check_with_cgal(const IndexedMesh& mesh, CgalCheck check, Session& session);

// Writes the atoms with their figures to the file that --write names, and notes how many have no
// first one.
void write_atom_file(const std::string& path, const Molecule& molecule, const AtomColumns& figures,
                     VerbSession& session);

// The CPK colour of each atom.
std::vector<RgbColor> element_colors(const Molecule& molecule);

}  // namespace vdwmesh::apps
