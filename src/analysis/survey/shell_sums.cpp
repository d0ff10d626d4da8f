// shell_terms(): one parallel pass over blocks of triangles. Within a block, consecutive triangles
// of one shell are a run, whose sums are exact; the pieces of an exact sum are its terms.
// add_shells() sorts the terms by shell.
#include "analysis/survey/shell_sums.hpp"

#include <algorithm>

#include "core/fixed_blocks.hpp"
#include "core/lanes/multiversion.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kTrianglesPerBlock = 1 << 13;

// Area and signed volume of triangles.
struct AreaAndVolume {
  ExactSum area, volume;  // Å², Å³
};

// Adds the triangles from `begin` to the end of the run that begins there, and returns where that
// is, at most `end`.
VDWMESH_MULTIVERSION std::size_t sum_run(const IndexedMesh& mesh,
                                         std::span<const std::uint32_t> shell_of,
                                         const Vec3d& origin, std::size_t begin, std::size_t end,
                                         AreaAndVolume& sums) {
  constexpr std::size_t kAtOnce = 512;  // triangles
  double areas[kAtOnce], volumes[kAtOnce];
  const std::uint32_t shell = shell_of[begin];
  std::size_t t = begin;
  while (t < end && shell_of[t] == shell) {
    std::size_t count = 0;
    for (; count < kAtOnce && t < end && shell_of[t] == shell; ++t, ++count) {
      const auto& [i, j, k] = mesh.triangles[t];
      const Vec3d a = mesh.positions[i];
      const Vec3d twice_area = cross(mesh.positions[j] - a, mesh.positions[k] - a);
      areas[count] = norm(twice_area) / 2;
      volumes[count] = dot(a - origin, twice_area) / 6;
    }
    sums.area.add(std::span<const double>(areas, count));
    sums.volume.add(std::span<const double>(volumes, count));
  }
  return t;
}

// Area and volume have different numbers of pieces; 0 stands where one has fewer.
void append_terms(std::uint64_t shell, const AreaAndVolume& sums, std::vector<ShellTerm>& terms) {
  std::vector<double> areas, volumes;
  sums.area.append_terms(areas);
  sums.volume.append_terms(volumes);
  const std::size_t count = std::max(areas.size(), volumes.size());
  areas.resize(count);
  volumes.resize(count);
  for (std::size_t i = 0; i < count; ++i) terms.push_back({shell, areas[i], volumes[i]});
}

// Adds one shell.
void add_shell(ShellTotals& totals, std::span<const ShellTerm> terms) {
  AreaAndVolume shell;
  for (const ShellTerm& term : terms) {
    shell.area.add(term.area);
    shell.volume.add(term.volume);
  }
  totals.area.add(shell.area);
  totals.volume.add(shell.volume);
  const double volume = shell.volume.nearest();  // has the sign of the exact sum
  if (volume > 0) totals.outer_area.add(shell.area);
  if (volume < 0) totals.void_area.add(shell.area);
  totals.components += volume > 0;
  totals.voids += volume < 0;
}

}  // namespace

std::vector<ShellTerm> shell_terms(const IndexedMesh& mesh, std::span<const std::uint32_t> shell_of,
                                   const Vec3d& origin) {
  std::vector<std::vector<ShellTerm>> blocks(block_count(shell_of.size(), kTrianglesPerBlock));
  for_each_block(shell_of.size(), kTrianglesPerBlock,
                 [&](std::size_t b, std::size_t first, std::size_t last) {
                   while (first < last) {
                     AreaAndVolume sums;
                     const std::uint32_t shell = shell_of[first];
                     first = sum_run(mesh, shell_of, origin, first, last, sums);
                     append_terms(shell, sums, blocks[b]);
                   }
                 });
  std::vector<ShellTerm> terms;
  for (const std::vector<ShellTerm>& block : blocks) {
    terms.insert(terms.end(), block.begin(), block.end());
  }
  return terms;
}

void add(ShellTotals& totals, const ShellTotals& other) {
  totals.area.add(other.area);
  totals.volume.add(other.volume);
  totals.outer_area.add(other.outer_area);
  totals.void_area.add(other.void_area);
  totals.components += other.components;
  totals.voids += other.voids;
}

void add_shells(ShellTotals& totals, std::vector<ShellTerm> terms) {
  std::ranges::sort(terms, {}, &ShellTerm::shell);
  for (auto first = terms.begin(); first != terms.end();) {
    const std::uint64_t shell = first->shell;
    const auto end =
        std::find_if(first, terms.end(), [=](const ShellTerm& t) { return t.shell != shell; });
    add_shell(totals, std::span(first, end));
    first = end;
  }
}

// Isolated vertices do not count in χ = V - E + F. A shell of Euler characteristic χᵢ has the genus
// 1 - χᵢ/2, so the sum over all shells is (number of shells) - χ/2.
MeshTopology topology_of(const MeshCounts& counts, const ShellTotals& totals) {
  MeshTopology result{};
  result.closed = counts.closed;
  result.manifold = counts.manifold;
  result.oriented = counts.oriented;
  result.vertices = counts.vertices;
  result.edges = counts.edges;
  result.triangles = counts.triangles;
  result.isolated_vertices = counts.vertices - counts.used_vertices;
  result.shells = counts.shells;
  result.euler_characteristic = static_cast<std::int64_t>(counts.used_vertices) -
                                static_cast<std::int64_t>(counts.edges) +
                                static_cast<std::int64_t>(counts.triangles);
  if (!counts.closed || !counts.oriented) return result;
  result.components = totals.components;
  result.voids = totals.voids;
  if (counts.manifold) {
    result.genus = static_cast<std::int64_t>(result.shells) - result.euler_characteristic / 2;
  }
  return result;
}

// Volume is defined for closed, oriented meshes only, and so is the distinction of outer shells and
// voids. All sums are computed for every mesh, and the undefined ones are left out of the result.
MeshMeasures measures_of(const MeshCounts& counts, const ShellTotals& totals) {
  MeshMeasures result{totals.area.nearest(), {}, {}, {}};
  if (!counts.closed || !counts.oriented) return result;
  result.volume = totals.volume.nearest();
  result.outer_area = totals.outer_area.nearest();
  result.void_area = totals.void_area.nearest();
  return result;
}

}  // namespace vdwmesh
