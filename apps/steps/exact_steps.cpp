// Steps of the verbs that measure the union exactly, and that set a mesh beside it: the union by
// arcs on a device or with its topology on the CPU; distances on either; then the comparison, its
// warnings, and the proof of a crease-exact mesh.
#include "steps/exact_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "analysis/mesh_measures.hpp"
#include "batch/molecule_spheres.hpp"
#include "creases/exact_mesher.hpp"
#include "cuda/backend.hpp"
#include "excluded/excluded_distances.hpp"
#include "measures/union_gradients.hpp"
#include "report/atom_names.hpp"
#include "report/csv.hpp"
#include "report/output.hpp"
#include "report/per_atom.hpp"
#include "report/sphere_file.hpp"
#include "request/refuse.hpp"
#include "structure/reference_areas.hpp"

namespace vdwmesh::apps {
namespace {

// The voids as CSV: a row for each, by falling volume; Å, Å², Å³. The lining atoms stand in one
// field, separated by spaces, as chain/residue number/atom name, and as index (from 1) where the
// file has no names.
std::string void_table_csv(const Molecule& molecule, const std::vector<Void>& voids) {
  std::string csv = "void,volume,area,center_x,center_y,center_z,clearance,lining_atoms,lining\n";
  for (std::size_t i = 0; i < voids.size(); ++i) {
    const Void& v = voids[i];
    std::string lining;
    for (const SphereId id : v.lining) {
      if (!lining.empty()) lining += ' ';
      lining += name_of_atom(molecule, id);
    }
    csv += fmt::format("{},{},{},{},{},{},{},{},{}\n", i + 1, v.volume, v.area, v.center.x,
                       v.center.y, v.center.z, v.clearance, v.lining.size(), csv_field(lining));
  }
  return csv;
}

// A sphere for each void: that of the largest probe which the atoms let in at its centre.
std::string void_spheres(const std::vector<Void>& voids, double probe, SphereFormat format) {
  std::vector<SphereGroup> groups;
  for (const Void& v : voids)
    groups.push_back({.kind = "void",
                      .number = groups.size() + 1,
                      .figure = fmt::format("{} Å³", v.volume),
                      .spheres = {{v.center, v.clearance + probe}}});
  return sphere_file(groups, "voids", format);
}

// Components that fell between the grid nodes would otherwise be lost without a word. Of a mesh
// inside out, of which another warning speaks, all components count as voids. Blended fields join
// and shrink what is apart or small, whatever the spacing.
void warn_of_lost_components(std::uint64_t in_union, Report& report) {
  if (report.parameters && report.parameters->surface.field.kind != FieldKind::vdw) return;
  const auto& components = report.mesh->topology.components;
  if (!components || *components >= in_union) return;
  if (report.mesh->measures.volume.value_or(0) < 0) return;
  const bool is_ours = report.parameters.has_value();
  report.warnings.push_back(fmt::format(
      "components: {} in the mesh, {} in the union of the spheres{}", *components, in_union,
      is_ours
          ? "; pieces closer together than the spacing are joined, smaller ones are missed, and "
            "a smaller --spacing tells them apart"
          : ": pieces are joined or missing"));
}

// The union by arcs, on the backend of the session.
void measure_by_arcs(const SphereSet& spheres, Session& session) {
  BatchMeasures measures =
      make_union_measurer(session.machine.backend)->measure(batch_of(spheres), session.monitor);
  ExactReport& exact = *session.report.exact;
  exact.method = UnionMethod::arcs;
  exact.area = measures.totals[0].area;
  exact.volume = measures.totals[0].volume;
  exact.per_sphere = std::move(measures.per_sphere);
  exact.fallback_spheres = measures.fallback_spheres;
  exact.backend = measures.fallback.empty() ? Backend::cuda : Backend::cpu;
  if (!measures.fallback.empty()) session.report.notes.push_back(measures.fallback);
}

}  // namespace

bool needs_cpu(const ExactOptions& options, const MeasuredSpheres& measured) {
  return options.method != UnionMethod::arcs || options.topology != TopologyRequest::none ||
         options.certify || measured;
}

bool wants_device(const SphereSet& spheres, const ExactOptions& options, const Session& session,
                  const MeasuredSpheres& measured) {
  const Backend requested = session.machine.backend;
  if (requested == Backend::cuda) resolve(requested);
  if (needs_cpu(options, measured)) return false;
  const auto& mesher = session.report.backend;
  const bool is_started = mesher && mesher->used == Backend::cuda;
  if (requested == Backend::automatic && !is_started && spheres.size() < kBallsWorthADevice) {
    return false;
  }
  return resolve(requested) == Backend::cuda;
}

void measure_exactly(const SphereSet& spheres, const ExactOptions& options, Session& session,
                     const MeasuredSpheres& measured) {
  if (wants_device(spheres, options, session, measured)) {
    session.report.exact.emplace();
    measure_by_arcs(spheres, session);
  } else {
    measure_on_cpu(spheres, options, session, measured);
  }
  session.end_stage(&Timing::exact);
}

void measure_on_cpu(const SphereSet& spheres, const ExactOptions& options, Session& session,
                    const MeasuredSpheres& measured) {
  Report& report = session.report;
  UnionOptions wanted{.method = options.method, .monitor = session.monitor};
  wanted.topology = options.topology;
  wanted.certify = options.certify;
  wanted.memory_limit = session.machine.memory_limit;
  if (measured) wanted.measured = *measured;
  report.exact.emplace();
  exact_union_into(*report.exact, spheres, wanted);
  if (options.topology != TopologyRequest::full) report.exact->topology.reset();
  if (options.topology == TopologyRequest::none) report.exact->counts.reset();
}

namespace {

// How deep the centres of atoms lie below the excluded surface, Å.
std::vector<double> atom_depths(const Molecule& molecule, double probe, ExcludedPart part,
                                const Session& session) {
  std::vector<Vec3d> centers;
  for (const Atom& atom : molecule.atoms) centers.push_back(atom.position);
  std::vector<double> found =
      excluded_signed_distances(centers, to_spheres(molecule, 0), probe, session.monitor, part);
  std::ranges::transform(found, found.begin(), std::negate<>());
  return found;
}

std::vector<double> atom_figures(const OutputOptions& output, const Molecule& molecule,
                                 double probe, const Session& session) {
  const auto& exact = session.report.exact;
  const AtomFigure figure = output.b_factor;
  if (figure == AtomFigure::exposure)
    return residue_exposure({molecule, probe, *exact, {}, AtomGroup::residue});
  std::vector<double> figures;
  if (figure == AtomFigure::depth) {
    figures = atom_depths(molecule, probe, ExcludedPart::complete, session);
    // The nearest points of both surfaces lie on one line.
    if (exact) std::ranges::for_each(figures, [probe](double& depth) { depth += probe; });
    return figures;
  }
  if (exact) {
    for (const SphereMeasures& m : exact->per_sphere)
      figures.push_back(figure == AtomFigure::area ? m.area : m.volume);
    return figures;
  }
  for (const auto& [area, volume] : session.report.excluded->complete.per_atom) {
    const double sum = area.contact + area.saddle + area.concave;
    figures.push_back(figure == AtomFigure::area ? sum : volume);
  }
  return figures;
}

}  // namespace

void check_references(const OutputOptions& output, const Molecule& molecule, double probe) {
  const bool of_file = !output.atoms.empty() && output.b_factor == AtomFigure::exposure;
  if (!of_file && output.residues.empty()) return;
  refuse_if(probe != kReferenceProbe || !reference_areas(molecule.radius_set, "LEU"),
            "{}: extended residues are known for a probe of 1.4 Å and three sets of radii; add "
            "--surface sas --radii protor (or naccess, oons)",
            of_file ? "--b-factor exposure" : "--rsa");
}

void write_atoms(const OutputOptions& output, const Molecule& molecule, double probe,
                 VerbSession& session) {
  if (output.atoms.empty()) return;
  const std::string_view name = name_of(output.b_factor);
  write_atom_file(output.atoms, molecule, {{name, atom_figures(output, molecule, probe, session)}},
                  session);
}

void write_depths(const OutputOptions& output, const Molecule& molecule, double probe,
                  VerbSession& session) {
  if (output.depth.empty()) return;
  const AtomDepths found{atom_depths(molecule, probe, ExcludedPart::complete, session),
                         atom_depths(molecule, probe, ExcludedPart::exterior, session)};
  session.end_stage(&Timing::compare);
  session.end_progress();
  write_output(output.depth, depth_csv(molecule, probe, found, output.group));
  session.end_stage(&Timing::write);
}

void write_gradient(const OutputOptions& output, const SphereSet& spheres, VerbSession& session) {
  if (output.gradient.empty()) return;
  const UnionGradients found = union_gradients(spheres, {.monitor = session.monitor});
  write_gradient(output, found.gradients, found.kink_spheres, session);
}

void write_gradient(const OutputOptions& output, const std::vector<BallGradient>& gradients,
                    std::uint64_t kink_spheres, VerbSession& session) {
  if (kink_spheres > 0) {
    session.report.note(
        "{} atoms touch another one, or equal it: area and volume may have no derivative there, "
        "and the table has that of the atoms without contact",
        kink_spheres);
  }
  session.end_stage(&Timing::exact);
  session.end_progress();
  write_output(output.gradient, gradient_csv(gradients));
  session.end_stage(&Timing::write);
}

void write_excluded_gradient(const OutputOptions& output, VerbSession& session) {
  if (output.gradient.empty()) return;
  const ExcludedGradients& found = session.report.excluded->complete.gradients.value();
  if (found.kink_probes + found.kink_atoms > 0) {
    session.report.note(
        "{} probes touch more than three atoms or lie in their plane, and {} atoms equal another "
        "one: area and volume may have no derivative there; the table has finite ones",
        found.kink_probes, found.kink_atoms);
  }
  session.end_progress();
  write_output(output.gradient, gradient_csv(found.per_atom));
  session.end_stage(&Timing::write);
}

void write_voids(const OutputOptions& output, const Molecule& molecule, double probe,
                 VerbSession& session) {
  if (output.voids.empty()) return;
  session.end_progress();
  const std::vector<Void>& voids = session.report.exact->topology.value().void_table;
  const auto format = find_sphere_format(output.voids);
  write_output(output.voids,
               format ? void_spheres(voids, probe, *format) : void_table_csv(molecule, voids));
  session.end_stage(&Timing::write);
}

void measure_polarity(const Molecule& molecule, Session& session) {
  ExactReport& exact = *session.report.exact;
  exact.by_polarity = area_by_polarity(molecule, exact);
  session.end_stage(&Timing::exact);
}

// A device is taken without being asked for where the mesh was made on it or where that saves time.
DistanceBackend choose_for_distances(std::uint64_t triangles, const Session& session) {
  const Backend requested = session.machine.backend;
  if (requested != Backend::automatic) return {requested, std::nullopt};
  const DeviceList list = cuda_devices();
  if (list.devices.empty()) return {Backend::cpu, list.reason};
  const auto& mesher = session.report.backend;
  const bool is_started = mesher && mesher->used == Backend::cuda;
  if (is_started || triangles >= kTrianglesWorthADevice) return {Backend::automatic, std::nullopt};
  return {Backend::cpu,
          fmt::format("for {} triangles the start of a device takes longer", triangles)};
}

namespace {

MeasuredDistances measure_on(Backend backend, const IndexedMesh& mesh, const SphereSet& spheres,
                             const DistanceChoice& choice, const Session& session) {
  return make_distance_measurer(backend)->measure(
      mesh, spheres,
      {choice.samples_per_area, choice.seed, session.machine.memory_limit, session.monitor});
}

}  // namespace

MeasuredDistances measure_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                                    const DistanceChoice& choice, const Session& session) {
  const Backend backend = choose_for_distances(mesh.triangle_count(), session).backend;
  return measure_on(backend, mesh, spheres, choice, session);
}

