// Distances between a triangle mesh and the boundary of a union of balls, in both directions.
//
// "Surface" means the boundary of the union in this file, never the mesh. distances() takes these
// steps:
//  1. The input and the memory limit are checked before any array is allocated.
//  2. ExposedSurface builds the surface exactly, as one patch for each exposed sphere.
//  3. Mesh to surface: MeshSampler chooses points on the mesh by stratified sampling of its area,
//     and SurfaceFinder finds the distance of each of them to the surface.
//  4. Surface to mesh: surface_to_mesh() takes points of spherical Fibonacci lattices on the
//     patches, and MeshFinder finds the nearest triangle for each of them.
//
// Work is divided into blocks of fixed size. Each block has its own sums, which are joined in the
// order of the blocks; histograms count integers. The result is therefore the same bit for bit for
// any number of threads.
#include "analysis/distances.hpp"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "analysis/distances_samples.hpp"
#include "analysis/distances_statistics.hpp"
#include "analysis/exposed_surface.hpp"
#include "analysis/mesh_area.hpp"
#include "analysis/mesh_finder.hpp"
#include "analysis/signed_distance.hpp"
#include "analysis/stage_bytes.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "core/sum.hpp"
#include "surface/box.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kPerBlock = 2048;  // triangles, vertices or samples
constexpr std::size_t kPatchesPerBlock = 8;
// Bounds of the number of samples in each direction. They are applied twice, by two calls of
// density_for(): once to the mesh, and once to all whole spheres together. Samples on buried parts
// of spheres are discarded, so fewer than kLeastSamples may remain on the surface.
constexpr double kLeastSamples = 1e4;
constexpr double kMostSamples = 1e12;  // more would take weeks

void check_vertices(const IndexedMesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d& p = mesh.positions[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw InvalidInput(fmt::format("vertex {} of the mesh is not finite", v));
  }
}

void check_triangles(const IndexedMesh& mesh) {
  if (mesh.triangles.empty())
    throw InvalidInput("the mesh has no triangles: there is nothing to measure distances of");
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (v >= mesh.vertex_count())
        throw InvalidInput(
            fmt::format("triangle {} has vertex {}, but there are {}", t, v, mesh.vertex_count()));
    }
  }
}

void check_spheres(const SphereSet& spheres) {
  if (spheres.empty()) throw InvalidInput("no spheres: their union has no boundary");
}

// Throws LimitExceeded if the triangles are too many for the 32-bit indices of BoxTree, or if mesh,
// search tree and exposed surface need more than `limit` bytes. The largest 32-bit number is
// written as kNoSphere; only its value 2^32 - 1 matters here.
//
// The second message proposes coarser meshes. One subdivision less divides the numbers of vertices
// and triangles by 4, and a spacing s times as wide divides them by s². The proposals treat all
// bytes so. The bytes of the spheres do not shrink, but they are few beside a large mesh. The
// factor 1.02 is a margin: it exceeds the rounding of the printed spacing to three digits (0.5 %).
void check_memory(const IndexedMesh& mesh, std::size_t spheres, std::uint64_t limit) {
  const std::uint64_t triangles = mesh.triangle_count();
  if (triangles >= kNoSphere) {
    throw LimitExceeded(
        fmt::format("distances take at most {} triangles, the mesh has {}: subdivide it once less",
                    kNoSphere - 1, triangles));
  }
  const std::uint64_t need =
      indexed_mesh_bytes(mesh) + distances_bytes({mesh.vertex_count(), triangles}, spheres);
  if (need <= limit) return;
  const double ratio = static_cast<double>(need) / static_cast<double>(limit);
  throw LimitExceeded(fmt::format(
      "distances of {} triangles need {} bytes with the mesh, {} are allowed: choose {}, a spacing "
      "{:.3g} times as wide, a higher memory limit or no distances",
      triangles, need, limit,
      ratio <= 4 ? "one subdivision less"
                 : fmt::format("{:.0f} subdivisions less", std::ceil(0.5 * std::log2(ratio))),
      1.02 * std::sqrt(ratio)));
}

