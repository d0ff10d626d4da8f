// `vdwmesh render`: a picture of the surface of a structure, or of a mesh file, which is told by
// its name. A structure is meshed first, as by `mesh`. The exact union is asked only where colours
// show the distance to it.
#include <fmt/format.h>

#include <filesystem>

#include "command_line/command_line.hpp"
#include "core/errors.hpp"
#include "memory_plan.hpp"
#include "mesh/mesh_io.hpp"
#include "request/refuse.hpp"
#include "steps/edge_lengths.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/picture.hpp"
#include "steps/steps.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

// In grey, unless the angles are wanted.
void draw_file(const std::filesystem::path& path, const PictureOptions& picture, Session& session) {
  const MeshFile file = read_mesh(path, session.machine.memory_limit);
  session.report.notes = file.notes;
  const auto painter = [&](const IndexedMesh& mesh) {
    return picture.color == ColorBy::angle ? paint_by_angle(mesh, picture) : Paint(picture.plain);
  };
  try {
    draw_mesh(file.mesh, painter, picture, session);
  } catch (const InvalidInput& error) {
    refuse("{}: {}", path.string(), error.what());
  }
}

// Of the mesh; the renderer checks buffers and picture by itself.
void check_memory(const SphereSet& spheres, const Options& options) {
  MemoryDemand demand;
  demand.surface = options.surface;
  demand.backend = resolve(options.machine.backend);
  demand.measures = Switch::off;
  check_memory_before(demand, spheres, options.machine.memory_limit);
}

Paint paint_for(const IndexedMesh& mesh, const Structure& structure, const PictureOptions& picture,
                Session& session) {
  const ColorBy color = picture.color.value_or(ColorBy::element);
  if (is_of_atoms(color)) return paint_by_atom(mesh, structure.molecule, picture, session);
  if (color == ColorBy::angle) return paint_by_angle(mesh, picture);
  if (color == ColorBy::plain) return picture.plain;
  return paint_by_distance(mesh, structure.spheres, picture, session);
}

// The mesher has a memory limit of its own.
void draw_excluded_surface(const Options& options, Session& session) {
  const InputOptions& input = options.inputs.front();
  const Molecule molecule = load_molecule(input, session);
  check_references(options.picture, molecule);
  const PatchedMesh mesh = make_excluded_mesh(molecule, input.probe, options.surface, session);
  draw_excluded(mesh, molecule, options.picture, session);
}

// Where triangles know their spheres, creases are drawn sharp.
void draw_structure(const Options& given, Session& session) {
  const Structure structure = load(given.inputs.front(), session);
  check_references(given.picture, structure.molecule);
  const Options options = with_edge_lengths(given, structure);
  check_memory(structure.spheres, options);
  const IndexedMesh mesh = make_mesh(structure.spheres, options.surface, session);
  const auto painter = [&](const IndexedMesh& shown) {
    return paint_for(shown, structure, options.picture, session);
  };
  draw_surface(mesh, structure.spheres, painter, options.picture, session);
}

std::string summary_of(const Report& report) {
  return picture_text(*report.picture) + remarks_text(report) +
         fmt::format("{:<12} total {:.3f}\n", "Time (s)", report.timing.total.wall);
}

}  // namespace

void run_render(const Options& options) {
  VerbSession session(options.machine);
  const std::filesystem::path& path = options.inputs.front().path;
  if (find_mesh_format(path)) {
    draw_file(path, options.picture, session);
  } else if (options.surface.kind == ExactSurface::excluded) {
    draw_excluded_surface(options, session);
  } else {
    draw_structure(options, session);
  }
  session.end_progress();
  session.stop_watch();
  session.deliver_text(options.output, [&] { return summary_of(session.report); });
}

}  // namespace vdwmesh::apps
