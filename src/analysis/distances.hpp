// Distances between a triangle mesh and the exact boundary of a union of balls, in both directions.
//
// A point of a sphere is exposed if no other ball covers it; the boundary consists of all exposed
// points. The exposed part of one sphere is a patch, bounded by arcs of circles that end at
// corners. The distance from a point to the boundary is measured to the nearest exposed point,
// which may be inside a patch, on an arc or at a corner. The distance from a point to the mesh is
// measured to the nearest point of the nearest triangle. Both are exact up to rounding; sampling
// only decides at which points they are taken. "Surface" means the boundary, never the mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "spheres/sphere_set.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

class Monitor;

struct DistanceOptions {
  // Samples per Å², > 0. The density on the mesh is raised if the mesh would have fewer than 10^4
  // samples, and the density on the surface if all whole spheres together would have fewer.
  double samples_per_area = 10;
  std::uint64_t seed = 1;                          // of the random numbers that place the samples
  std::uint64_t memory_limit = ~std::uint64_t{0};  // bytes, including the mesh; default: no limit
  Monitor* monitor = nullptr;
};

// Statistics of the distances in one direction, Å. Mean, RMS and percentiles weight the distances
// by area. Their estimates are unbiased: more samples make the statistical errors smaller and do
// not shift the values. `max` is over all samples and therefore a lower bound of the true maximum.
// Percentiles come from a histogram with 256 bins per octave, so the middle of a bin differs by at
// most 0.2 % from the values in it.
struct DistanceStatistics {
  double mean, rms, p50, p95, p99, max;  // all but max are NaN if no sample fell on a patch
  // Standard errors of mean and RMS for independent samples. The samples are spread more evenly
  // than independent ones, so the true errors are somewhat smaller.
  double mean_error, rms_error;
  std::uint64_t samples;  // all measured points, including those for the maximum only
};

struct MeshDistances {
  DistanceStatistics mesh_to_surface;  // max also includes vertices and triangle centres
  DistanceStatistics surface_to_mesh;  // max also includes points on arcs and all corners
  double hausdorff_lower_bound;        // Å: the larger of the two maxima
  std::uint64_t samples;               // of both directions together
  std::uint64_t seed;
};

// Computes the statistics of both directions. The mesh may be any triangle soup; isolated vertices
// are ignored.
//
// Samples on the mesh: its area is divided into as many equal parts as there are samples, with one
// random point in each (stratified sampling). Samples on the surface: a spherical Fibonacci lattice
// (Á. González, Math. Geosci. 42 (2010) 49) on each sphere, rotated at random. The result is the
// same bit for bit for any number of threads and any order of the spheres. Memory beside the mesh
// is 14 bytes per triangle and about 800 bytes per sphere.
//
// Throws InvalidInput if there are no spheres or no triangles, if a triangle names a vertex that
// does not exist, if a vertex is not finite, if the mesh has no area, and if samples_per_area is
// not a positive finite number. Throws LimitExceeded if more than memory_limit bytes or more than
// 10^12 samples would be needed, or if a mesh of more than 30,000 triangles is 65,536 times as long
// as the balls, and Cancelled on request of the monitor.
MeshDistances distances(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceOptions& options = {});

// Returns the distance of each vertex to the boundary of the union, Å: positive outside the union,
// negative inside. Triangles are not used, so the mesh may have none, and isolated vertices are
// measured too. Throws InvalidInput if there are no spheres or if a vertex is not finite, and
// Cancelled on request of the monitor.
std::vector<float> vertex_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                                    Monitor* monitor = nullptr);

}  // namespace vdwmesh
