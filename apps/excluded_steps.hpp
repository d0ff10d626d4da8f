// The steps of the verbs that have to do with the solvent-excluded surface; steps.hpp has all
// others.
#pragma once

#include "picture_options.hpp"
#include "steps.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh::apps {

// The excluded surface of the atoms, with the shares of atoms if `per_atom` is set.
void measure_excluded(const Molecule& molecule, double probe, const ExactOptions& options,
                      Switch per_atom, Session& session);

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

}  // namespace vdwmesh::apps
