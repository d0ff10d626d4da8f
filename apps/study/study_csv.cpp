// One row per run. The cells are those that the descriptions of a run's parts give, so that a
// column has the name of the member that it shows; the header says which of them are shown, and in
// which order. A figure that was not computed leaves its cell empty.
#include "report/csv.hpp"
#include "study/describe_study.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {
namespace {

constexpr std::string_view kColumns =
    "input,atoms,mesher,field,project,subdivide,resolution,backend,vertices,triangles,"
    "euler_characteristic,shells,components,voids,genus,closed,manifold,oriented,area,exact_area,"
    "area_relative_error,volume,exact_volume,volume_relative_error,"
    "euler_characteristic_difference,self_intersections,"
    "min_angle_deg_min,min_angle_deg_p01,min_angle_deg_median,min_angle_deg_p99,"
    "min_angle_deg_max,aspect_ratio_min,aspect_ratio_p01,aspect_ratio_median,aspect_ratio_p99,"
    "aspect_ratio_max,edge_length_min,edge_length_p01,edge_length_median,edge_length_p99,"
    "edge_length_max,mesh_to_surface_mean,mesh_to_surface_rms,mesh_to_surface_max,"
    "surface_to_mesh_mean,surface_to_mesh_rms,surface_to_mesh_max,hausdorff_lower_bound,"
    "seconds_field,seconds_extract,seconds_refine,seconds_mesh,seconds_distances,mesh_bytes,"
    "peak_bytes";

// Parts whose members are columns by their own names are described without a name.
Cells cells_of(const StudyInput& input, const StudyRun& run) {
  Cells cells(csv_number);
  cells("input", input.name), cells("atoms", input.report.atoms_used);
  cells("exact_area", input.exact.area), cells("exact_volume", input.exact.volume);
  describe(cells, run.setting);
  describe(cells, MeshBlock{run});
  describe(cells, ComparisonBlock{run});
  if (run.comparison.distances) describe(cells, *run.comparison.distances);
  cells("seconds", run.seconds);
  cells("mesh_bytes", run.memory.mesh), cells("peak_bytes", run.memory.peak);
  return cells;
}

}  // namespace

std::string study_csv(const Study& study) {
  std::vector<Cells> rows;
  for (const StudyFindings& f : study.findings) {
    for (const StudyRun& run : f.runs) rows.push_back(cells_of(f.input, run));
  }
  return csv_table(kColumns, rows);
}

}  // namespace vdwmesh::apps