// Returns the density of samples, per Å², on a total area (Å²): samples_per_area, or a higher
// density if that would give fewer than kLeastSamples. Throws InvalidInput if the area is 0 or too
// small, or if samples_per_area is not positive and finite, and LimitExceeded if there would be
// more than kMostSamples.
double density_for(double total_area, double samples_per_area) {
  if (!std::isfinite(kLeastSamples / total_area))
    throw InvalidInput(
        fmt::format("an area of {:.3g} Å² is too small to take samples", total_area));
  if (!(samples_per_area > 0) || !std::isfinite(samples_per_area))
    throw InvalidInput(
        fmt::format("{} samples per Å²: a positive number is needed", samples_per_area));
  if (!(total_area * samples_per_area <= kMostSamples)) {
    throw LimitExceeded(fmt::format(
        "{:.3g} Å² at {} samples per Å² are more than {:.0e} samples: choose at most {:.3g}",
        total_area, samples_per_area, kMostSamples, kMostSamples / total_area));
  }
  return std::max(samples_per_area, kLeastSamples / total_area);
}

// Returns the area of all whole spheres, Å²: the sum of 4 π r².
double area_of(const SphereSet& spheres) {
  WideSum total;
  for (const Sphere& s : spheres.spheres()) total.add(2 * kTwoPi * s.radius * s.radius);
  return total.value();
}

// Returns the bounding box of mesh and balls together. Both search trees use it, because a BoxTree
// needs a box around its primitives and all queries, and the queries of each tree are points of the
// other object: mesh points ask for the nearest patch, and points of spheres for the nearest
// triangle.
Box common_bounding_box(const IndexedMesh& mesh, const SphereSet& spheres) {
  Box box = bounding_box(spheres);
  for (const Vec3d& p : mesh.positions) include(box, p);
  return box;
}

// Returns 1 for each vertex that is on some triangle, 0 for isolated vertices. Several threads may
// mark the same vertex at the same time, so the marks are stored atomically.
Buffer<std::uint8_t> used_vertices(const IndexedMesh& mesh) {
  Buffer<std::uint8_t> used(mesh.vertex_count(), 0);
  for_each_index(mesh.triangle_count(), [&](std::size_t t) {
    for (const std::uint32_t v : mesh.triangles[t])
      std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
  });
  return used;
}

// Collects the distances of all blocks: sums for each block, which are joined in the order of the
// blocks, and a histogram for each thread, whose integer counts can be added in any order.
// histogram() returns the one of the calling thread.
class Statistics {
 public:
  explicit Statistics(std::size_t blocks) : blocks_(blocks) {}
  DistanceSums& block(std::size_t i) { return blocks_[i]; }
  DistanceHistogram& histogram() { return histograms_.local(); }
  DistanceStatistics result() const {
    DistanceHistogram all;
    for (const DistanceHistogram& h : histograms_) all.add(h);
    return summarize(blocks_, all);
  }

 private:
  std::vector<DistanceSums> blocks_;
  tbb::enumerable_thread_specific<DistanceHistogram> histograms_;
};

// Distances from the mesh to the surface.
//
// MeshArea maps the interval [0, A], with A the area of the mesh, onto the mesh such that equal
// lengths become equal areas: each triangle has a subinterval as long as its area, and
// point_of_triangle() turns the position within it into a point. One random number therefore gives
// a point that is uniformly distributed over the mesh. The interval is divided into `samples_`
// strata of equal length, with one random position in each (stratified sampling). Every part of the
// mesh is thus sampled in proportion to its area, and triangles smaller than a stratum have their
// share too.
//
// Vertices and triangle centres are measured as well, but count only for the maximum, because they
// are not distributed by area.
class MeshSampler {
 public:
  MeshSampler(const IndexedMesh& mesh, const SurfaceFinder& finder, const DistanceOptions& options)
      : mesh_(mesh),
        finder_(finder),
        area_(mesh),
        samples_(static_cast<std::uint64_t>(
            std::ceil(area_.total() * density_for(area_.total(), options.samples_per_area)))),
        seed_(options.seed) {}

