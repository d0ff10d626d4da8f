#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "compare_hints.hpp"
#include "machine.hpp"
#include "memory_plan.hpp"
#include "mesh/mesh_io.hpp"
#include "output.hpp"
#include "per_atom.hpp"
#include "picture.hpp"
#include "stopwatch.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

class CompareVerb : public Verb {
 public:
  std::string name() const override { return "compare"; }
  std::string summary() const override {
    return "a triangle mesh, from any program, against the exact sphere union";
  }

  void add_options(CLI::App& app) override {
    app.add_option("MESH", mesh_path_, ".ply .obj .off .stl or .glb");
    input_.add_to(app);
    exact_.add_to(app);
    distances_.add_to(app);
    machine_.add_to(app, MachineFlags::Backends::none);
    picture_.add_picture_to(app);
    output_.add_to(app, OutputFlags::PerAtom::none);
  }

  void run() const override {
    const Stopwatch watch;
    if (mesh_path_.empty()) {
      throw InvalidInput("no MESH: name a mesh file (.ply .obj .off .stl .glb), then INPUT");
    }
    mesh_format(mesh_path_);
    NamedFiles files;
    files.add_input("MESH", mesh_path_);
    const InputOptions input = input_.resolve(files);
    const ExactOptions exact = exact_.resolve();
    const DistanceChoice distance_choice = distances_.resolve();
    const MachineOptions machine_options = machine_.resolve();
    const OutputOptions output = output_.resolve(files);
    const PictureOptions picture = picture_.resolve(files);

    Machine machine(machine_options);
    Report report;
    const Molecule molecule = load(input, machine_options.memory_limit, report);
    const SphereSet spheres = to_spheres(molecule, input.probe);
    check_file_size(machine_options.memory_limit);
    MeshFile file = read_mesh(mesh_path_);
    const IndexedMesh& mesh = file.mesh;
    MemoryDemand demand;
    demand.self_intersections = SelfIntersections::small_meshes;
    demand.exact = exact.method;
    demand.distances = distance_choice.distances;
    check_memory_after(demand, spheres, mesh, machine_options.memory_limit);
    measure_file(file, machine_options.memory_limit, machine.monitor(), report);
    warn_of_place(mesh, spheres, report);
    measure_exactly(spheres, exact, machine.monitor(), report);
    compare_with_exact(mesh, spheres, distance_choice, machine_options.memory_limit,
                       machine.monitor(), report);
    if (!picture.path.empty()) {
      write_picture(mesh, paint_by_distance(mesh, spheres, picture, machine.monitor()), picture,
                    machine_options, machine.monitor(), report);
    }
    machine.end_progress();
    add_warnings(report);
    report.timing.total = watch.seconds();
    deliver(report, output, machine_options.verbosity);
  }

 private:
  // A mesh takes about the bytes of its file, and while it is read both are there.
  void check_file_size(std::uint64_t limit) const {
    std::error_code ignored;
    const std::uintmax_t bytes = std::filesystem::file_size(mesh_path_, ignored);
    if (ignored || bytes <= limit / 2) return;
    throw LimitExceeded(
        fmt::format("{}: reading its {} bytes needs twice as many, {} are allowed: allow more with "
                    "--memory-limit, or write a mesh of fewer triangles",
                    mesh_path_, bytes, limit));
  }

  void measure_file(MeshFile& file, std::uint64_t memory_limit, Monitor* monitor,
                    Report& report) const {
    if (file.mesh.triangle_count() == 0) {
      throw FileFormatError(mesh_path_ + ": holds no triangles; a triangle mesh is needed");
    }
    const std::size_t notes = report.notes.size();
    measure(file.mesh, SelfIntersections::small_meshes, monitor, report);
    if (!report.mesh->topology.closed && weld_if_that_closes(file, memory_limit, report)) {
      report.notes.resize(notes);
      measure(file.mesh, SelfIntersections::small_meshes, monitor, report);
    }
    if (!(report.mesh->measures.area > 0)) {
      throw FileFormatError(mesh_path_ +
                            ": none of its triangles has an area; it holds no surface");
    }
    report.mesh->path = mesh_path_;
    report.mesh->notes = file.notes;
  }

  std::string mesh_path_;
  InputFlags input_;
  ExactFlags exact_;
  DistanceFlags distances_;
  MachineFlags machine_;
  PictureFlags picture_;
  OutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_compare_verb() { return std::make_unique<CompareVerb>(); }

}  // namespace vdwmesh::apps
