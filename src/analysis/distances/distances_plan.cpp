// The checks of distances() and the density of its samples. Loops over all triangles or vertices
// run on all cores: on one core they would take longer than a device needs for the distances.
#include "analysis/distances/distances_plan.hpp"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/distances/distances_statistics.hpp"
#include "analysis/survey/stage_bytes.hpp"
#include "core/errors.hpp"
#include "core/sum.hpp"
#include "spheres/box.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

// Bounds of the number of samples in each direction. They are applied twice, by two calls of
// density_for(): once to the mesh, and once to all whole spheres together. Samples on buried parts
// of spheres are discarded, so fewer than kLeastSamples may remain on the surface.
constexpr double kLeastSamples = 1e4;
constexpr double kMostSamples = 1e12;  // more would take weeks

constexpr std::size_t kGrain = std::size_t{1} << 15;  // points

using Range = tbb::blocked_range<std::size_t>;

// Returns the lowest index below `count` for which the condition holds, or `count`.
template <class Condition>
std::size_t first_index(std::size_t count, const Condition& holds) {
  const auto search = [&](const Range& range, std::size_t least) {
    for (std::size_t i = range.begin(); i < std::min(least, range.end()); ++i)
      if (holds(i)) return i;
    return least;
  };
  return tbb::parallel_reduce(Range(0, count, kGrain), count, search,
                              [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

bool is_finite(const Vec3d& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

// Throws LimitExceeded if the triangles are too many for the 32-bit indices of BoxTree, or if mesh,
// search tree and exposed surface need more than `limit` bytes.
//
// The second message proposes coarser meshes. One subdivision less divides the numbers of vertices
// and triangles by 4, and a spacing s times as wide divides them by s². The proposals treat all
// bytes so. The bytes of the spheres do not shrink, but they are few beside a large mesh. The
// factor 1.02 is a margin: it exceeds the rounding of the printed spacing to three digits (0.5 %).
void check_memory(const IndexedMesh& mesh, std::size_t spheres, std::uint64_t limit) {
  constexpr std::uint32_t kMostTriangles = std::numeric_limits<std::uint32_t>::max() - 1;
  const std::uint64_t triangles = mesh.triangle_count();
  if (triangles > kMostTriangles) {
    throw LimitExceeded(
        fmt::format("distances take at most {} triangles, the mesh has {}: subdivide it once less",
                    kMostTriangles, triangles));
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

// The smallest box around all triangles and the balls. Vertices of no triangle are not measured.
// The boxes of a search tree are rounded to 2^-21 of this box, so that all triangles of a molecule
// that is a speck in it are near every query. Few may be.
Box world_of(const IndexedMesh& mesh, const SphereSet& spheres) {
  constexpr double kMostTimes = 1 << 16;
  constexpr std::size_t kFew = 30'000;
  const Box balls = bounding_box(spheres);
  const auto longest = [](const Box& box) {
    const Vec3d side = box.upper - box.lower;
    return std::max({side.x, side.y, side.z});
  };
  const auto grow = [&](const Range& range, Box all) {
    for (std::size_t t = range.begin(); t < range.end(); ++t)
      for (const std::uint32_t v : mesh.triangles[t]) include(all, mesh.positions[v]);
    return all;
  };
  const Box world = tbb::parallel_reduce(Range(0, mesh.triangle_count(), kGrain), balls, grow,
                                         [](Box a, const Box& b) {
                                           include(a, b);
                                           return a;
                                         });
  if (longest(world) <= kMostTimes * longest(balls)) return world;
  if (mesh.triangle_count() + spheres.size() <= kFew) return world;
  throw LimitExceeded(fmt::format(
      "mesh and molecule together are {:.3g} Å long, {:.3g} times as long as the molecule: choose "
      "no distances; is the mesh in Å, and of this molecule?",
      longest(world), longest(world) / longest(balls)));
}

// Returns the area of all whole spheres, Å²: the sum of 4 π r².
double area_of(const SphereSet& spheres) {
  WideSum total;
  for (const Sphere& s : spheres.spheres()) total.add(2 * kTwoPi * s.radius * s.radius);
  return total.value();
}

}  // namespace

DistancePlan plan_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                            const DistanceOptions& options) {
  if (spheres.empty()) throw InvalidInput("no spheres: their union has no boundary");
  if (mesh.triangles.empty())
    throw InvalidInput("the mesh has no triangles: there is nothing to measure distances of");
  check_triangles(mesh.triangles, mesh.vertex_count());
  check_points(mesh.positions, spheres, "vertex");
  check_memory(mesh, spheres.size(), options.memory_limit);
  const double density = surface_density(spheres, options);
  return {world_of(mesh, spheres), density};
}

double surface_density(const SphereSet& spheres, const DistanceOptions& options) {
  return density_for(area_of(spheres), options.samples_per_area);
}

AreaStrata plan_mesh_samples(double area, const DistanceOptions& options) {
  const double samples = std::ceil(area * density_for(area, options.samples_per_area));
  const double bytes = samples / kDistancesPerBlock * sizeof(DistanceSums);
  if (bytes > static_cast<double>(options.memory_limit)) {
    throw LimitExceeded(fmt::format(
        "the sums over {:.3g} samples on {:.3g} Å² of the mesh need {:.3g} bytes, {} are allowed: "
        "choose fewer samples per Å² or no distances; is the mesh in Å?",
        samples, area, bytes, options.memory_limit));
  }
  return {area, static_cast<std::uint64_t>(samples), options.seed};
}

void check_points(std::span<const Vec3d> points, const SphereSet& spheres, const char* what) {
  if (spheres.empty()) throw InvalidInput("no spheres: their union has no boundary");
  const auto is_broken = [&](std::size_t i) { return !is_finite(points[i]); };
  const std::size_t i = first_index(points.size(), is_broken);
  if (i < points.size()) throw InvalidInput(fmt::format("{} {} is not finite", what, i));
}

Box box_around(Box box, std::span<const Vec3d> points) {
  const auto grow = [&](const Range& range, Box all) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) include(all, points[i]);
    return all;
  };
  const auto join = [](Box a, const Box& b) {
    include(a, b);
    return a;
  };
  // Minima and maxima do not depend on how the points are divided.
  include(box, tbb::parallel_reduce(Range(0, points.size(), kGrain), empty_box(), grow, join));
  return box;
}

MeshDistances both_ways(const DistanceStatistics& mesh_to_surface,
                        const DistanceStatistics& surface_to_mesh, std::uint64_t seed) {
  return {mesh_to_surface, surface_to_mesh, std::max(mesh_to_surface.max, surface_to_mesh.max),
          mesh_to_surface.samples + surface_to_mesh.samples, seed};
}

}  // namespace vdwmesh
