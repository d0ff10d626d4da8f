// How many bytes the stages behind a mesh take at their peak, each beside what it is given: for
// limits that are asked before anything is taken. Upper bounds for molecules, by at most a half;
// docs/robustness.md has the measurements.
#pragma once

#include <cstdint>

#include "arrangement/exact_union.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// to_surface_mesh() and the mesh that it makes.
std::uint64_t surface_mesh_bytes(const MeshSize& mesh, Connectivity given);

// topology(), measures() and quality(), one after the other.
std::uint64_t measures_bytes(const MeshSize& mesh);

// self_intersections().
std::uint64_t self_intersections_bytes(const MeshSize& mesh);

// exact_union(), its result included. `exposed`: the part of all spheres' area on the boundary; the
// less, the more of the triangulation is in the dual complex.
std::uint64_t union_bytes(std::uint64_t spheres, UnionMethod method, double exposed);

// distances(); the mesh itself is not in it.
std::uint64_t distances_bytes(const MeshSize& mesh, std::uint64_t spheres);

}  // namespace vdwmesh