  DistanceStatistics run(Monitor* monitor) const {
    const std::size_t triangles = mesh_.triangle_count(), vertices = mesh_.vertex_count();
    const std::size_t sample_blocks = block_count(samples_, kPerBlock);
    const std::size_t face_blocks = block_count(triangles, kPerBlock);
    const std::size_t blocks = sample_blocks + face_blocks + block_count(vertices, kPerBlock);
    const Buffer<std::uint8_t> used = used_vertices(mesh_);
    Statistics statistics(blocks);
    begin_stage(monitor, "distances of the mesh", blocks);
    const auto visit = [&](std::size_t count, const auto& body) {
      for_each_block(count, kPerBlock, body, monitor);
    };
    visit(samples_, [&](std::size_t block, std::size_t first, std::size_t end) {
      sample_area(first, end, statistics.block(block), statistics.histogram());
    });
    visit(triangles, [&](std::size_t block, std::size_t first, std::size_t end) {
      visit_centres(first, end, statistics.block(sample_blocks + block));
    });
    visit(vertices, [&](std::size_t block, std::size_t first, std::size_t end) {
      visit_vertices(first, end, used, statistics.block(sample_blocks + face_blocks + block));
    });
    return statistics.result();
  }

 private:
  // Returns the position of sample i in the area interval [0, A], Å²: a random position in stratum
  // i. The random stream of sample i is ~i, which counts downwards from 2^64 - 1. The streams of
  // spheres count upwards from 0 (surface_to_mesh()), so no stream is used twice.
  double sample_position(std::uint64_t i) const {
    const double within = Random(seed_, ~i).next();
    return (static_cast<double>(i) + within) / static_cast<double>(samples_) * area_.total();
  }

  // Measures the samples of one block.
  void sample_area(std::uint64_t first, std::uint64_t end, DistanceSums& sums,
                   DistanceHistogram& histogram) const {
    std::vector<Vec3d> points;
    points.reserve(end - first);
    MeshArea::Cursor cursor(area_, sample_position(first));
    for (std::uint64_t i = first; i < end; ++i)
      points.push_back(cursor.point_at(sample_position(i)));
    for (const double distance : unsigned_distances(points)) {
      sums.add(distance);
      histogram.add(distance);
    }
  }

  // Measures the centres of one block of triangles, for the maximum. The centre is computed from
  // differences of the corners, whose rounding errors are relative to the size of the triangle. In
  // (a + b + c) / 3 they would be relative to its distance from the coordinate origin.
  void visit_centres(std::size_t first, std::size_t end, DistanceSums& sums) const {
    std::vector<Vec3d> points;
    points.reserve(end - first);
    for (std::size_t t = first; t < end; ++t) {
      const Corners corners = corners_of(mesh_, t);
      points.push_back(corners.a + (1.0 / 3) * ((corners.b - corners.a) + (corners.c - corners.a)));
    }
    for (const double distance : unsigned_distances(points)) sums.add_extreme(distance);
  }

  // Measures one block of vertices for the maximum, except isolated vertices, whose element of
  // `used` is 0.
  void visit_vertices(std::size_t first, std::size_t end, const Buffer<std::uint8_t>& used,
                      DistanceSums& sums) const {
    std::vector<Vec3d> points;
    points.reserve(end - first);
    for (std::size_t v = first; v < end; ++v)
      if (used[v]) points.push_back(mesh_.positions[v]);
    for (const double distance : unsigned_distances(points)) sums.add_extreme(distance);
  }

