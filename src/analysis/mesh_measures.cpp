// Topology, area and volume of a mesh (summarize(), topology(), measures()), and all measures
// together (examine()).
//
// survey_edges() finds the shells, shell_terms() sums up the triangles of each.
#include "analysis/mesh_measures.hpp"

#include <optional>

#include "analysis/distribution.hpp"
#include "analysis/edge_survey.hpp"
#include "analysis/quality_parts.hpp"
#include "analysis/shell_sums.hpp"
#include "core/blocks.hpp"
#include "surface/box.hpp"

namespace vdwmesh {
namespace {

Vec3d local_origin(const IndexedMesh& mesh) {
  return mesh.positions.empty() ? Vec3d{0, 0, 0} : middle(box_of_vertices(mesh));
}

MeshSummary summarize(const IndexedMesh& mesh, const EdgeBuckets& buckets) {
  const EdgeSurvey survey = survey_edges(mesh, buckets);
  ShellTotals totals;
  add_shells(totals, shell_terms(mesh, survey.shell_of, local_origin(mesh)));
  const MeshCounts counts{survey.closed,         survey.manifold,      survey.oriented,
                          mesh.vertex_count(),   survey.used_vertices, survey.edges,
                          mesh.triangle_count(), survey.shells};
  return {topology_of(counts, totals), measures_of(counts, totals)};
}

}  // namespace

Box box_of_vertices(const IndexedMesh& mesh) {
  const auto add = [&](std::size_t v, Box& box) { include(box, mesh.positions[v]); };
  const auto join = [](Box a, const Box& b) {
    include(a, b);
    return a;
  };
  return reduce_all(mesh.vertex_count(), empty_box(), add, join);
}

MeshSummary summarize(const IndexedMesh& mesh) {
  return summarize(mesh, EdgeBuckets(mesh.triangles, mesh.vertex_count()));
}

MeshExamination examine(const IndexedMesh& mesh) {
  std::optional<EdgeBuckets> buckets(std::in_place, mesh.triangles, mesh.vertex_count());
  const MeshSummary summary = summarize(mesh, *buckets);
  const Distribution edge_length = distribution_of(edge_lengths(whole(mesh), *buckets));
  // The buckets are freed before quality_of_triangles() allocates arrays of about the same size.
  buckets.reset();
  MeshExamination result{summary.topology, summary.measures, quality_of_triangles(mesh)};
  result.quality.edge_length = edge_length;
  return result;
}

MeshTopology topology(const IndexedMesh& mesh) { return summarize(mesh).topology; }

MeshMeasures measures(const IndexedMesh& mesh) { return summarize(mesh).measures; }

}  // namespace vdwmesh
