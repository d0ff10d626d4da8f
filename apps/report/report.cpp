// What follows from the figures of a report alone: the sums over the levels of a refinement, the
// limits that they tend to, and the warnings that they call for. Nothing is computed from the mesh
// here, so reports of meshes that were read get the same warnings as those of our own.
#include "report/report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace vdwmesh::apps {
namespace {

// A mesh that is not closed or oriented has no volume, which the text alone would leave as a dash.
void add_shape_warnings(const MeshReport& mesh, Report& report) {
  report.warn_if(!mesh.topology.closed,
                 "the mesh is not closed: it has no volume, and its area misses the holes");
  report.warn_if(!mesh.topology.manifold, "the mesh is not a 2-manifold");
  report.warn_if(!mesh.topology.oriented,
                 "the triangles do not face one way: the mesh has no volume");
  report.warn_if(mesh.measures.volume.value_or(0) < 0,
                 "the mesh is inside out: its normals point inwards, its volume is negative");
  const std::uint64_t degenerate = mesh.quality.degenerate_triangles;
  report.warn_if(degenerate > 0, "{} degenerate triangles", degenerate);
  const std::uint64_t crossings = mesh.self_intersections.value_or(0);
  report.warn_if(crossings > 0, "{} pairs of triangles intersect each other", crossings);
}

// Of our own meshes: what the extraction or the projection could not do.
void add_extraction_warnings(const MeshReport& mesh, Report& report) {
  const std::uint64_t clipped = mesh.grid_clipped.value_or(0);
  report.warn_if(clipped > 0,
                 "the grid cuts the surface in {} cells, where the mesh is closed by a flat lid; "
                 "a larger --padding holds it all",
                 clipped);
  const NewtonSummary newton = summarize(mesh.projection);
  const std::uint64_t left = newton.unconverged + newton.out_of_reach;
  report.warn_if(left > 0,
                 "{} vertices were left where they were by the projection ({} unconverged, {} out "
                 "of reach)",
                 left, newton.unconverged, newton.out_of_reach);
}

constexpr std::pair<const char*, Timing::Stage Timing::*> kStages[] = {
    {"read", &Timing::read},
    {"plan", &Timing::plan},
    {"mesh", &Timing::mesh},
    {"levels", &Timing::levels},
    {"measure", &Timing::measure},
    {"self_intersections", &Timing::self_intersections},
    {"cgal_check", &Timing::cgal_check},
    {"exact", &Timing::exact},
    {"compare", &Timing::compare},
    {"picture", &Timing::picture},
    {"build", &Timing::build},
    {"write", &Timing::write}};

// The parts of making a mesh say themselves what they took; what is left is `setup`.
void add_mesh_parts(const Timing& timing, Seconds& seconds) {
  std::optional<double> setup;
  if (timing.mesh) {
    const double parts =
        timing.field.value_or(0) + timing.extract.value_or(0) + timing.refine.value_or(0);
    setup = std::max(timing.mesh->wall - parts, 0.0);
  }
  seconds.stages.insert(seconds.stages.end(), {{"field", timing.field},
                                               {"extract", timing.extract},
                                               {"refine", timing.refine},
                                               {"setup", setup}});
}

}  // namespace

NewtonSummary summarize(const std::vector<ProjectionStats>& levels) {
  NewtonSummary sum;
  sum.levels = levels;
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

void extrapolate(MeshReport& mesh) {
  if (mesh.levels.size() < 2) return;
  const MeshMeasures &coarse = mesh.levels.rbegin()[1].measures,
                     &fine = mesh.levels.back().measures;
  mesh.extrapolated_area = extrapolate_second_order(coarse.area, fine.area);
  if (coarse.volume && fine.volume) {
    mesh.extrapolated_volume = extrapolate_second_order(*coarse.volume, *fine.volume);
  }
}

void add(Timing::Stage& stage, const StageTime& lap) {
  const StageTime before = stage.value_or(StageTime{});
  stage = StageTime{before.wall + lap.wall, before.cpu + lap.cpu};
}

Seconds wall_seconds(const Timing& timing) {
  Seconds seconds;
  for (const auto& [name, member] : kStages) {
    const Timing::Stage& stage = timing.*member;
    if (member == &Timing::mesh) {
      add_mesh_parts(timing, seconds);
    } else {
      seconds.stages.push_back({name, stage ? std::optional(stage->wall) : std::nullopt});
    }
  }
  seconds.stages.push_back({"total", timing.total.wall});
  return seconds;
}

Seconds cpu_seconds(const Timing& timing) {
  Seconds seconds;
  for (const auto& [name, member] : kStages) {
    const Timing::Stage& stage = timing.*member;
    seconds.stages.push_back({name, stage ? std::optional(stage->cpu) : std::nullopt});
  }
  seconds.stages.push_back({"total", timing.total.cpu});
  return seconds;
}

void add_warnings(Report& report) {
  if (report.mesh) {
    add_shape_warnings(*report.mesh, report);
    add_extraction_warnings(*report.mesh, report);
  }
}

}  // namespace vdwmesh::apps
