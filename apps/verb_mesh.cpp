// `vdwmesh mesh`: from a structure to a mesh file. Memory is checked before the mesh is made, from
// an estimate, and again when its size is known. Where a device makes the mesh, the CPU makes room
// for the half-edges meanwhile.
#include "command_line/command_line.hpp"
#include "edge_lengths.hpp"
#include "excluded_steps.hpp"
#include "interrupt.hpp"
#include "memory_plan.hpp"
#include "mesh/mesh_io.hpp"
#include "mesh/patch_properties.hpp"
#include "output.hpp"
#include "steps.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

// A device makes marching cubes while the CPU has nothing to do but to make room.
MemoryDemand memory_of_mesh(const Options& options) {
  MemoryDemand demand;
  demand.surface = options.surface;
  demand.backend = resolve(options.machine.backend);
  demand.connectivity = Connectivity::half_edges;
  demand.build = Switch::on;
  const bool by_device =
      demand.backend == Backend::cuda && options.surface.mesher == Mesher::marching_cubes;
  demand.early = by_device ? Switch::on : Switch::off;
  return demand;
}

// The mesh in half-edges, with what there is to say about it in the report.
void build(const Structure& structure, const Options& options, SurfaceMesh& built,
           Session& session) {
  const std::uint64_t limit = options.machine.memory_limit;
  MemoryDemand demand = memory_of_mesh(options);
  const auto estimate = check_memory_before(demand, structure.spheres, limit);
  session.end_stage(&Timing::plan);
  SurfaceMeshBuilder builder(built);
  const auto prepare = [&](const MeshSize& size) {
    if (early_build_fits(demand, size, limit)) {
      builder.prepare(size);
    } else {
      demand.early = Switch::off;
    }
  };
  const IndexedMesh mesh =
      make_mesh(structure.spheres, options.surface, session,
                {.connectivity = Connectivity::half_edges, .on_size = prepare});
  session.report.parameters->memory_estimate = estimate;
  check_memory_after(demand, structure.spheres, mesh, limit);
  measure(mesh, SelfIntersections::skip, session);
  warn_of_lost_balls(structure.spheres, session);
  build_surface_mesh(mesh, structure.molecule, builder, session);
}

// The same for the excluded surface, beside its exact measures.
void build_excluded(const Structure& structure, const Options& options, SurfaceMesh& built,
                    Session& session) {
  const double probe = options.inputs.front().probe;
  measure_excluded(structure.molecule, probe, options.exact, Switch::off, session);
  const PatchedMesh made = make_excluded_mesh(structure.molecule, probe, options.surface, session);
  const IndexedMesh& mesh = made.mesh;
  MemoryDemand demand = memory_of_mesh(options);
  check_memory_after(demand, structure.spheres, mesh, options.machine.memory_limit);
  measure(mesh, SelfIntersections::skip, session);
  session.report.mesh->patches = count_patches(made);
  SurfaceMeshBuilder builder(built);
  build_surface_mesh(mesh, structure.molecule, builder, session);
  add_patch_properties(built, made);
}

// Formats that cannot hold all that the mesh knows are named in a note.
void write(const SurfaceMesh& mesh, const std::string& path, Session& session) {
  begin_stage(session.monitor, "write", 1);
  const SignalMonitor signals;
  Report& report = session.report;
  write_whole(path, [&] {
    for (const std::string& warning : write_mesh(mesh, path, &signals)) {
      report.warnings.push_back(warning);
    }
  });
  if (patch_properties(mesh) && mesh_format(path) != MeshFormat::ply) {
    report.notes.push_back(
        path +
        ": does not say which patch each triangle is part of, nor curvatures; only PLY does");
  }
  if (face_spheres(mesh) && mesh_format(path) != MeshFormat::ply) {
    report.notes.push_back(path +
                           ": does not say which sphere each triangle is part of; only PLY does");
  }
  report.mesh->path = path;
  session.end_stage(&Timing::write);
}

}  // namespace

void run_mesh(const Options& options) {
  VerbSession session(options.machine);
  const Structure structure = load(options.inputs.front(), session);
  SurfaceMesh built;
  if (options.surface.kind == ExactSurface::excluded) {
    build_excluded(structure, options, built, session);
  } else {
    build(structure, with_edge_lengths(options, structure), built, session);
  }
  write(built, options.mesh_path, session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
