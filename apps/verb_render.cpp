#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "machine.hpp"
#include "memory_plan.hpp"
#include "mesh/mesh_io.hpp"
#include "output.hpp"
#include "picture.hpp"
#include "stopwatch.hpp"
#include "verbs.hpp"

namespace vdwmesh::apps {
namespace {

std::string summary_of(const Report& report) {
  return picture_text(*report.picture) + remarks_text(report) +
         fmt::format("{:<12} total {:.3f}\n", "Time (s)", report.timing.total);
}

class RenderVerb : public Verb {
 public:
  std::string name() const override { return "render"; }
  std::string summary() const override {
    return "a picture of a structure's surface, or of a mesh file";
  }

  void add_options(CLI::App& app) override {
    picture_.add_render_to(app);
    const std::size_t first = app.get_options().size();
    input_.add_to(app);
    surface_.add_to(app, 1);
    for (const CLI::Option* option : app.get_options()) of_structures_.push_back(option);
    of_structures_.erase(of_structures_.begin(),
                         of_structures_.begin() + static_cast<std::ptrdiff_t>(first));
    machine_.add_to(app, MachineFlags::Backends::choose);
  }

  void run() const override {
    const Stopwatch watch;
    NamedFiles files;
    const SurfaceOptions surface = surface_.resolve();
    const InputOptions input = input_.resolve(files, surface.field.preset);
    const MachineOptions machine_options = machine_.resolve();
    const PictureOptions picture = picture_.resolve(files);
    if (picture.path.empty()) throw InvalidInput("-o: name the picture to write (.png)");

    Machine machine(machine_options);
    Report report;
    if (find_mesh_format(input.path)) {
      draw_file(input.path, picture, machine_options, machine.monitor(), report);
    } else {
      draw_structure(input, surface, picture, machine_options, machine.monitor(), report);
    }
    machine.end_progress();
    report.timing.total = watch.seconds();
    if (machine_options.verbosity == Verbosity::normal) {
      return write_standard_output(summary_of(report));
    }
    print_warnings(report.warnings);
  }

 private:
  void draw_file(const std::filesystem::path& path, const PictureOptions& picture,
                 const MachineOptions& machine, Monitor* monitor, Report& report) const {
    const ColorBy color = picture.color.value_or(ColorBy::plain);
    if (color == ColorBy::element || color == ColorBy::distance) {
      throw InvalidInput(
          "--color: a mesh file has no atoms; vdwmesh compare MESH INPUT --picture FILE.png "
          "colours it by distance");
    }
    for (const CLI::Option* option : of_structures_) {
      if (option->count() == 0 || option->get_positional()) continue;
      throw InvalidInput(fmt::format("{}: is of structures; {} is a mesh, which is drawn as it is",
                                     option->get_name(), path.string()));
    }
    const MeshFile file = read_mesh(path);
    report.notes = file.notes;
    Paint paint = color == ColorBy::angle ? paint_by_angle(file.mesh, picture) : picture.plain;
    try {
      write_picture(file.mesh, std::move(paint), picture, machine, monitor, report);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("{}: {}", path.string(), error.what()));
    }
  }

  void draw_structure(const InputOptions& input, const SurfaceOptions& surface,
                      const PictureOptions& picture, const MachineOptions& machine,
                      Monitor* monitor, Report& report) const {
    const Molecule molecule = load(input, machine.memory_limit, report);
    const SphereSet spheres = to_spheres(molecule, input.probe);
    check_memory(spheres, surface, machine);
    const IndexedMesh mesh = make_mesh(spheres, surface, {}, machine, monitor, report);
    const IndexedMesh split = split_where_labelled(mesh, spheres);
    const IndexedMesh& shown = split.triangles.empty() ? mesh : split;
    write_picture(shown, paint_for(shown, molecule, spheres, picture, monitor), picture, machine,
                  monitor, report);
  }

  // Of the mesh; the renderer checks buffers and picture by itself.
  static void check_memory(const SphereSet& spheres, const SurfaceOptions& surface,
                           const MachineOptions& machine) {
    MemoryDemand demand;
    demand.surface = surface;
    demand.backend = resolve(machine.backend);
    demand.measures = Switch::off;
    check_memory_before(demand, spheres, machine.memory_limit);
  }

  static Paint paint_for(const IndexedMesh& mesh, const Molecule& molecule,
                         const SphereSet& spheres, const PictureOptions& picture,
                         Monitor* monitor) {
    switch (picture.color.value_or(ColorBy::element)) {
      case ColorBy::element:
        return paint_by_element(mesh, molecule);
      case ColorBy::distance:
        return paint_by_distance(mesh, spheres, picture, monitor);
      case ColorBy::angle:
        return paint_by_angle(mesh, picture);
      case ColorBy::plain:
        break;
    }
    return picture.plain;
  }

  PictureFlags picture_;
  InputFlags input_;
  SurfaceFlags surface_;
  MachineFlags machine_;
  std::vector<const CLI::Option*> of_structures_;  // which a mesh file has no use for
};

}  // namespace

std::unique_ptr<Verb> make_render_verb() { return std::make_unique<RenderVerb>(); }

}  // namespace vdwmesh::apps
