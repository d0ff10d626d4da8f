// How far a triangle mesh is from the boundary of a union of balls, and that boundary from the
// mesh. All distances are true ones: to the nearest exposed point, be it on a patch, an arc or a
// corner, and to the nearest point of the nearest triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "core/monitor.hpp"
#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

struct DistanceOptions {
  double samples_per_area = 10;  // per Å², > 0; at least 10^4 on the mesh and on all spheres
  std::uint64_t seed = 1;        // of the samples
  std::uint64_t memory_limit = ~std::uint64_t{0};  // bytes, the mesh included
  Monitor* monitor = nullptr;
};

// Å. Mean, RMS and percentiles are over area, and estimated without bias: more samples change the
// error, not the value; max is over all samples, and only a lower bound. Percentiles come from a
// histogram with bins of 1/256 octave, so they are good to 0.2 % beside the sampling.
struct DistanceStatistics {
  double mean, rms, p50, p95, p99, max;  // the first five NaN where no sample fell on a patch
  // Standard errors of mean and RMS, as of independent samples. These are spread more evenly, so
  // their true errors are somewhat smaller.
  double mean_error, rms_error;
  std::uint64_t samples;
};

struct MeshDistances {
  DistanceStatistics mesh_to_surface;  // points by area; vertices and triangles' centres for max
  DistanceStatistics surface_to_mesh;  // points on exposed patches; arcs and all corners for max
  double hausdorff_lower_bound;        // Å: the larger max
  std::uint64_t samples;               // of both directions
  std::uint64_t seed;
};

// Any triangle soup; isolated vertices are no part of it. The mesh's area is cut into as many equal
// parts as there are samples, with one at random in each (stratified sampling). The points on
// patches are spherical Fibonacci lattices (González 2010), turned at random for each sphere. The
// result is the same, bit for bit, for any number of threads, and does not depend on the order of
// the spheres. Beside the mesh it takes 13 bytes per triangle and some 800 per sphere. Throws
// InvalidInput for no spheres, no triangles, an index of no vertex, a vertex that is not finite, a
// mesh without area, or samples_per_area out of range; LimitExceeded where mesh and search tree
// need more than memory_limit; Cancelled.
MeshDistances distances(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceOptions& options = {});

// For each vertex the distance to the boundary of the union, Å: positive outside, negative inside.
// Throws as distances(), but takes meshes without triangles.
std::vector<float> vertex_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                                    Monitor* monitor = nullptr);

}  // namespace vdwmesh