  std::vector<double> unsigned_distances(std::span<const Vec3d> points) const {
    std::vector<double> found(points.size());
    finder_.find(points, found.data());
    for (double& distance : found) distance = std::abs(distance);
    return found;
  }

  const IndexedMesh& mesh_;
  const SurfaceFinder& finder_;
  MeshArea area_;
  std::uint64_t samples_;
  std::uint64_t seed_;
};

// Distances from the surface to the mesh. Samples inside patches, with `density` points per Å²,
// enter all statistics. Exposed points on circles, and corners, enter the maximum only. The
// circles have √density points per Å, so neighbours on a circle are about as far apart as
// neighbours inside a patch.
DistanceStatistics surface_to_mesh(const ExposedSurface& surface, const MeshFinder& finder,
                                   double density, const DistanceOptions& options) {
  const std::span<const Patch> patches = surface.patches();
  const std::size_t blocks = block_count(patches.size(), kPatchesPerBlock);
  Statistics statistics(blocks);
  begin_stage(options.monitor, "distances of the surface", blocks);
  const auto visit = [&](std::size_t block, std::size_t first, std::size_t end) {
    DistanceSums& sums = statistics.block(block);
    DistanceHistogram& histogram = statistics.histogram();
    std::vector<Vec3d> inside, border;
    for (std::size_t i = first; i < end; ++i) {
      // The random stream is the rank of the sphere in canonical order, so that the samples do not
      // depend on the order of the spheres in the caller's set.
      Random random(options.seed, surface.list().rank[patches[i].place]);
      sample_patch(patches[i], density, random, [&](const Vec3d& p) { inside.push_back(p); });
      sample_border(patches[i], std::sqrt(density), random,
                    [&](const Vec3d& p) { border.push_back(p); });
    }
    std::vector<double> found(std::max(inside.size(), border.size()));
    finder.find(inside, found.data());
    for (const double distance : std::span(found).first(inside.size())) {
      sums.add(distance);
      histogram.add(distance);
    }
    finder.find(border, found.data());
    for (const double distance : std::span(found).first(border.size())) sums.add_extreme(distance);
  };
  for_each_block(patches.size(), kPatchesPerBlock, visit, options.monitor);
  return statistics.result();
}

}  // namespace

MeshDistances distances(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceOptions& options) {
  check_spheres(spheres);
  check_triangles(mesh);
  check_vertices(mesh);
  check_memory(mesh, spheres.size(), options.memory_limit);
  // The density on the surface follows from the whole spheres. It is computed first, so that
  // options which it refuses are reported before the surface is built.
  const double density = density_for(area_of(spheres), options.samples_per_area);
  const Box world = common_bounding_box(mesh, spheres);
  const ExposedSurface surface(spheres, options.monitor);
  MeshDistances result{};
  // Each finder is a temporary that ends with its statement. The search tree over the patches is
  // therefore freed before the one over the triangles is built.
  result.mesh_to_surface =
      MeshSampler(mesh, SurfaceFinder(surface, world), options).run(options.monitor);
  result.surface_to_mesh = surface_to_mesh(surface, MeshFinder(mesh, world), density, options);
  result.hausdorff_lower_bound = std::max(result.mesh_to_surface.max, result.surface_to_mesh.max);
  result.samples = result.mesh_to_surface.samples + result.surface_to_mesh.samples;
  result.seed = options.seed;
  return result;
}

// No memory limit is checked. The function allocates the surface, the search tree over its patches
// and one double and one float per vertex.
std::vector<float> vertex_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                                    Monitor* monitor) {
  check_spheres(spheres);
  check_vertices(mesh);
  const std::vector<double> exact = signed_distances(mesh.positions, spheres, monitor);
  std::vector<float> rounded(exact.size());
  std::ranges::transform(exact, rounded.begin(), [](double d) { return static_cast<float>(d); });
  return rounded;
}

}  // namespace vdwmesh
