// `vdwmesh mesh`: from a structure to a mesh file. Memory is checked before the mesh is made, from
// an estimate, and again when its size is known. The mesh is measured while its file is written,
// unless the half-edges leave too little memory for both.
//
// PLY, the default, is written from the arrays of the mesh. The writers of the other formats and of
// patches want half-edges, which are built first; where a device makes the mesh, the CPU makes room
// for them meanwhile.
#include <algorithm>
#include <future>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "beside.hpp"
#include "command_line/command_line.hpp"
#include "edge_lengths.hpp"
#include "exact_steps.hpp"
#include "excluded_steps.hpp"
#include "interrupt.hpp"
#include "memory_plan.hpp"
#include "mesh/half_edge_limit.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh/patch_properties.hpp"
#include "output.hpp"
#include "steps.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

// Whether the file is written from half-edges.
bool wants_half_edges(const Options& options) {
  return options.surface.kind == ExactSurface::excluded ||
         mesh_format(options.mesh_path) != MeshFormat::ply;
}

// A device makes marching cubes while the CPU has nothing to do but to make room.
MemoryDemand memory_of_mesh(const Options& options) {
  MemoryDemand demand;
  demand.surface = options.surface;
  demand.backend = resolve(options.machine.backend);
  if (!wants_half_edges(options)) {
    demand.normals = Normals::gradients;
    demand.half_edges_up_to = 0;
    return demand;
  }
  demand.connectivity = Connectivity::half_edges;
  demand.build = Switch::on;
  const bool by_device =
      demand.backend == Backend::cuda && options.surface.mesher == Mesher::marching_cubes;
  demand.early = by_device ? Switch::on : Switch::off;
  return demand;
}

// The mesh as it was made, and in half-edges if it will be written so. If it is not measured yet,
// it may also not be built yet.
struct MadeMesh {
  IndexedMesh mesh;
  SurfaceMesh built;
  SurfaceMeshBuilder builder{built};
  bool is_measured = false, is_built = false;
};

// Leaves the measuring to the time when the half-edges are built and the file is written if memory
// holds all of that; else measures now.
void measure_now_or_later(const IndexedMesh& mesh, const MemoryDemand& demand, MadeMesh& made,
                          Session& session) {
  MemoryDemand later = demand;
  later.early = Switch::on;  // the half-edges are built while the mesh is measured
  if (!session.report.mesh) session.report.mesh.emplace();
  later.mesh = {mesh.vertex_count(), mesh.triangle_count()};
  if (early_build_fits(later, later.mesh, session.machine.memory_limit)) {
    std::optional<std::uint64_t>& estimate = session.report.parameters->memory_estimate;
    estimate = std::max(estimate.value_or(0), estimate_memory(later).bytes);
    return;
  }
  measure(mesh, SelfIntersections::skip, session);
  made.is_measured = true;
}

// The mesh, with what there is to say about it in the report. Where it is measured already and will
// be written from half-edges, these are built, too, and the mesh is given up.
void make(const Structure& structure, const Options& options, MadeMesh& made, Session& session) {
  const std::uint64_t limit = options.machine.memory_limit;
  MemoryDemand demand = memory_of_mesh(options);
  const auto estimate = check_memory_before(demand, structure.spheres, limit);
  session.end_stage(&Timing::plan);
  const bool builds = wants_half_edges(options);
  const auto prepare = [&](const MeshSize& size) {
    if (!builds) return;
    if (early_build_fits(demand, size, limit)) {
      made.builder.prepare(size);
    } else {
      demand.early = Switch::off;
    }
  };
  made.mesh = make_mesh(structure.spheres, options.surface, session,
                        {.connectivity = demand.connectivity,
                         .half_edges_up_to = demand.half_edges_up_to,
                         .on_size = prepare});
  session.report.parameters->memory_estimate = estimate;
  check_memory_after(demand, structure.spheres, made.mesh, limit);
  // What measuring would refuse is refused before the file is written.
  check_triangle_count(made.mesh.triangle_count());
  measure_now_or_later(made.mesh, demand, made, session);
  if (!made.is_measured || !builds) return;
  build_surface_mesh(made.mesh, structure.molecule, made.builder, session);
  made.is_built = true;
  made.mesh = {};
}

// The same for the excluded surface, beside its exact measures; it is built in any case.
void make_excluded(const Structure& structure, const Options& options, MadeMesh& made,
                   Session& session) {
  const double probe = options.inputs.front().probe;
  MemoryDemand demand = memory_of_mesh(options);
  const std::uint64_t estimate =
      plan_excluded_mesh(structure, probe, options.exact, Switch::off, demand, session);
  PatchedMesh patched = make_excluded_mesh(structure.molecule, probe, options.surface, session);
  session.report.parameters->memory_estimate = estimate;
  check_memory_after(demand, structure.spheres, patched.mesh, options.machine.memory_limit);
  measure_now_or_later(patched.mesh, demand, made, session);
  session.report.mesh->patches = count_patches(patched);
  build_surface_mesh(patched.mesh, structure.molecule, made.builder, session);
  made.is_built = true;
  add_patch_properties(made.built, patched);
  if (!made.is_measured) made.mesh = std::move(patched.mesh);
}

// Writes the file, from half-edges where it wants these, and measures the mesh meanwhile, as far as
// that was left to this function. Formats that cannot hold all that the mesh knows are named in a
// note.
void write(MadeMesh& made, const Options& options, const Structure& structure, Session& session) {
  const std::string& path = options.mesh_path;
  begin_stage(session.monitor, "write", 1);
  Report& report = session.report;
  std::vector<std::string> warnings;
  const bool builds = wants_half_edges(options);
  const auto write_file = [&] {
    const SignalMonitor signals;
    write_whole(path, [&] {
      if (builds) {
        warnings = write_mesh(made.built, path, &signals);
      } else {
        write_ply(made.mesh, element_colors(structure.molecule), path, &signals);
      }
    });
  };
  MeshReport& result = *report.mesh;
  if (made.is_measured) {
    write_file();
  } else {
    std::vector<StageWork> here;
    if (builds && !made.is_built) {
      here.push_back(
          {&Timing::build, [&] { build_colored(made.mesh, structure.molecule, made.builder); }});
    }
    here.push_back({&Timing::write, write_file});
    run_beside(session, here, {&Timing::measure, [&] {
                                 static_cast<MeshExamination&>(result) = examine(made.mesh);
                               }});
  }
  if (options.surface.kind != ExactSurface::excluded) {
    warn_of_lost_balls(structure.spheres, session);
  }
  report.warnings.insert(report.warnings.end(), warnings.begin(), warnings.end());
  if (patch_properties(made.built) && mesh_format(path) != MeshFormat::ply) {
    report.notes.push_back(
        path +
        ": does not say which patch each triangle is part of, nor curvatures; only PLY does");
  }
  if (face_spheres(made.built) && mesh_format(path) != MeshFormat::ply) {
    report.notes.push_back(path +
                           ": does not say which sphere each triangle is part of; only PLY does");
  }
  result.path = path;
  session.end_stage(&Timing::write);
}

}  // namespace

void run_mesh(const Options& options) {
  VerbSession session(options.machine);
  const std::future<void> started = start_device(options.machine, options.surface);
  const Structure structure = load(options.inputs.front(), session);
  MadeMesh made;
  if (options.surface.kind == ExactSurface::excluded) {
    make_excluded(structure, options, made, session);
  } else {
    make(structure, with_edge_lengths(options, structure), made, session);
  }
  write(made, options, structure, session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
