// Measures, meshes, refines and draws the excluded surface by the libraries, and writes what was
// found into the report of the session.
#include "steps/excluded_steps.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "cuda/backend.hpp"
#include "excluded/excluded_bounds.hpp"
#include "excluded/excluded_comparison.hpp"
#include "excluded/excluded_distances.hpp"
#include "excluded/excluded_measures.hpp"
#include "excluded/excluded_mesher.hpp"
#include "refine/patch_refiner.hpp"
#include "remesh/surface_remesher.hpp"
#include "render/crease_split.hpp"
#include "report/output.hpp"
#include "report/per_atom.hpp"
#include "steps/picture.hpp"

namespace vdwmesh::apps {

// Spheres of atoms come from to_spheres(molecule, 0) in this file: with their own radii, because
// the functions of the excluded surface take the probe as an argument and grow the atoms
// themselves.

namespace {

void warn_of_doubts(Report& report) {
  for (std::string& line : doubts(report.excluded->complete)) {
    report.warnings.push_back(std::move(line));
  }
}

}  // namespace

void measure_excluded(const Molecule& molecule, double probe, const ExactOptions& options,
                      Switch per_atom, Session& session, Switch gradients) {
  ExcludedOptions wanted{.probe = probe, .monitor = session.monitor};
  wanted.per_atom = per_atom == Switch::on;
  wanted.gradients = gradients == Switch::on;
  wanted.shells = options.topology == TopologyRequest::full;
  wanted.exterior = true;
  session.report.excluded = excluded_measures(to_spheres(molecule, 0), wanted);
  warn_of_doubts(session.report);
  session.end_stage(&Timing::exact);
}

void measure_excluded_on_cuda(const Molecule& molecule, double probe, Switch per_atom,
                              Session& session) {
  Report& report = session.report;
  report.backend = describe_backend(Backend::cuda, resolve(Backend::cuda));
  const SphereSet atoms = to_spheres(molecule, 0);
  ExcludedBatch found =
      make_excluded_measurer(Backend::cuda)->measure(batch_of(atoms), probe, session.monitor);
  // `complete` is the surface with its cavities. `exterior` is left empty.
  ExcludedSurface& s =
      report.excluded.emplace(ExcludedMeasures{probe, surface_of(found, 0), {}}).complete;
  s.per_atom = std::move(found.per_atom);
  check_digits(s, probe);
  warn_of_doubts(report);
  if (per_atom == Switch::off) s.per_atom.clear();
  report.note(
      "cuda measured the complete surface, without its shells; the CPU decided about {} balls, {} "
      "circles, {} corners and {} concave patches{}",
      found.host_balls, found.host_circles, found.host_corners, found.host_patches,
      found.host_sets > 0 ? ", then measured all, because a probe touches four atoms or more, or "
                            "because the checks of the rest do not hold"
                          : "");
  session.end_stage(&Timing::exact);
}

namespace {

// Necks, cavities and corners need some triangles each, whatever density is asked for.
void note_density(const RemeshedSurface& made, const SurfaceOptions& surface, Report& report) {
  constexpr double kFarAbove = 1.5;
  const double has = static_cast<double>(made.mesh.triangle_count()) / measures(made.mesh).area;
  if (!surface.density || has <= kFarAbove * *surface.density) return;
  report.note(
      "the mesh has {:.1f} triangles per Å², not {}: necks, cavities, creases and corners "
      "need so many",
      has, *surface.density);
}

// The mesh that does not follow the curves, with an account of it in the report.
PatchedMesh make_remeshed(const SphereSet& atoms, double probe, const SurfaceOptions& surface,
                          Session& session) {
  const RemeshOptions options = {.probe = probe,
                                 .edge_length = surface.edge_length.value(),
                                 .memory_limit = session.machine.memory_limit,
                                 .monitor = session.monitor};
  RemeshedSurface made = surface.max_distance ? remesh_within(atoms, *surface.max_distance, options)
                                              : remesh_excluded(atoms, options);
  Report& report = session.report;
  report.timing.extract = made.stats.exact_seconds;
  report.timing.refine = made.stats.seconds - made.stats.exact_seconds;
  if (!report.mesh) report.mesh.emplace();
  report.mesh->remeshing = made.stats;
  note_density(made, surface, report);
  session.end_stage(&Timing::mesh);
  return std::move(static_cast<PatchedMesh&>(made));
}

}  // namespace

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
  report.parameters = describe_parameters(surface, std::nullopt, options.memory_limit);
  const SphereSet atoms = to_spheres(molecule, 0);
  if (surface.remeshed) return make_remeshed(atoms, probe, surface, session);
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
    return paint_by_atom(shown, molecule, options, session);
  };
  draw_mesh(split, painter, options, session);
}

