// Topology, area and volume of a mesh (summarize(), topology(), measures()), and all measures
// together (examine()).
//
// survey_edges() finds the shells. Then one parallel pass over the triangles sums area and signed
// volume of every shell: the volume is the sum of the tetrahedra between each triangle and a common
// origin (divergence theorem). Blocks of triangles have a fixed size, their sums are compensated
// (WideSum) and joined in order, so results do not depend on the number of threads.
#include "analysis/mesh_measures.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/edge_survey.hpp"
#include "analysis/quality_parts.hpp"
#include "core/blocks.hpp"
#include "core/fixed_blocks.hpp"
#include "core/multiversion.hpp"
#include "core/sum.hpp"
#include "surface/box.hpp"

namespace vdwmesh {
namespace {

constexpr std::size_t kTrianglesPerBlock = 1 << 13;

// Area and signed volume of a set of triangles; positive if they face outwards.
struct Sums {
  WideSum area;    // Å²
  WideSum volume;  // Å³, of the tetrahedra with their apex at the local origin
  void add(const Sums& other) {
    area.add(other.area);
    volume.add(other.volume);
  }
};

// The sums of a run: consecutive triangles of one block that belong to the same shell. Triangles of
// a shell are mostly consecutive, so a block has few runs.
struct Run {
  std::uint32_t shell;
  Sums sums;
};

// Returns the middle of the bounding box. Coordinates relative to it are no larger than the mesh,
// so volumes of meshes far from the coordinate origin do not lose digits.
Vec3d local_origin(const IndexedMesh& mesh) {
  if (mesh.positions.empty()) return {0, 0, 0};
  const auto add = [&](std::size_t v, Box& box) { include(box, mesh.positions[v]); };
  const auto join = [](Box a, const Box& b) {
    include(a, b);
    return a;
  };
  return middle(reduce_all(mesh.vertex_count(), empty_box(), add, join));
}

// Appends the runs of the triangles [begin, end). With the edge vectors u, v at vertex a the area
// of a triangle is |u × v| / 2 and the volume of its tetrahedron (a - origin) · (u × v) / 6.
VDWMESH_MULTIVERSION void sum_block(const IndexedMesh& mesh, const EdgeSurvey& survey,
                                    const Vec3d& origin, std::size_t begin, std::size_t end,
                                    std::vector<Run>& runs) {
  for (std::size_t t = begin; t < end; ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3d a = mesh.positions[i];
    const Vec3d twice_area = cross(mesh.positions[j] - a, mesh.positions[k] - a);
    if (runs.empty() || runs.back().shell != survey.shell_of[t])
      runs.push_back({survey.shell_of[t], {}});
    runs.back().sums.area.add(norm(twice_area) / 2);
    runs.back().sums.volume.add(dot(a - origin, twice_area) / 6);
  }
}

// Returns the sums of every shell. Runs are added in the order of their triangles.
std::vector<Sums> sum_shells(const IndexedMesh& mesh, const EdgeSurvey& survey) {
  const Vec3d origin = local_origin(mesh);
  const std::size_t triangles = mesh.triangle_count();
  std::vector<std::vector<Run>> blocks(block_count(triangles, kTrianglesPerBlock));
  for_each_block(triangles, kTrianglesPerBlock,
                 [&](std::size_t b, std::size_t first, std::size_t last) {
                   sum_block(mesh, survey, origin, first, last, blocks[b]);
                 });
  std::vector<Sums> shells(survey.shells);
  for (const std::vector<Run>& runs : blocks)
    for (const Run& run : runs) shells[run.shell].add(run.sums);
  return shells;
}

// Adds up the shells. Volume is defined for closed, oriented meshes only, and so is the distinction
// of outer shells (positive volume) and voids (negative volume). All sums are computed for every
// mesh, and the undefined ones are left out of the result.
MeshMeasures totals(const std::vector<Sums>& shells, const EdgeSurvey& survey) {
  WideSum area, volume, outer, voids;
  for (const Sums& shell : shells) {
    area.add(shell.area);
    volume.add(shell.volume);
    if (shell.volume.value() > 0) outer.add(shell.area);
    if (shell.volume.value() < 0) voids.add(shell.area);
  }
  MeshMeasures result{area.value(), {}, {}, {}};
  if (survey.closed && survey.oriented) {
    result.volume = volume.value();
    result.outer_area = outer.value();
    result.void_area = voids.value();
  }
  return result;
}

// Collects the topology. Isolated vertices do not count in χ = V - E + F. A shell of Euler
// characteristic χᵢ has the genus 1 - χᵢ/2, so the sum over all shells is (number of shells) - χ/2.
MeshTopology describe(const IndexedMesh& mesh, const EdgeSurvey& survey,
                      const std::vector<Sums>& shells) {
  MeshTopology result{};
  result.closed = survey.closed;
  result.manifold = survey.manifold;
  result.oriented = survey.oriented;
  result.vertices = mesh.vertex_count();
  result.edges = survey.edges;
  result.triangles = mesh.triangle_count();
  result.isolated_vertices = result.vertices - survey.used_vertices;
  result.shells = survey.shells;
  result.euler_characteristic = static_cast<std::int64_t>(survey.used_vertices) -
                                static_cast<std::int64_t>(survey.edges) +
                                static_cast<std::int64_t>(result.triangles);
  if (!survey.closed || !survey.oriented) return result;
  const auto count = [&](auto&& wanted) {
    return static_cast<std::uint64_t>(std::count_if(
        shells.begin(), shells.end(), [&](const Sums& s) { return wanted(s.volume.value()); }));
  };
  result.components = count([](double volume) { return volume > 0; });
  result.voids = count([](double volume) { return volume < 0; });
  if (survey.manifold)
    result.genus = static_cast<std::int64_t>(result.shells) - result.euler_characteristic / 2;
  return result;
}

MeshSummary summarize(const IndexedMesh& mesh, const EdgeBuckets& buckets) {
  const EdgeSurvey survey = survey_edges(mesh, buckets);
  const std::vector<Sums> shells = sum_shells(mesh, survey);
  return {describe(mesh, survey, shells), totals(shells, survey)};
}

}  // namespace

MeshSummary summarize(const IndexedMesh& mesh) {
  return summarize(mesh, EdgeBuckets(mesh.triangles, mesh.vertex_count()));
}

MeshExamination examine(const IndexedMesh& mesh) {
  std::optional<EdgeBuckets> buckets(std::in_place, mesh.triangles, mesh.vertex_count());
  const MeshSummary summary = summarize(mesh, *buckets);
  const Distribution edge_length = edge_length_distribution(mesh, *buckets);
  // The buckets are freed before quality_of_triangles() allocates arrays of about the same size.
  buckets.reset();
  MeshExamination result{summary.topology, summary.measures, quality_of_triangles(mesh)};
  result.quality.edge_length = edge_length;
  return result;
}

MeshTopology topology(const IndexedMesh& mesh) { return summarize(mesh).topology; }

MeshMeasures measures(const IndexedMesh& mesh) { return summarize(mesh).measures; }

}  // namespace vdwmesh
