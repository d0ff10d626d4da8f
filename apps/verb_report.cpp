#include <CLI/CLI.hpp>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "machine.hpp"
#include "memory_plan.hpp"
#include "output.hpp"
#include "parse.hpp"
#include "per_atom.hpp"
#include "picture.hpp"
#include "stopwatch.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

constexpr Choice<SelfIntersections> kSelfIntersections[] = {
    {"auto", SelfIntersections::small_meshes},
    {"on", SelfIntersections::count},
    {"off", SelfIntersections::skip}};

constexpr Choice<CgalCheck> kCgalChecks[] = {
    {"auto", CgalCheck::small_meshes}, {"on", CgalCheck::run}, {"off", CgalCheck::skip}};

class ReportVerb : public Verb {
 public:
  std::string name() const override { return "report"; }
  std::string summary() const override { return "mesh + exact geometry + comparison"; }

  void add_options(CLI::App& app) override {
    input_.add_to(app);
    surface_.add_to(app, 1);
    exact_.add_to(app);
    distances_.add_to(app);
    app.add_option("--self-intersections", self_intersections_,
                   "on, off, or auto: meshes of up to a million triangles [auto]");
    app.add_option("--cgal-check", cgal_check_,
                   "area and volume of the mesh by CGAL as well: on, off, or auto: meshes of up to "
                   "a million triangles [auto]");
    machine_.add_to(app, MachineFlags::Backends::choose);
    picture_.add_picture_to(app);
    output_.add_to(app, OutputFlags::PerAtom::offered);
  }

  void run() const override {
    const Stopwatch watch;
    NamedFiles files;
    const SurfaceOptions surface = surface_.resolve();
    const InputOptions input = input_.resolve(files, surface.field.preset);
    const ExactOptions exact = exact_.resolve();
    const DistanceChoice distance_choice = distances_.resolve();
    const MachineOptions machine_options = machine_.resolve();
    const OutputOptions output = output_.resolve(files);
    const PictureOptions picture = picture_.resolve(files);
    const SelfIntersections count =
        choose("--self-intersections", self_intersections_, kSelfIntersections);
    const CgalCheck cgal_check = choose("--cgal-check", cgal_check_, kCgalChecks);

    Machine machine(machine_options);
    Report report;
    const Molecule molecule = load(input, machine_options.memory_limit, report);
    const SphereSet spheres = to_spheres(molecule, input.probe);
    MemoryDemand demand;
    demand.surface = surface;
    demand.backend = resolve(machine_options.backend);
    demand.normals = picture.path.empty() ? Normals::none : Normals::gradients;
    demand.self_intersections = count;
    demand.cgal_check = cgal_check;
    demand.exact = exact.method;
    demand.distances = distance_choice.distances;
    const auto estimate = check_memory_before(demand, spheres, machine_options.memory_limit);
    std::vector<LevelReport> levels;
    const IndexedMesh mesh = make_mesh(spheres, surface, {Connectivity::triangles, demand.normals},
                                       machine_options, machine.monitor(), report,
                                       {.on_level = record_levels(count, levels), .on_size = {}});
    report.parameters->memory_estimate = estimate;
    check_memory_after(demand, spheres, mesh, machine_options.memory_limit);
    report.mesh->levels = std::move(levels);
    extrapolate(mesh.triangle_labels(), *report.mesh);
    measure(mesh, count, machine.monitor(), report);
    check_with_cgal(mesh, cgal_check, report);
    measure_exactly(spheres, exact, machine.monitor(), report);
    compare_with_exact(mesh, spheres, distance_choice, machine_options.memory_limit,
                       machine.monitor(), report);
    if (!picture.path.empty()) {
      const IndexedMesh split = split_where_labelled(mesh, spheres);
      const IndexedMesh& shown = split.triangles.empty() ? mesh : split;
      write_picture(shown, paint_by_distance(shown, spheres, picture, machine.monitor()), picture,
                    machine_options, machine.monitor(), report);
    }
    machine.end_progress();
    add_warnings(report);
    if (!output.per_atom.empty()) {
      write_output(output.per_atom,
                   per_atom_csv(molecule, input.probe, *report.exact,
                                mesh_area_by_sphere(mesh, spheres.size()), output.group));
    }
    report.timing.total = watch.seconds();
    deliver(report, output, machine_options.verbosity);
  }

 private:
  InputFlags input_;
  SurfaceFlags surface_;
  ExactFlags exact_;
  DistanceFlags distances_;
  std::string self_intersections_ = "auto", cgal_check_ = "auto";
  MachineFlags machine_;
  PictureFlags picture_;
  OutputFlags output_;
};

}  // namespace

std::unique_ptr<Verb> make_report_verb() { return std::make_unique<ReportVerb>(); }

}  // namespace vdwmesh::apps
