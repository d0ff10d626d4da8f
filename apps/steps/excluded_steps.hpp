// The steps of the verbs that deal with the solvent-excluded surface. steps.hpp and exact_steps.hpp
// have those of other surfaces. Each fills its part of the report.
#pragma once

#include "memory_plan.hpp"
#include "steps/picture_options.hpp"
#include "steps/steps.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::apps {

// Measures the excluded surface of the atoms, the share of each atom if `per_atom` is on, and the
// derivatives if `gradients` is.
void measure_excluded(const Molecule& molecule, double probe, const ExactOptions& options,
                      Switch per_atom, Session& session, Switch gradients = Switch::off);

// The same on a CUDA device: the complete surface without its shells.
void measure_excluded_on_cuda(const Molecule& molecule, double probe, Switch per_atom,
                              Session& session);

// Makes a mesh of the excluded surface and subdivides it as often as `surface` says. The observer
// may be empty. Throws as mesh_excluded() and refine_patches() do.
PatchedMesh make_excluded_mesh(const Molecule& molecule, double probe,
                               const SurfaceOptions& surface, Session& session,
                               const LevelObserver& on_level = {});

// For each kind of patch (contact, saddle, concave): the number of patches, and the number and the
// area of their triangles.
PatchReport count_patches(const PatchedMesh& mesh);

// A picture of the mesh, with sharp creases. Colours show elements unless the options say
// otherwise.
void draw_excluded(const PatchedMesh& mesh, const Molecule& molecule, const PictureOptions& options,
                   Session& session);

// Does what precedes a mesh of the excluded surface: checks the memory of the measures, measures
// the surface, and checks the memory of the mesh and of the stages after it as check_memory() does.
// The size of the mesh is estimated from the measured area. Returns the estimate of memory.
std::uint64_t plan_excluded_mesh(const Structure& structure, double probe,
                                 const ExactOptions& exact, Switch per_atom, MemoryDemand& demand,
                                 Session& session);

// Compares the mesh with the exact surface and measures the distances between them. `atoms` are
// without the probe. Precondition: both are in the report.
// If the molecule has cavities, the mesh is held against the exterior surface as well; the
// distances to that are measured if the mesh has no walls of cavities.
void compare_with_excluded(const IndexedMesh& mesh, const SphereSet& atoms,
                           const DistanceChoice& choice, Session& session);

// Adds what proves a mesh that this program made. Precondition: mesh, exact surface and comparison
// are in the report.
void prove_excluded(Session& session);

// Writes the shares of atoms if --per-atom names a file. Precondition: they are in the report.
void write_excluded_atoms(const OutputOptions& output, const Molecule& molecule,
                          VerbSession& session);

}  // namespace vdwmesh::apps
