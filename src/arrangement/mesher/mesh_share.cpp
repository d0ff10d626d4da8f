// Shares and memory go by the number of equilateral triangles of its edge length that the area of a
// patch holds.
#include "arrangement/mesher/mesh_share.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

double ideal_triangles(const PatchExtents& patches, std::size_t ball) {
  const double length = patches.edge_lengths[ball];
  return patches.areas[ball] / (std::sqrt(3.0) / 4) / (length * length);
}

// The run of this process of `count` elements that are shared out evenly.
MeshShare::Run even_run(const MeshTeam& team, std::uint64_t count) {
  const auto begin = [&](std::uint64_t number) {
    return static_cast<std::uint32_t>(count * number / team.count());
  };
  return {begin(team.number()), begin(team.number() + 1)};
}

}  // namespace

std::vector<double> scaled_edge_lengths(const PlacedBalls& t, const ExactMeshOptions& options) {
  std::vector<double> lengths;
  lengths.reserve(t.balls.size());
  for (const SphereId id : t.ids) {
    const double length =
        options.edge_lengths.empty() ? options.edge_length : options.edge_lengths[id];
    lengths.push_back(std::ldexp(length, -t.scale_exponent));
  }
  return lengths;
}

// Corners and arcs are shared out evenly. The balls of a process are those whose middle triangle,
// of all in the order of the balls, is in its part. kPatch is what a patch costs besides its
// triangles, in triangles.
MeshShare own_share(const MeshTeam& team, const BoundaryArcs& boundary,
                    const PatchExtents& patches) {
  const std::size_t balls = patches.areas.size();
  MeshShare share{{0, static_cast<std::uint32_t>(balls)},
                  even_run(team, boundary.corners.size()),
                  even_run(team, boundary.arcs.size())};
  if (team.count() == 1) return share;
  constexpr double kPatch = 20;
  std::vector<double> middles;
  double before = 0;
  for (std::size_t b = 0; b < balls; ++b) {
    const double triangles = ideal_triangles(patches, b);
    const double cost = triangles > 0 ? triangles + kPatch : 0;
    middles.push_back(before + cost / 2);
    before += cost;
  }
  const auto begin = [&](std::size_t number) {
    if (number == 0) return share.balls.first;
    if (number == team.count()) return share.balls.second;
    const double part = static_cast<double>(number) / static_cast<double>(team.count());
    const auto first = std::ranges::lower_bound(middles, part * before);
    return static_cast<std::uint32_t>(first - middles.begin());
  };
  const MeshShare::Run own{begin(team.number()), begin(team.number() + 1)};
  share.balls = own;
  return share;
}

// The number of triangles is estimated: the ideal number times kFill, plus four per piece for
// narrow parts of patches. A closed mesh has about half as many vertices as triangles. By how much
// edges must be longer follows from the count, which falls with the square of the edge length, and
// 5 % are added for safety.
void check_memory(const MeshShare& share, const PatchExtents& patches, std::uint64_t pieces,
                  const ExactMeshOptions& options) {
  constexpr double kFill = 1.4;  // allowance over the ideal number of triangles
  // Bytes per triangle for the patches before they are joined.
  constexpr std::uint64_t kScratch = 40;
  double ideal = 0;
  for (std::uint32_t b = share.balls.first; b < share.balls.second; ++b) {
    ideal += ideal_triangles(patches, b);
  }
  const double triangles = kFill * ideal + 4 * static_cast<double>(pieces);
  // Just below 2^64. A triangle takes less than 200 bytes, so with at most kMost / 200 triangles
  // the number of bytes fits 64 bits.
  constexpr double kMost = 1.8e19;
  const auto count = static_cast<std::uint64_t>(std::min(triangles, kMost / 200));
  const std::uint64_t vertices = count / 2;
  const std::uint64_t need = indexed_mesh_bytes({vertices, count}, kPatchArrays) + kScratch * count;
  if (need <= options.memory_limit && vertices <= kMaxVertices) return;
  const double longer =
      1.05 *
      std::max(std::sqrt(static_cast<double>(need) / static_cast<double>(options.memory_limit)),
               std::sqrt(static_cast<double>(vertices) / static_cast<double>(kMaxVertices)));
  if (!options.edge_lengths.empty()) {
    throw LimitExceeded(fmt::format(
        "these edge lengths need about {} triangles and {} bytes, {} are allowed: choose lengths "
        "{:.2g} times as long or a higher memory limit",
        count, need, options.memory_limit, longer));
  }
  throw LimitExceeded(fmt::format(
      "an edge length of {} Å needs about {} triangles and {} bytes, {} are allowed: choose an "
      "edge length of at least {:.2g} Å or a higher memory limit",
      options.edge_length, count, need, options.memory_limit, options.edge_length * longer));
}

void check_vertices(std::uint64_t vertices) {
  if (vertices <= kMaxVertices) return;
  throw LimitExceeded(fmt::format(
      "{} vertices; a mesh holds at most {}: choose a larger edge length", vertices, kMaxVertices));
}

}  // namespace vdwmesh
