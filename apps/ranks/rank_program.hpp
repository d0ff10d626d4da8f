// What vdwmesh-mpi and its verbs are called. It stands apart from what they do, so that the manual
// can be made without MPI.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "verbs/verbs.hpp"

namespace vdwmesh::apps {

using RunVerb = std::function<void(const Options& options)>;

inline std::vector<Verb> rank_verbs(RunVerb mesh, RunVerb exact) {
  return {{kRanksMesh, "mesh", "a mesh of a structure's surface, as one file, by all processes",
           std::move(mesh)},
          {kRanksExact, "exact", "exact area, volume and counts of the union, by all processes",
           std::move(exact)}};
}

// `processes` of it run on this host.
inline Program rank_program(std::span<const Verb> verbs, std::uint64_t processes) {
  return {"vdwmesh-mpi", "mpirun -n P vdwmesh-mpi",
          "Meshes and exact measures of large molecules by many processes (MPI)", verbs, processes};
}

}  // namespace vdwmesh::apps
