#include <CLI/CLI.hpp>

#include "interrupt.hpp"
#include "machine.hpp"
#include "memory_plan.hpp"
#include "mesh/mesh_io.hpp"
#include "output.hpp"
#include "stopwatch.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

class MeshVerb : public Verb {
 public:
  std::string name() const override { return "mesh"; }
  std::string summary() const override { return "structure -> welded mesh file"; }

  void add_options(CLI::App& app) override {
    app.add_option("-o,--output", mesh_path_, "mesh file: .ply .obj .off .stl or .glb");
    input_.add_to(app);
    surface_.add_to(app, 0);
    machine_.add_to(app, MachineFlags::Backends::choose);
    output_.add_to(app, OutputFlags::PerAtom::none);
  }

  void run() const override {
    const Stopwatch watch;
    NamedFiles files;
    name_output(files);
    const SurfaceOptions surface = surface_.resolve();
    const InputOptions input = input_.resolve(files, surface.field.preset);
    const MachineOptions machine_options = machine_.resolve();
    const OutputOptions output = output_.resolve(files);

    Machine machine(machine_options);
    Report report;
    const Molecule molecule = load(input, machine_options.memory_limit, report);
    const SphereSet spheres = to_spheres(molecule, input.probe);
    MemoryDemand demand;
    demand.surface = surface;
    demand.backend = resolve(machine_options.backend);
    demand.connectivity = Connectivity::half_edges;
    demand.build = Switch::on;
    // A device makes marching cubes while the CPU has nothing to do.
    const bool by_device =
        demand.backend == Backend::cuda && surface.mesher == Mesher::marching_cubes;
    demand.early = by_device ? Switch::on : Switch::off;
    const auto estimate = check_memory_before(demand, spheres, machine_options.memory_limit);
    SurfaceMesh built;
    SurfaceMeshBuilder builder(built);
    const auto prepare = [&](const MeshSize& size) {
      if (early_build_fits(demand, size, machine_options.memory_limit)) {
        builder.prepare(size);
      } else {
        demand.early = Switch::off;
      }
    };
    IndexedMesh mesh = make_mesh(spheres, surface, {Connectivity::half_edges}, machine_options,
                                 machine.monitor(), report, {.on_level = {}, .on_size = prepare});
    report.parameters->memory_estimate = estimate;
    check_memory_after(demand, spheres, mesh, machine_options.memory_limit);
    measure(mesh, SelfIntersections::skip, machine.monitor(), report);
    warn_of_lost_balls(spheres, report);
    build_surface_mesh(mesh, molecule, builder, report);
    mesh = {};
    write(built, machine.monitor(), report);
    machine.end_progress();
    add_warnings(report);
    report.timing.total = watch.seconds();
    deliver(report, output, machine_options.verbosity);
  }

 private:
  void name_output(NamedFiles& files) const {
    if (mesh_path_.empty()) {
      throw InvalidInput("-o: name the mesh file to write (.ply .obj .off .stl .glb)");
    }
    mesh_format(mesh_path_);
    files.add_output("-o", mesh_path_);
  }

  void write(const SurfaceMesh& mesh, Monitor* monitor, Report& report) const {
    begin_stage(monitor, "write", 1);
    const SignalMonitor signals;
    write_whole(mesh_path_, [&] {
      for (const std::string& warning : write_mesh(mesh, mesh_path_, &signals)) {
        report.warnings.push_back(warning);
      }
    });
    if (face_spheres(mesh) && mesh_format(mesh_path_) != MeshFormat::ply) {
      report.notes.push_back(mesh_path_ +
                             ": does not say which sphere each triangle is part of; only PLY does");
    }
    report.mesh->path = mesh_path_;
  }

  std::string mesh_path_;
  InputFlags input_;
  SurfaceFlags surface_;
  MachineFlags machine_;
  OutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_mesh_verb() { return std::make_unique<MeshVerb>(); }

}  // namespace vdwmesh::apps
