// The report on a mesh as text for people: shape, quality, levels of a refinement, what proves the
// mesh, and distances to the exact surface.
#include <cmath>
#include <optional>
#include <vector>

#include "report/report_text_parts.hpp"

namespace vdwmesh::apps {
namespace {

// The word for a property, "closed" for example, or "NOT closed".
std::string affirmed(bool value, std::string_view noun) {
  return fmt::format("{}{}", value ? "" : "NOT ", noun);
}

void distribution_row(Text out, std::string_view label, const Distribution& d,
                      std::string_view unit) {
  fmt::format_to(out, "{:<22}{:>14.4g}{:>10.4g}{:>10.4g}{:>10.4g}{:>10.4g}{}{}\n", label, d.min,
                 d.p01, d.median, d.p99, d.max, unit.empty() ? "" : "  ", unit);
}

// Relative differences: the figures themselves are those of the table above.
std::string cgal_text(const MeshReport& mesh) {
  const CgalMeasures& cgal = *mesh.cgal;
  std::string text = fmt::format("CGAL's measures differ by {:.1e} (area)",
                                 std::abs(cgal.area / mesh.measures.area - 1));
  if (cgal.volume && mesh.measures.volume) {
    text += fmt::format(", {:.1e} (volume)", std::abs(*cgal.volume / *mesh.measures.volume - 1));
  }
  return text;
}

// How each subdivision changed the mesh, the extracted one first.
void levels_text(Text out, const std::vector<LevelReport>& levels) {
  fmt::format_to(out, "\n{:<22}{:>14}{:>12}{:>12}{:>12}{:>12}\n", "Level", "triangles", "angle 1 %",
                 "median", "edge", "crossings");
  for (const LevelReport& level : levels) {
    const std::string crossings =
        level.self_intersections ? std::to_string(*level.self_intersections) : "-";
    fmt::format_to(out, "{:<22}{:>14}{:>12.4g}{:>12.4g}{:>12.4g}{:>12}\n", level.level,
                   level.topology.triangles, level.quality.min_angle_deg.p01,
                   level.quality.min_angle_deg.median, level.quality.edge_length.median, crossings);
  }
}

std::string remeshing_text(const RemeshStats& stats) {
  return fmt::format(
             "from {} triangles along the curves; {} joined of {} corners and crease vertices; {} "
             "angles below 20°, {} of them at creases and corners",
             stats.exact_triangles, stats.joined, stats.corners + stats.crease_edges,
             stats.below_20_degrees, stats.below_20_at_features) +
         (stats.farthest > 0
              ? fmt::format("; edges of {:.3g} Å, proven within {:.4g} Å of the surface, both ways",
                            stats.edge_length, stats.farthest)
              : "");
}

std::string patches_text(const PatchReport& patches) {
  const auto text = [](const PatchCount& count, const char* kind) {
    return fmt::format("{} {} ({} triangles, {:.3f} Å²)", count.patches, kind, count.triangles,
                       count.area);
  };
  return text(patches.contact, "contact") + ", " + text(patches.saddle, "saddle") + ", " +
         text(patches.concave, "concave");
}

std::string in_scientific(const std::optional<double>& error) {
  return error ? fmt::format(" ({:+.1e} of the exact one)", *error) : "";
}

void distance_row(Text out, std::string_view label, const DistanceStatistics& d) {
  fmt::format_to(out, "{:<22}{:>14.5f}{:>10.5f}{:>10.5f}{:>10.5f}{:>10.5f}  Å\n", label, d.mean,
                 d.rms, d.p95, d.p99, d.max);
  fmt::format_to(out, "{:<22}{:>14.5f}{:>10.5f}{:>33}\n", "  standard error", d.mean_error,
                 d.rms_error, "Å");
}

void distance_table(Text out, const MeshDistances& distances, std::string_view title,
                    std::string_view remark) {
  fmt::format_to(out, "\n{:<22}{:>14}{:>10}{:>10}{:>10}{:>10}\n", title, "mean", "rms", "95 %",
                 "99 %", "max");
  distance_row(out, "mesh to surface", distances.mesh_to_surface);
  distance_row(out, "surface to mesh", distances.surface_to_mesh);
  fmt::format_to(out, "Hausdorff distance: at least {:.5f} Å ({} samples, seed {}){}\n",
                 distances.hausdorff_lower_bound, distances.samples, distances.seed, remark);
}

std::string known(const std::string& text) { return text.empty() ? "not known" : text; }

std::string topology_text(const ComparisonReport& comparison) {
  const char* surface = comparison.surface == ExactSurface::excluded ? "excluded surface" : "union";
  const std::optional<bool> is_exact = comparison.proof->topology_is_exact;
  if (!is_exact) return fmt::format("topology of the {} not computed", surface);
  if (!*is_exact) return fmt::format("topology is NOT that of the {}", surface);
  return fmt::format("Euler characteristic, components and voids are those of the {}", surface);
}

}  // namespace

std::string mesh_line(const MeshReport& mesh) {
  const MeshTopology& topology = mesh.topology;
  return fmt::format(
      "{} vertices, {} triangles; {}, {}, {}{}{}", topology.vertices, topology.triangles,
      affirmed(topology.closed, "closed"), affirmed(topology.manifold, "2-manifold"),
      affirmed(topology.oriented, "oriented"),
      mesh.self_intersections ? fmt::format("; {} self-intersections", *mesh.self_intersections)
                              : "",
      mesh.path ? "; " + *mesh.path : "");
}

// A reader who trusts nothing finds here all that speaks for the mesh, or against it.
void proof_text(Text out, const ComparisonReport& comparison, const MeshReport& mesh) {
  fmt::format_to(out, "\n");
  const MeshProof& proof = *comparison.proof;
  line(out, "Proof", topology_text(comparison));
  if (proof.atoms) {
    line(out, "",
         fmt::format("area of an atom: {:.3g} % off at most ({}), rms {:.3g} %; {} atoms with 1 Å² "
                     "exposed",
                     100 * proof.atoms->max, proof.atoms->worst, 100 * proof.atoms->rms,
                     proof.atoms->atoms));
  }
  if (proof.below_floor) {
    line(out, "",
         fmt::format("{}, before subdivision",
                     *proof.below_floor == 1
                         ? "1 angle below its floor"
                         : fmt::format("{} angles below their floors", *proof.below_floor)));
  }
  if (mesh.extrapolated_area) {
    line(out, "",
         fmt::format("extrapolated area {} Å²{}", figure_text(*mesh.extrapolated_area),
                     in_scientific(proof.extrapolated_area_error)));
  }
  if (mesh.extrapolated_volume) {
    line(out, "",
         fmt::format("extrapolated volume {} Å³{}", figure_text(*mesh.extrapolated_volume),
                     in_scientific(proof.extrapolated_volume_error)));
  }
}

// What the mesh is, how it was made, and how good its triangles are.
void mesh_text(Text out, const MeshReport& mesh) {
  fmt::format_to(out, "\n");
  std::string counts = fmt::format("{} degenerate triangles", mesh.quality.degenerate_triangles);
  if (mesh.clamped_vertices) {
    counts += fmt::format(", {} clamped vertices", *mesh.clamped_vertices);
  }
  if (mesh.arrangement) {
    counts += fmt::format(", {} arcs in {} pieces, {} corners", mesh.arrangement->arcs,
                          mesh.arrangement->pieces, mesh.arrangement->corners);
  }
  if (mesh.grid_clipped) counts += fmt::format(", {} cells cut by the grid", *mesh.grid_clipped);
  line(out, "Counts", counts);
  if (mesh.patches) line(out, "Patches", patches_text(*mesh.patches));
  if (mesh.remeshing) line(out, "Remeshing", remeshing_text(*mesh.remeshing));
  if (!mesh.projection.empty()) {
    const NewtonSummary newton = summarize(mesh.projection);
    line(out, "Projection",
         fmt::format("{} vertices moved, at most {} steps, residual {:.1e} Å; {} unconverged, {} "
                     "out of reach, {} undone; {} triangles turned",
                     newton.projected, newton.iterations_max, newton.residual_max,
                     newton.unconverged, newton.out_of_reach, newton.undone, newton.turned));
  }
  if (mesh.cgal) line(out, "", cgal_text(mesh));
  if (!mesh.levels.empty()) levels_text(out, mesh.levels);
  fmt::format_to(out, "\n{:<22}{:>14}{:>10}{:>10}{:>10}{:>10}\n", "", "min", "1 %", "median",
                 "99 %", "max");
  distribution_row(out, "Smallest angle", mesh.quality.min_angle_deg, "degrees");
  distribution_row(out, "Aspect ratio", mesh.quality.aspect_ratio, "");
  distribution_row(out, "Edge length", mesh.quality.edge_length, "Å");
}

// Both directions: a mesh may lie close to the surface and still lack a part of it.
void distances_text(Text out, const ComparisonReport& comparison) {
  distance_table(out, *comparison.distances, "Distance",
                 comparison.distances_backend == Backend::cuda ? ", measured on cuda" : "");
  if (!comparison.bounds) return;
  fmt::format_to(
      out,
      "Bounds       no point of the mesh is farther than {:.5f} Å from the surface, none "
      "of the surface farther than {:.5f} Å from the mesh\n",
      comparison.bounds->mesh_to_surface.upper, comparison.bounds->surface_to_mesh.upper);
}

void exterior_text(Text out, const Comparison& comparison) {
  fmt::format_to(out, "\nMesh - exterior surface: area {}, volume {}, Euler characteristic {}\n",
                 known(percent(comparison.area_relative_error)),
                 known(percent(comparison.volume_relative_error)),
                 known(equal_or(comparison.euler_characteristic_difference)));
  if (comparison.distances) distance_table(out, *comparison.distances, "Distance, exterior", "");
}

}  // namespace vdwmesh::apps