std::vector<float> measure_centers(const IndexedMesh& mesh, const SphereSet& spheres,
                                   Session& session) {
  std::vector<Vec3d> centers(mesh.triangle_count());
  std::ranges::transform(mesh.triangles, centers.begin(), [&](const Triangle& t) {
    return (1.0 / 3) * (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]);
  });
  if (const auto& excluded = session.report.excluded) {
    const auto d = excluded_signed_distances(centers, spheres, excluded->probe, session.monitor);
    return {d.begin(), d.end()};
  }
  const Backend backend = choose_for_distances(mesh.triangle_count(), session).backend;
  const MeasuredPoints measured =
      make_distance_measurer(backend)->measure_points(centers, spheres, session.monitor);
  if (!measured.fallback.empty()) session.report.notes.push_back(measured.fallback);
  return {measured.result.begin(), measured.result.end()};
}

TakenDistances take_distances(const IndexedMesh& mesh, const SphereSet& spheres,
                              const DistanceChoice& choice, const Session& session) {
  const DistanceBackend chosen = choose_for_distances(mesh.triangle_count(), session);
  return {chosen, measure_on(chosen.backend, mesh, spheres, choice, session)};
}

namespace {

// Adds the distances and says which backend measured them, and why.
void add_distances(const TakenDistances& taken, Session& session) {
  ComparisonReport& comparison = *session.report.comparison;
  const auto& [chosen, measured] = taken;
  comparison.distances = measured.result;
  comparison.distances_reason = chosen.reason;
  comparison.distances_backend = chosen.backend == Backend::cpu ? Backend::cpu : Backend::cuda;
  if (measured.fallback.empty()) return;
  session.report.notes.push_back(measured.fallback);
  comparison.distances_backend = Backend::cpu;
  comparison.distances_reason = measured.fallback;
}

// Point contacts count twice on a mesh, as in Comparison.
std::optional<bool> has_exact_topology(const MeshReport& mesh, const ExactReport& exact) {
  if (!exact.topology || !mesh.topology.components || !mesh.topology.voids) return std::nullopt;
  const UnionTopology& topology = *exact.topology;
  return mesh.topology.euler_characteristic ==
             topology.euler_characteristic +
                 2 * static_cast<std::int64_t>(topology.point_contacts) &&
         *mesh.topology.components == topology.components && *mesh.topology.voids == topology.voids;
}

std::optional<double> relative_error(const std::optional<double>& value, double exact) {
  return value ? std::optional(*value / exact - 1) : std::nullopt;
}

// Atoms of files without names, such as XYZR, are called by their place in use, from 1.
std::string name_of_atom(const Molecule& molecule, SphereId id) {
  const Atom& atom = molecule.atoms[id];
  if (atom.name.empty()) return fmt::format("atom {}", id + 1);
  return fmt::format("{}/{} {} {}", atom.chain.view(), atom.residue_number.view(),
                     atom.residue_name.view(), atom.name.view());
}

std::optional<AtomErrors> atom_errors(const IndexedMesh& mesh, const Molecule& molecule,
                                      const ExactReport& exact) {
  const auto errors =
      area_errors(mesh_area_by_sphere(mesh, molecule.atoms.size()), exact.per_sphere);
  if (!errors) return std::nullopt;
  return AtomErrors{errors->max, errors->rms, errors->spheres,
                    name_of_atom(molecule, errors->worst)};
}

}  // namespace

