// `vdwmesh compare`: a mesh file of any program beside the exact surface of a structure. What
// the file may have wrong, such as vertices that are not joined, other units or another place, is
// looked for, because the figures alone do not say it.
#include <fmt/format.h>

#include <filesystem>
#include <numbers>

#include "command_line/command_line.hpp"
#include "core/errors.hpp"
#include "memory_plan.hpp"
#include "mesh/mesh_io.hpp"
#include "steps/exact_steps.hpp"
#include "steps/excluded_steps.hpp"
#include "steps/picture.hpp"
#include "steps/steps.hpp"
#include "verbs/compare_hints.hpp"
#include "verbs/verbs.hpp"

namespace vdwmesh::apps {
namespace {

// A mesh takes about the bytes of its file, and while it is read both are there.
void check_file_size(const std::string& path, std::uint64_t limit) {
  std::error_code ignored;
  const std::uintmax_t bytes = std::filesystem::file_size(path, ignored);
  if (ignored || bytes <= limit / 2) return;
  throw LimitExceeded(
      fmt::format("{}: reading its {} bytes needs twice as many, {} are allowed: allow more with "
                  "--memory-limit, or write a mesh of fewer triangles",
                  path, bytes, limit));
}

// Vertices that several triangles hold apart are merged where that closes the mesh.
void measure_file(MeshFile& file, const std::string& path, SelfIntersections wanted,
                  Session& session) {
  if (file.mesh.triangle_count() == 0) {
    throw FileFormatError(path + ": holds no triangles; a triangle mesh is needed");
  }
  Report& report = session.report;
  const std::size_t notes = report.notes.size();
  measure(file.mesh, wanted, session);
  if (!report.mesh->topology.closed &&
      weld_if_that_closes(file, session.machine.memory_limit, report)) {
    report.notes.resize(notes);
    measure(file.mesh, wanted, session);
  }
  if (!(report.mesh->measures.area > 0)) {
    throw FileFormatError(path + ": none of its triangles has an area; it holds no surface");
  }
  report.mesh->path = path;
  report.mesh->notes = file.notes;
}

// A mesh of so much more area than the spheres is in other units or of something else, and its
// samples would take minutes to hours.
void check_area(const std::string& path, double area, const SphereSet& spheres,
                const DistanceChoice& choice) {
  constexpr double kMostTimes = 100, kFewSamples = 3e7;
  if (choice.distances == Switch::off || area * choice.samples_per_area <= kFewSamples) return;
  double whole = 0;
  for (const Sphere& s : spheres.spheres()) whole += 4 * std::numbers::pi * s.radius * s.radius;
  if (area <= kMostTimes * whole) return;
  throw LimitExceeded(
      fmt::format("{}: its area of {:.3g} Å² is {:.3g} times that of all spheres, and takes {:.1e} "
                  "samples: is it in Å? --distances off or fewer --samples compare it all the same",
                  path, area, area / whole, area * choice.samples_per_area));
}

}  // namespace

// Everything about the file is found out before the exact surface, which takes longer.
void run_compare(const Options& options) {
  VerbSession session(options.machine);
  const InputOptions& input = options.inputs.front();
  const Structure structure = load(input, session);
  const bool excluded = options.exact.surface == ExactSurface::excluded;
  const SphereSet spheres = excluded ? to_spheres(structure.molecule, 0) : structure.spheres;
  check_file_size(options.mesh_path, options.machine.memory_limit);
  MeshFile file = read_mesh(options.mesh_path, options.machine.memory_limit);
  session.end_stage(&Timing::read);
  const IndexedMesh& mesh = file.mesh;
  MemoryDemand demand;
  demand.self_intersections = options.self_intersections;
  demand.exact = method_for_memory(options.exact);
  demand.distances = options.distances.distances;
  check_memory_after(demand, structure.spheres, mesh, options.machine.memory_limit);
  measure_file(file, options.mesh_path, options.self_intersections, session);
  check_area(options.mesh_path, session.report.mesh->measures.area, spheres, options.distances);
  const bool is_elsewhere = warn_of_place(mesh, spheres, session.report);
  if (excluded) {
    measure_excluded(structure.molecule, input.probe, options.exact, Switch::off, session);
    compare_with_excluded(mesh, spheres, options.distances, session);
  } else {
    measure_exactly(spheres, options.exact, session);
    if (!is_elsewhere) warn_of_surface(session.report);
    compare_with_exact(mesh, spheres, options.distances, session);
  }
  if (!options.picture.path.empty()) draw_distances(mesh, spheres, options.picture, session);
  session.deliver_report(options.output);
}

}  // namespace vdwmesh::apps
