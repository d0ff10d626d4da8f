// PatchedMesh -> finer PatchedMesh: midpoint subdivision that keeps to spheres, tori and the
// circles in which they meet.
#pragma once

#include <cstdint>
#include <vector>

#include "core/monitor.hpp"
#include "refine/refiner.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

struct PatchRefineOptions {
  int subdivisions = 0;
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes, compared with refine_bytes()
  LevelObserver on_level = {};                  // may be empty
  Monitor* monitor = nullptr;
};

struct PatchRefineResult {
  PatchedMesh mesh;
  std::vector<ProjectionStats> levels;  // [0]: the given vertices; [l]: after subdivision l
  double seconds = 0;                   // without the time of the observer
};

// Subdivides a closed, oriented and welded mesh that follows the curves between its patches.
// Indices of vertices and triangles are those of Refiner::refine(), and children are of their
// parent's patch. The given vertices stay where they are, bit for bit. The midpoint of an edge
// inside a patch goes to its sphere or torus, one of an edge between two patches to their circle
// (refine/patch_formulas.hpp). Area and volume therefore are of second order in the edge length.
//
// A midpoint is labelled with one atom: of those of the patches at its edge the one whose sphere is
// nearest. Normals, if the mesh has them, are those of the patches; on a crease between two concave
// patches their mean. No move is taken back, as in meshes whose triangles name their spheres.
// `projected` counts the vertices within kProjectionTolerance of the patches of their edge (of
// given vertices: of all triangles around them), `unconverged` the others, and `turned` the
// triangles that face against the outward normal of their patch.
//
// `atoms` are the spheres that patches name. Runs on the CPU, on all cores; the result is the same,
// bit for bit, for any number of threads. Throws InvalidInput for bad options, for a mesh that is
// not closed, whose arrays do not fit each other or whose patches are not there, LimitExceeded
// before memory is taken, and Cancelled.
PatchRefineResult refine_patches(const SphereSet& atoms, PatchedMesh&& mesh,
                                 const PatchRefineOptions& options);

}  // namespace vdwmesh
