// Peak memory of the stages that come after a mesh, in bytes, without the input of each stage.
//
// The program compares these estimates with its memory limit before a stage allocates anything. For
// molecules they are upper bounds that exceed the measured peak by at most a half;
// docs/notes/robustness.md has the measurements.
#pragma once

#include <cstdint>

#include "measures/exact_union.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// to_surface_mesh(), including the mesh that it returns.
std::uint64_t surface_mesh_bytes(const MeshSize& mesh, Connectivity given);

// examine() of a closed 2-manifold, and of triangles of which nothing is known.
std::uint64_t measures_bytes(const MeshSize& mesh);
std::uint64_t measures_of_soup_bytes(const MeshSize& mesh);

// self_intersections().
std::uint64_t self_intersections_bytes(const MeshSize& mesh);

// exact_union(), including its result. `exposed`, in [0, 1], is the share of the area of all
// spheres that is on the boundary of the union. The smaller it is, the more simplices of the
// triangulation are in the dual complex, which takes more memory.
std::uint64_t union_bytes(std::uint64_t spheres, UnionMethod method, double exposed);

// distances(), without the mesh.
std::uint64_t distances_bytes(const MeshSize& mesh, std::uint64_t spheres);

}  // namespace vdwmesh
