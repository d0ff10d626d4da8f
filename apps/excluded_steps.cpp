// Measures, meshes, refines and draws the excluded surface by the libraries, and writes what was
// found into the report of the session.
#include "excluded_steps.hpp"

#include <array>
#include <utility>

#include "excluded/excluded_measures.hpp"
#include "excluded/excluded_mesher.hpp"
#include "picture.hpp"
#include "refine/patch_refiner.hpp"
#include "render/crease_split.hpp"

namespace vdwmesh::apps {

void measure_excluded(const Molecule& molecule, double probe, const ExactOptions& options,
                      Switch per_atom, Session& session) {
  ExcludedOptions wanted{.probe = probe, .monitor = session.monitor};
  wanted.per_atom = per_atom == Switch::on;
  wanted.shells = options.topology == TopologyRequest::full;
  wanted.exterior = true;
  session.report.excluded = excluded_measures(to_spheres(molecule, 0), wanted);
  const std::uint64_t doubtful = session.report.excluded->complete.checks.uncertified_patches;
  session.report.warn_if(
      doubtful > 0,
      "{} concave patches of the excluded surface are not certified: area, volume "
      "and topology may be wrong there",
      doubtful);
  session.end_stage(&Timing::exact);
}

PatchedMesh make_excluded_mesh(const Molecule& molecule, double probe,
                               const SurfaceOptions& surface, Session& session,
                               const LevelObserver& on_level) {
  Report& report = session.report;
  report.backend = describe_backend(session.machine.backend, Backend::cpu);
  ExcludedMeshOptions options;
  options.probe = probe;
  options.edge_length = surface.edge_length.value_or(options.edge_length);
  options.memory_limit = session.machine.memory_limit;
  options.monitor = session.monitor;
  ParametersReport& parameters = report.parameters.emplace();
  parameters.surface = surface;
  parameters.memory_limit = options.memory_limit;
  const SphereSet atoms = to_spheres(molecule, 0);
  ExcludedMesh made = mesh_excluded(atoms, options);
  report.timing.extract = made.stats.seconds;
  PatchedMesh mesh = std::move(static_cast<PatchedMesh&>(made));
  if (surface.subdivisions > 0) {
    PatchRefineResult refined = refine_patches(atoms, std::move(mesh),
                                               {.subdivisions = surface.subdivisions,
                                                .memory_limit = options.memory_limit,
                                                .on_level = on_level,
                                                .monitor = session.monitor});
    report.timing.refine = refined.seconds;
    if (!report.mesh) report.mesh.emplace();
    report.mesh->projection = std::move(refined.levels);
    mesh = std::move(refined.mesh);
  }
  session.end_stage(&Timing::mesh);
  return mesh;
}

PatchReport count_patches(const PatchedMesh& mesh) {
  PatchReport report;
  std::array<PatchCount*, kPatchKinds> by_kind{&report.contact, &report.saddle, &report.concave};
  const auto count_of = [&](const SurfacePatch& patch) -> PatchCount& {
    return *by_kind.at(static_cast<std::size_t>(patch.kind));
  };
  for (const SurfacePatch& patch : mesh.patches) ++count_of(patch).patches;
  for (std::size_t t = 0; t < mesh.triangle_patch.size(); ++t) {
    const Triangle& v = mesh.mesh.triangles[t];
    const Vec3d& p = mesh.mesh.positions[v[0]];
    PatchCount& count = count_of(mesh.patches[mesh.triangle_patch[t]]);
    ++count.triangles;
    count.area += norm(cross(mesh.mesh.positions[v[1]] - p, mesh.mesh.positions[v[2]] - p)) / 2;
  }
  return report;
}

void draw_excluded(const PatchedMesh& mesh, const Molecule& molecule, const PictureOptions& options,
                   Session& session) {
  const IndexedMesh split = split_at_patches(mesh);
  const auto painter = [&](const IndexedMesh& shown) -> Paint {
    const ColorBy color = options.color.value_or(ColorBy::element);
    if (is_of_patches(color)) return paint_by_patch(shown, mesh, options);
    if (color == ColorBy::angle) return paint_by_angle(shown, options);
    if (color == ColorBy::plain) return options.plain;
    return paint_by_element(shown, molecule);
  };
  draw_mesh(split, painter, options, session);
}

}  // namespace vdwmesh::apps