std::uint64_t plan_excluded_mesh(const Structure& structure, double probe,
                                 const ExactOptions& exact, Switch per_atom, MemoryDemand& demand,
                                 Session& session) {
  MemoryDemand measures;
  measures.exact = method_for_memory(exact);
  check_memory_before(measures, structure.spheres, session.machine.memory_limit);
  session.end_stage(&Timing::plan);
  measure_excluded(structure.molecule, probe, exact, per_atom, session);
  demand.spheres = structure.spheres.size();
  demand.area = session.report.excluded->complete.area;
  const std::uint64_t estimate = check_memory(demand, session.machine.memory_limit);
  session.end_stage(&Timing::plan);
  return estimate;
}

namespace {

// A mesh without walls of cavities may well be one of the exterior surface alone, if its topology
// is not that of the complete one. Of an open mesh nobody knows what is a wall.
bool may_be_exterior(const Report& report) {
  return report.mesh->topology.voids == std::uint64_t{0} &&
         report.comparison->euler_characteristic_difference.value_or(1) != 0;
}

void compare_with_exterior(const IndexedMesh& mesh, const SphereSet& atoms,
                           const DistanceChoice& choice, const DistanceOptions& options,
                           Report& report) {
  const ExcludedMeasures& exact = *report.excluded;
  const auto& topology = exact.complete.topology;
  if (!exact.exterior || !topology) return;
  // Cavities are counted by components of the accessible surface, not by shells: if probes inside
  // overlap probes outside, the cavity exists, but its walls are part of another shell.
  const auto cavities =
      std::ranges::count(topology->components, true, &AccessibleComponent::is_cavity);
  if (cavities == 0) return;
  Comparison& comparison = report.comparison->exterior.emplace(
      compare(report.mesh->topology, report.mesh->measures, *exact.exterior));
  if (!may_be_exterior(report)) return;
  report.note(
      "the exact surface has {} cavities, and the mesh no walls of any: it may be of the "
      "exterior surface alone, with which it is compared too",
      cavities);
  if (choice.distances == Switch::off) return;
  comparison.distances =
      excluded_distances(mesh, atoms, exact.probe, options, ExcludedPart::exterior);
}

}  // namespace

void compare_with_excluded(const IndexedMesh& mesh, const SphereSet& atoms,
                           const DistanceChoice& choice, Session& session) {
  Report& report = session.report;
  const ExcludedMeasures& excluded = *report.excluded;
  ComparisonReport& comparison = report.comparison.emplace(
      compare(report.mesh->topology, report.mesh->measures, excluded.complete));
  comparison.surface = ExactSurface::excluded;
  const DistanceOptions options{choice.samples_per_area, choice.seed, session.machine.memory_limit,
                                session.monitor};
  if (choice.distances == Switch::on) {
    comparison.distances = excluded_distances(mesh, atoms, excluded.probe, options);
    comparison.bounds = excluded_distance_bounds(
        mesh, atoms, excluded.probe,
        {.memory_limit = session.machine.memory_limit, .monitor = session.monitor});
    comparison.distances_reason = "distances to the excluded surface are measured on the CPU";
  }
  compare_with_exterior(mesh, atoms, choice, options, report);
  session.end_stage(&Timing::compare);
}

void prove_excluded(Session& session) {
  Report& report = session.report;
  const auto& exact = report.excluded->complete.topology;
  const MeshTopology& mesh = report.mesh->topology;
  MeshProof& proof = report.comparison->proof.emplace();
  if (exact && mesh.voids) {
    const ShellFigures shells = shell_figures(*exact);
    proof.topology_is_exact = mesh.euler_characteristic == exact->euler_characteristic &&
                              mesh.shells == shells.outer + shells.walls &&
                              *mesh.voids == shells.walls;
  }
  const ExcludedSurface& surface = report.excluded->complete;
  if (report.mesh->extrapolated_area) {
    proof.extrapolated_area_error = *report.mesh->extrapolated_area / surface.area - 1;
  }
  if (report.mesh->extrapolated_volume) {
    proof.extrapolated_volume_error = *report.mesh->extrapolated_volume / surface.volume - 1;
  }
  session.end_stage(&Timing::compare);
}

void write_excluded_atoms(const OutputOptions& output, const Molecule& molecule,
                          VerbSession& session) {
  if (output.per_atom.empty()) return;
  session.end_progress();
  write_output(
      output.per_atom,
      excluded_atoms_csv(molecule, session.report.excluded->complete.per_atom, output.group));
  session.end_stage(&Timing::write);
}

}  // namespace vdwmesh::apps
