// PatchedMesh -> finer PatchedMesh: midpoint subdivision whose new vertices lie on the spheres and
// tori of the patches and on the circles in which these meet.
#pragma once

#include <cstdint>
#include <vector>

#include "core/errors.hpp"
#include "refine/refiner.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

class Monitor;

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
// Vertices and triangles are numbered as by Refiner::refine(), and children lie on the patch of
// their parent. The given vertices stay where they are, bit for bit. The midpoint of an edge inside
// a patch goes to the patch's sphere or torus, the midpoint of an edge between two patches to the
// circle in which they meet (refine/crossings/patch_formulas.hpp). The errors of area and volume
// are therefore of second order in the edge length.
//
// A midpoint is labelled with one atom. The patches at its edge name several; the one whose sphere
// is nearest is taken. If the mesh has normals, a midpoint gets the normal of its patch, and on a
// crease between two concave patches the mean of both. No move is taken back, as in meshes whose
// triangles name their spheres. In the statistics, `projected` counts the vertices within
// kProjectionTolerance of the patches of their edge, or, if they were given, of the patches of all
// triangles around them; `unconverged` counts the others, and `turned` the triangles that face
// against the outward normal of their patch.
//
// `atoms` are the spheres that patches name. Runs on the CPU, on all cores; the result is the same,
// bit for bit, for any number of threads. Throws InvalidInput for bad options, and for a mesh that
// is not closed, has arrays of inconsistent length or names patches that do not exist. Throws
// LimitExceeded before memory is taken, and Cancelled.
PatchRefineResult refine_patches(const SphereSet& atoms, PatchedMesh&& mesh,
                                 const PatchRefineOptions& options);

}  // namespace vdwmesh
