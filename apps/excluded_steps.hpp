// The steps of the verbs that have to do with the solvent-excluded surface; steps.hpp has all
// others.
#pragma once

#include "memory_plan.hpp"
#include "picture_options.hpp"
#include "steps.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::apps {

// The excluded surface of the atoms, with the shares of atoms if `per_atom` is set.
void measure_excluded(const Molecule& molecule, double probe, const ExactOptions& options,
                      Switch per_atom, Session& session);

// The same on a CUDA device: the complete surface without its shells.
void measure_excluded_on_cuda(const Molecule& molecule, double probe, Switch per_atom,
                              Session& session);

// Its mesh, subdivided as often as `surface` says. The observer may be empty. Throws as
// mesh_excluded() and refine_patches() do.
PatchedMesh make_excluded_mesh(const Molecule& molecule, double probe,
                               const SurfaceOptions& surface, Session& session,
                               const LevelObserver& on_level = {});

// Of the triangles of each kind, contact, saddle and concave: how many and what area, beside the
// number of patches.
PatchReport count_patches(const PatchedMesh& mesh);

// A picture of the mesh, with sharp creases. Colours show elements unless the options say
// otherwise.
void draw_excluded(const PatchedMesh& mesh, const Molecule& molecule, const PictureOptions& options,
                   Session& session);

// What goes before a mesh of the excluded surface: checks the memory of the measures, measures the
// surface, whose area says how large the mesh will be, and checks the memory of the mesh and of
// what follows it, as check_memory() does. Returns the estimate.
std::uint64_t plan_excluded_mesh(const Structure& structure, double probe,
                                 const ExactOptions& exact, Switch per_atom, MemoryDemand& demand,
                                 Session& session);

// Mesh beside exact surface, which both must be in the report, and the distances between them.
// `atoms` are without the probe.
void compare_with_excluded(const IndexedMesh& mesh, const SphereSet& atoms,
                           const DistanceChoice& choice, Session& session);

// What proves a mesh of our own. Mesh, exact surface and comparison must be in the report.
void prove_excluded(Session& session);

// Writes the shares of atoms where --per-atom asked for them; they must be in the report.
void write_excluded_atoms(const OutputOptions& output, const Molecule& molecule,
                          VerbSession& session);

}  // namespace vdwmesh::apps
