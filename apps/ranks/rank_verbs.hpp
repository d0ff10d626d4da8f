// The verbs of vdwmesh-mpi, which all ranks call with the same options, and what each rank may use
// of its host. shared_structure.hpp has what else the verbs share.
#pragma once

#include "command_line/command_line.hpp"
#include "distributed/ranks.hpp"
#include "steps/session.hpp"

namespace vdwmesh::apps {

// The options of this rank: the threads of the host are shared among the ranks on it, unless a
// number was given, and only the first rank shows progress and prints. Collective.
MachineOptions machine_of_rank(const Ranks& ranks, const MachineOptions& options);

void run_ranks_mesh(const Ranks& ranks, const Options& options);
void run_ranks_exact(const Ranks& ranks, const Options& options);

}  // namespace vdwmesh::apps
