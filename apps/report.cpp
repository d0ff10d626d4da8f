#include "report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace vdwmesh::apps {
namespace {

void add_shape_warnings(const MeshReport& mesh, std::vector<std::string>& warnings) {
  if (!mesh.topology.closed) {
    warnings.push_back("the mesh is not closed: it has no volume, and its area misses the holes");
  }
  if (!mesh.topology.manifold) warnings.push_back("the mesh is not a 2-manifold");
  if (!mesh.topology.oriented) {
    warnings.push_back("the triangles do not face one way: the mesh has no volume");
  }
  if (mesh.measures.volume && *mesh.measures.volume < 0) {
    warnings.push_back("the mesh is inside out: its normals point inwards, its volume is negative");
  }
  if (mesh.quality.degenerate_triangles > 0) {
    warnings.push_back(fmt::format("{} degenerate triangles", mesh.quality.degenerate_triangles));
  }
  if (mesh.self_intersections.value_or(0) > 0) {
    warnings.push_back(
        fmt::format("{} pairs of triangles intersect each other", *mesh.self_intersections));
  }
}

void add_extraction_warnings(const MeshReport& mesh, std::vector<std::string>& warnings) {
  if (mesh.grid_clipped.value_or(0) > 0) {
    warnings.push_back(fmt::format(
        "the grid cuts the surface in {} cells, where the mesh is closed by a flat lid; a larger "
        "--padding holds it all",
        *mesh.grid_clipped));
  }
  const NewtonSummary newton = summarize(mesh.projection);
  if (newton.unconverged + newton.out_of_reach > 0) {
    warnings.push_back(fmt::format(
        "{} vertices were left where they were by the projection ({} unconverged, {} out of reach)",
        newton.unconverged + newton.out_of_reach, newton.unconverged, newton.out_of_reach));
  }
}

}  // namespace

NewtonSummary summarize(const std::vector<ProjectionStats>& levels) {
  NewtonSummary sum;
  for (const ProjectionStats& level : levels) {
    sum.iterations_max = std::max(sum.iterations_max, level.iterations_max);
    sum.residual_max = std::max(sum.residual_max, level.residual_max);
    sum.projected += level.projected;
    sum.unconverged += level.unconverged;
    sum.out_of_reach += level.out_of_reach;
    sum.undone += level.undone;
    sum.turned = level.turned;
  }
  return sum;
}

void extrapolate(TriangleLabels labels, MeshReport& mesh) {
  if (labels == TriangleLabels::none || mesh.levels.size() < 2) return;
  const MeshMeasures &coarse = mesh.levels.rbegin()[1].measures,
                     &fine = mesh.levels.back().measures;
  mesh.extrapolated_area = extrapolate_second_order(coarse.area, fine.area);
  if (coarse.volume && fine.volume) {
    mesh.extrapolated_volume = extrapolate_second_order(*coarse.volume, *fine.volume);
  }
}

void add_warnings(Report& report) {
  if (report.mesh) {
    add_shape_warnings(*report.mesh, report.warnings);
    add_extraction_warnings(*report.mesh, report.warnings);
  }
}

}  // namespace vdwmesh::apps
