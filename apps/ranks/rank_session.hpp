// What the verbs of vdwmesh-mpi share: the molecule, which one rank reads and all get, and what
// each rank may use of its host.
#pragma once

#include <vector>

#include "command_line/command_line.hpp"
#include "distributed/host_memory.hpp"
#include "distributed/ply_file.hpp"
#include "distributed/ranks.hpp"
#include "session.hpp"
#include "spheres/sphere_set.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// The molecule as the ranks have it.
struct SharedStructure {
  Molecule molecule;             // without atoms but on the first rank
  HostArray<Sphere> of_spheres;  // once on every host
  SphereSet spheres;             // all of them, a view
};

// Reads the structure on the first rank and gives its spheres to all. Throws as load() does, on all
// ranks. Collective.
SharedStructure load_together(const Ranks& ranks, const InputOptions& options, Session& session);

// The colour of every sphere, on all ranks. Collective.
HostArray<RgbColor> share_colors(const Ranks& ranks, const Molecule& molecule);

// The options of this rank: the threads of the host are shared among the ranks on it, unless a
// number was given, and only the first rank shows progress and prints. Collective.
MachineOptions machine_of_rank(const Ranks& ranks, const MachineOptions& options);

}  // namespace vdwmesh::apps
