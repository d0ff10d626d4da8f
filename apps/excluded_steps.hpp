// The steps of the verbs that have to do with the solvent-excluded surface; steps.hpp has all
// others.
#pragma once

#include "steps.hpp"

namespace vdwmesh::apps {

// The excluded surface of the atoms, with the shares of atoms if `per_atom` is set.
void measure_excluded(const Molecule& molecule, double probe, const ExactOptions& options,
                      Switch per_atom, Session& session);

// Its mesh. Throws as mesh_excluded() does.
IndexedMesh make_excluded_mesh(const Molecule& molecule, double probe,
                               const SurfaceOptions& surface, Session& session);

}  // namespace vdwmesh::apps
