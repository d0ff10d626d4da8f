// What each rank of vdwmesh-mpi may use of its host. shared_structure.hpp has what else its verbs
// share.
#pragma once

#include "distributed/ranks.hpp"
#include "steps/session.hpp"

namespace vdwmesh::apps {

// The options of this rank: the threads of the host are shared among the ranks on it, unless a
// number was given, and only the first rank shows progress and prints. Collective.
MachineOptions machine_of_rank(const Ranks& ranks, const MachineOptions& options);

}  // namespace vdwmesh::apps