void compare_with_exact(const IndexedMesh& mesh, const SphereSet& spheres,
                        const DistanceChoice& choice, Session& session) {
  std::optional<TakenDistances> taken;
  if (choice.distances == Switch::on) taken = take_distances(mesh, spheres, choice, session);
  compare_with_exact(spheres, taken, session);
}

void compare_with_exact(const SphereSet& spheres, const std::optional<TakenDistances>& taken,
                        Session& session) {
  Report& report = session.report;
  report.comparison.emplace(compare(report.mesh->topology, report.mesh->measures, *report.exact));
  if (taken) add_distances(*taken, session);
  const auto& counts = report.exact->counts;
  warn_of_lost_components(counts ? counts->components : count_components(spheres), report);
  session.end_stage(&Timing::compare);
}

void prove(const IndexedMesh& mesh, const Molecule& molecule, Session& session) {
  Report& report = session.report;
  if (mesh.triangle_labels() == TriangleLabels::none || !report.parameters ||
      report.parameters->surface.mesher != Mesher::exact) {
    return;
  }
  MeshProof& proof = report.comparison->proof.emplace();
  proof.topology_is_exact = has_exact_topology(*report.mesh, *report.exact);
  proof.atoms = atom_errors(mesh, molecule, *report.exact);
  if (const auto& stats = report.mesh->arrangement) proof.below_floor = stats->below_floor;
  if (!report.input.measure) {
    proof.extrapolated_area_error =
        relative_error(report.mesh->extrapolated_area, report.exact->area);
    proof.extrapolated_volume_error =
        relative_error(report.mesh->extrapolated_volume, report.exact->volume);
  }
  session.end_stage(&Timing::compare);
}

void warn_of_lost_balls(const SphereSet& spheres, Session& session) {
  warn_of_lost_balls(count_components(spheres), session);
}

void warn_of_lost_balls(std::uint64_t pieces, Session& session) {
  warn_of_lost_components(pieces, session.report);
}

}  // namespace vdwmesh::apps
