// The mesh of the solvent-excluded surface (excluded_measures.hpp says what that is). Its edges
// follow the curves in which patches meet: circles between contact patches and saddles, sides of
// concave patches, and creases between the concave patches of two probes.
//
// Each curve is sampled once, and both patches beside it use the same points, so the mesh is
// watertight. Which patches and curves there are comes from exact predicates on the grown atoms, so
// the mesh has the topology of the surface at every edge length. A vertex of a contact patch lies
// on its atom's sphere, one of a saddle on its torus and one of a concave patch on its probe's
// sphere, a vertex between patches on all of theirs, each up to rounding. Area and volume differ
// from those of the surface in second order of the edge length.
#pragma once

#include <cstdint>

#include "core/curves_too_close.hpp"
#include "excluded/excluded_measures.hpp"
#include "surface/surface_patch.hpp"

namespace vdwmesh {

class Monitor;

struct ExcludedMeshOptions {
  double probe = kWaterProbe;  // Å, above 0: radius of the probe
  double edge_length = 0.35;   // Å; edges are shorter at narrow features and on small circles
  // The exterior surface, which has cavities filled up, in place of the complete one.
  bool exterior = false;
  std::uint64_t memory_limit = kNoMemoryLimit;  // bytes
  Monitor* monitor = nullptr;
};

struct ExcludedMeshStats {
  std::uint64_t curves = 0;  // between patches; seams of whole rings count
  std::uint64_t pieces = 0;  // mesh edges along the curves
  std::uint64_t split = 0;   // pieces that had to be split after the first sampling
  // Wall time. The first is the part before meshing: everything exact.
  double surface_seconds = 0, seconds = 0;
};

// Of the mesh: outward normals, those of the patches, which agree along curves that are no creases;
// on a crease their mean. The label of a vertex is one atom: of those of a patch that it is on, the
// one whose sphere is nearest. Without triangle_spheres and without opposite half-edges.
// refine_patches() (refine/patch_refiner.hpp) subdivides it.
struct ExcludedMesh : PatchedMesh {
  ExcludedMeshStats stats;
};

// Meshes the excluded surface of the balls `atoms` (radii without the probe). The result depends on
// the arguments alone, not on the number of threads.
// Throws InvalidInput as excluded_measures() does, and for an edge length that is not finite and
// positive; LimitExceeded before it takes memory beyond the limit, if a concave patch is not
// certified, or if the mesh has not the topology of the surface; CurvesTooClose; and Cancelled.
ExcludedMesh mesh_excluded(const SphereSet& atoms, const ExcludedMeshOptions& options = {});

}  // namespace vdwmesh
