// Distances to the excluded surface: makes the surface, then measures points, a mesh's samples and
// the surface's samples, block by block. Sums of blocks are joined in their order, so that results
// do not depend on the number of threads.
#include "excluded/excluded_distances.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "analysis/distances/distances_blocks.hpp"
#include "analysis/distances/distances_plan.hpp"
#include "analysis/distances/mesh_finder.hpp"
#include "analysis/distances/mesh_to_surface.hpp"
#include "analysis/survey/stage_bytes.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "excluded/distances/excluded_finder.hpp"
#include "excluded/distances/surface_samples.hpp"

namespace vdwmesh {
namespace {

using excluded::ExcludedFinder;
using excluded::JudgedSurface;
using excluded::SurfaceSamples;

// Patches of the surface that a thread takes together.
constexpr std::size_t kElementsPerBlock = 64;

DistanceStatistics from_surface(const SurfaceSamples& samples, const MeshFinder& finder,
                                Monitor* monitor) {
  const std::size_t elements = samples.element_count();
  const std::size_t blocks = block_count(elements, kElementsPerBlock);
  BlockStatistics statistics(blocks);
  begin_stage(monitor, "distances of the surface", blocks);
  const auto visit = [&](std::size_t block, std::size_t first, std::size_t end) {
    std::vector<Vec3d> inside, border;
    const auto take = [&] {
      advance(monitor, 0);
      statistics.add_samples(block, inside, border, finder);
      inside.clear();
      border.clear();
    };
    for (std::size_t i = first; i < end; ++i) samples.add(i, inside, border, take);
    take();
  };
  for_each_block(elements, kElementsPerBlock, visit, monitor);
  return statistics.result();
}

// The lattice of a concave patch goes over the whole sphere of its probe.
void check_lattices(std::size_t probes, double probe, double density) {
  constexpr double kMostPoints = 1e11;  // take minutes
  const double points = static_cast<double>(probes) * 2 * kTwoPi * probe * probe * density;
  if (points <= kMostPoints) return;
  throw LimitExceeded(
      fmt::format("{} spheres of a probe of {:.3g} Å have {:.1e} places for samples, {:.0e} are "
                  "allowed: choose "
                  "at most {:.3g} samples per Å² or no distances",
                  probes, probe, points, kMostPoints, density * kMostPoints / points));
}

void check_bytes(const IndexedMesh& mesh, std::size_t atoms, std::uint64_t limit) {
  const std::uint64_t need =
      indexed_mesh_bytes(mesh) +
      excluded_distances_bytes({mesh.vertex_count(), mesh.triangle_count()}, atoms);
  if (need <= limit) return;
  throw LimitExceeded(fmt::format(
      "distances of {} triangles to the excluded surface of {} atoms need {} bytes with the mesh, "
      "{} are allowed: choose a higher memory limit or no distances",
      mesh.triangle_count(), atoms, need, limit));
}

}  // namespace

std::vector<double> excluded_signed_distances(std::span<const Vec3d> points, const SphereSet& atoms,
                                              double probe, Monitor* monitor, ExcludedPart part) {
  check_points(points, atoms, "point");
  const SphereSet grown = excluded::grown_by(atoms, probe);
  begin_stage(monitor, "excluded surface", 1);
  const JudgedSurface surface(atoms, probe, part, monitor);
  const ExposedSurface accessible(grown, monitor);
  const ExcludedFinder finder(accessible, surface, probe, box_around(bounding_box(grown), points));
  std::vector<double> found(points.size());
  begin_stage(monitor, "signed distances", block_count(points.size(), kDistancesPerBlock));
  const auto measure = [&](std::size_t, std::size_t first, std::size_t end) {
    finder.find(points.subspan(first, end - first), found.data() + first);
  };
  for_each_block(points.size(), kDistancesPerBlock, measure, monitor);
  return found;
}

MeshDistances excluded_distances(const IndexedMesh& mesh, const SphereSet& atoms, double probe,
                                 const DistanceOptions& options, ExcludedPart part) {
  const SphereSet grown = excluded::grown_by(atoms, probe);
  const DistancePlan plan = plan_distances(mesh, grown, options);
  check_bytes(mesh, atoms.size(), options.memory_limit);
  // The surface is about as large as that of the atoms, however large the probe.
  const double density = surface_density(atoms, options);
  begin_stage(options.monitor, "excluded surface", 1);
  const JudgedSurface surface(atoms, probe, part, options.monitor);
  check_lattices(surface.grown.surface.probes.size(), probe, density);
  const ExposedSurface accessible(grown, options.monitor);
  DistanceStatistics of_mesh{};
  {
    const ExcludedFinder finder(accessible, surface, probe, plan.world);
    const auto find = [&](std::span<const Vec3d> points, double* found) {
      finder.find(points, found);
    };
    const auto largest = [&](std::span<const Vec3d> points, double least) {
      std::vector<double> found(points.size());
      finder.find(points, found.data());
      for (const double distance : found) least = std::max(least, std::abs(distance));
      return least;
    };
    of_mesh = mesh_to_surface(mesh, {find, largest}, options);
  }
  const SurfaceSamples samples(surface, accessible, probe, density, options.seed);
  const DistanceStatistics of_surface =
      from_surface(samples, MeshFinder(mesh, plan.world), options.monitor);
  return both_ways(of_mesh, of_surface, options.seed);
}

// Measured on molecules: an atom has some 1.4 probes, a third of them low, with 700 bytes each for
// the patch of a low one. The triangulation, the complex and the arcs are those of the measures.
std::uint64_t excluded_distances_bytes(const MeshSize& mesh, std::uint64_t atoms) {
  constexpr std::uint64_t kBytesPerAtom = 500;
  constexpr double kMostlyBuried = 0.06;
  return distances_bytes(mesh, atoms) + union_bytes(atoms, UnionMethod::both, kMostlyBuried) +
         kBytesPerAtom * atoms;
}

}  // namespace vdwmesh
