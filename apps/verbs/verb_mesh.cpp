// `vdwmesh mesh`: from a structure to a mesh file. Memory is checked before the mesh is made, from
// an estimate, and again when its size is known. The mesh is measured while its file is written.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "command_line/command_line.hpp"
#include "command_line/other_words.hpp"
#include "interrupt.hpp"
#include "memory_plan.hpp"
#include "mesh/connect/edge_buckets.hpp"
#include "mesh/mesh_io.hpp"
#include "report/output.hpp"
#include "steps/beside.hpp"
#include "steps/edge_lengths.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/steps.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

// OFF alone says how many edges a mesh has, which its half-edges tell.
MemoryDemand memory_of_mesh(const Options& options) {
  const bool is_off = mesh_format(options.mesh_path) == MeshFormat::off;
  MemoryDemand demand;
  demand.surface = options.surface;
  demand.backend = resolve(options.machine.backend);
  demand.normals = Normals::gradients;
  demand.connectivity = is_off ? Connectivity::half_edges : Connectivity::triangles;
  if (!is_off) demand.half_edges_up_to = 0;
  return demand;
}

// Checks what the stages behind the mesh take, and reports the larger estimate.
void check_finished(MemoryDemand& demand, std::uint64_t estimate, const Structure& structure,
                    const IndexedMesh& mesh, const Options& options, Session& session) {
  session.report.parameters->memory_estimate = estimate;
  check_memory_after(demand, structure.spheres, mesh, options.machine.memory_limit);
  session.report.parameters->memory_estimate = std::max(estimate, estimate_memory(demand).bytes);
}

// The mesh, with what there is to say about it in the report. It knows no patches.
PatchedMesh make(const Structure& structure, const Options& options, Session& session) {
  MemoryDemand demand = memory_of_mesh(options);
  const std::uint64_t estimate =
      check_memory_before(demand, structure.spheres, options.machine.memory_limit);
  session.end_stage(&Timing::plan);
  PatchedMesh made;
  made.mesh =
      make_mesh(structure.spheres, options.surface, session,
                {.connectivity = demand.connectivity, .half_edges_up_to = demand.half_edges_up_to});
  check_finished(demand, estimate, structure, made.mesh, options, session);
  return made;
}

// The same for the excluded surface.
PatchedMesh make_excluded(const Structure& structure, const Options& options, Session& session) {
  const double probe = options.inputs.front().probe;
  MemoryDemand demand = memory_of_mesh(options);
  const std::uint64_t estimate =
      plan_excluded_mesh(structure, probe, options.exact, Switch::off, demand, session);
  PatchedMesh made = make_excluded_mesh(structure.molecule, probe, options.surface, session);
  check_finished(demand, estimate, structure, made.mesh, options, session);
  return made;
}

// The commands by which Gmsh fills the surface with tetrahedra: its format has no word for that.
std::string filled_by_gmsh(std::filesystem::path path) {
  const std::string merge = fmt::format(
      "Merge \"{}\"; Surface Loop(1) = Surface{{:}}; Volume(1) = {{1}}; Physical Volume(1) = "
      "{{1}};",
      path.filename().string());
  const std::string script = in_shell(path.replace_extension(".geo").string()),
                    volume = in_shell(path.replace_extension(".volume.msh").string());
  return fmt::format("Gmsh fills it with tetrahedra: echo {} > {}; gmsh {} -3 -o {}",
                     in_shell(merge), script, script, volume);
}

// Writes the file and measures the mesh meanwhile. A note says what the format cannot hold.
void write(const PatchedMesh& made, const Options& options, const Structure& structure,
           Session& session) {
  const bool has_patches = options.surface.kind == ExactSurface::excluded;
  const std::string& path = options.mesh_path;
  begin_stage(session.monitor, "write", 1);
  Report& report = session.report;
  if (!report.mesh) report.mesh.emplace();
  MeshReport& result = *report.mesh;
  if (has_patches) result.patches = count_patches(made);
  std::vector<std::string> warnings;
  const auto write_file = [&] {
    const SignalMonitor signals;
    const std::vector<RgbColor> colors = element_colors(structure.molecule);
    write_whole(path, [&] {
      const MeshEncoding encoding =
          options.ascii == Switch::on ? MeshEncoding::text : MeshEncoding::binary;
      const double scale = options.mesh_scale;
      warnings = has_patches ? write_mesh(made, path, colors, &signals, encoding, scale)
                             : write_mesh(made.mesh, path, colors, &signals, encoding, scale);
    });
  };
  run_beside(
      session, {{&Timing::write, write_file}},
      {&Timing::measure, [&] { static_cast<MeshExamination&>(result) = examine(made.mesh); }});
  if (!has_patches) warn_of_lost_balls(structure.spheres, session);
  report.warnings.insert(report.warnings.end(), warnings.begin(), warnings.end());
  const MeshFormat format = mesh_format(path);
  const bool is_ply = format == MeshFormat::ply,
             is_msh = format == MeshFormat::msh || format == MeshFormat::msh4;
  if (has_patches && !is_ply) {
    report.notes.push_back(
        path + (is_msh ? ": does not have curvatures; only PLY does"
                       : ": does not say which patch each triangle is part of, nor curvatures; PLY "
                         "does, and MSH has the patches"));
  }
  const bool has_spheres =
      is_ply || is_msh || format == MeshFormat::vtp || format == MeshFormat::vtu;
  if (!made.mesh.triangle_spheres.empty() && !has_spheres) {
    report.notes.push_back(
        path + ": does not say which sphere each triangle is part of; PLY, MSH, VTP and VTU do");
  }
  if (options.mesh_scale != 1)
    report.notes.push_back(
        fmt::format("{}: 1 Å is {}; the figures here are in Å", path, options.mesh_scale));
  if (is_msh && result.topology.closed) report.notes.push_back(filled_by_gmsh(path));
  result.path = path;
  session.end_stage(&Timing::write);
}

}  // namespace

void run_mesh(const Options& options) {
  VerbSession session(options.machine);
  const std::future<void> started = start_device(options.machine, options.surface);
  const Structure structure = load(options.inputs.front(), session);
  const PatchedMesh made = options.surface.kind == ExactSurface::excluded
                               ? make_excluded(structure, options, session)
                               : make(structure, with_edge_lengths(options, structure), session);
  // What measuring would refuse is refused before the file is written.
  check_triangle_count(made.mesh.triangle_count());
  write(made, options, structure, session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
