// The verbs of vdwmesh-mpi. All ranks call them with the same options.
#pragma once

#include "command_line/command_line.hpp"
#include "distributed/ranks.hpp"

namespace vdwmesh::apps {

void run_ranks_mesh(const Ranks& ranks, const Options& options);
void run_ranks_exact(const Ranks& ranks, const Options& options);

}  // namespace vdwmesh::apps
