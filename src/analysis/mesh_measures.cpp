// Topology, area and volume of a mesh (summarize(), topology(), measures()), and all measures
// together (examine()).
//
// survey_edges() finds the shells, shell_terms() sums up the triangles of each.
#include "analysis/mesh_measures.hpp"

#include <utility>

#include "analysis/distances/distribution.hpp"
#include "analysis/survey/edge_survey.hpp"
#include "analysis/survey/quality_parts.hpp"
#include "analysis/survey/shell_sums.hpp"
#include "core/blocks.hpp"
#include "spheres/box.hpp"

namespace vdwmesh {
namespace {

Vec3d local_origin(const IndexedMesh& mesh) {
  return mesh.positions.empty() ? Vec3d{0, 0, 0} : middle(box_of_vertices(mesh));
}

// If `edge_lengths` is given, it gets the length of each edge.
MeshSummary summarize(const IndexedMesh& mesh, BracketedValues* edge_lengths) {
  const EdgeSurvey survey = survey_edges(mesh, edge_lengths);
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

MeshSummary summarize(const IndexedMesh& mesh) { return summarize(mesh, nullptr); }

MeshExamination examine(const IndexedMesh& mesh) {
  QualitySample sample = sample_quality(whole(mesh), usual_sample_step(mesh.triangle_count()));
  MeshSummary summary;
  const Distribution edge_length = distribution_by_sample(
      std::move(sample.edge_lengths),
      [&](BracketedValues& lengths) { summary = summarize(mesh, &lengths); });
  MeshExamination result{summary.topology, summary.measures,
                         quality_of_triangles(mesh, std::move(sample))};
  result.quality.edge_length = edge_length;
  return result;
}

MeshTopology topology(const IndexedMesh& mesh) { return summarize(mesh).topology; }

MeshMeasures measures(const IndexedMesh& mesh) { return summarize(mesh).measures; }

}  // namespace vdwmesh
