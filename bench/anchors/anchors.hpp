// What a user would pick instead, each called as its manual says. Those whose library was not found
// when this was built are not linked.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::anchors {

// The surface of the union of the spheres as triangles; returns their number. `spacing` in Å.
// VTK: signed distance on a regular grid, then vtkFlyingEdges3D with normals, on one thread.
std::uint64_t flying_edges(const std::vector<Sphere>& spheres, double spacing);
// OpenVDB: ParticlesToLevelSet, then volumeToMesh without adaptivity, a quad counted as two
// triangles, on one thread.
std::uint64_t level_set(const std::vector<Sphere>& spheres, double spacing);

// freesasa: exposed area by Lee and Richards with 20 slices, or by Shrake and Rupley with 100
// points, one thread; returns the spheres.
std::uint64_t lee_richards(const std::vector<Sphere>& spheres);
std::uint64_t shrake_rupley(const std::vector<Sphere>& spheres);

// gemmi: file to gemmi::Structure; returns the atoms.
std::uint64_t gemmi_structure(const std::filesystem::path& path);

}  // namespace vdwmesh::anchors
