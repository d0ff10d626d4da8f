// The steps that the verbs (mesh, report and so on) are made of. Each calls the libraries for one
// thing, measures how long it took, and writes what it found into the report of the session. What
// only explains figures, such as a fallback to the CPU or a check that was left out, becomes a
// note; what may be wrong becomes a warning.
#include "steps/steps.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/mesh_measures.hpp"
#include "cuda/backend.hpp"
#include "report/output.hpp"
#include "request/refuse.hpp"
#include "steps/grid_checks.hpp"
#include "steps/stopwatch.hpp"

namespace vdwmesh::apps {
namespace {

// Returns the report of the input: a copy of all members of the molecule but its atoms. The atoms
// are moved out while the copy is made, and then put back.
InputReport input_of(Molecule& molecule, const InputOptions& options) {
  std::vector<Atom> atoms = std::exchange(molecule.atoms, {});
  InputReport input{molecule, atoms.size(), options.probe, std::nullopt, 0};
  // `measure` is the selection as text, `measured` the number of atoms that it selects.
  if (!options.read.measure.empty()) input.measure = options.read.measure;
  input.measured = static_cast<std::uint64_t>(std::ranges::count(atoms, true, &Atom::measured));
  molecule.atoms = std::move(atoms);
  return input;
}

int cpu_threads() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

// Returns how many devices make the mesh, 0 if the CPU makes it. Refuses if more are asked for than
// there are. Notes in the report if several were asked for but the CPU makes the mesh, or only one
// device does, because no work but an extraction is shared.
int devices_for(const SurfaceOptions& surface, Session& session) {
  const MachineOptions& machine = session.machine;
  Report& report = session.report;
  if (report.backend->used == Backend::cpu) {
    if (machine.devices > 1) {
      report.notes.push_back(fmt::format(
          "--devices {}: there is no CUDA device here; the CPU made the mesh", machine.devices));
    }
    return 0;
  }
  const std::size_t present = cuda_devices().devices.size();
  refuse_if(static_cast<std::size_t>(machine.devices) > present,
            "--devices {}: the CUDA devices here are {}, so at most {}", machine.devices, present,
            present);
  if (machine.devices == 1) return 1;
  if (surface.mesher == Mesher::marching_cubes && surface.subdivisions == 0) return machine.devices;
  report.notes.push_back(
      fmt::format("--devices {}: only marching cubes without --subdivide is shared; one was used",
                  machine.devices));
  return 1;
}

// Marching cubes and its refinement run as one pipeline, which keeps the mesh on the device between
// the two.
IndexedMesh mesh_field(const SphereSet& spheres, const SurfaceOptions& surface,
                       const WantedMesh& request, RefineOptions& refine, Report& report) {
  require_sensible_spacing(spheres, surface.grid.spacing);
  const GridSpec grid = make_grid(spheres, surface.grid);
  report.parameters = describe_parameters(surface, grid, refine.memory_limit);
  ExtractOptions extract;
  extract.field = surface.field;
  extract.grid = surface.grid;
  extract.connectivity = request.connectivity;
  extract.normals = request.normals;
  extract.memory_limit = refine.memory_limit;
  extract.monitor = refine.monitor;
  // The report has 0 devices if the CPU makes the mesh; ExtractOptions wants at least 1.
  extract.devices = std::max(report.backend->devices, 1);
  refine.grid = grid;
  PipelineResult result = make_pipeline(report.backend->requested)->run(spheres, extract, refine);
  account_for_fallback(result.fallback, report);
  require_triangles(result.mesh.triangle_count(), spheres, grid.spacing,
                    report.parameters->isovalue);
  report.timing.field = result.extract.field_seconds;
  report.timing.extract = result.extract.extract_seconds;
  if (!result.levels.empty()) report.timing.refine = result.refine_seconds;
  report.mesh.emplace();
  report.mesh->grid_clipped = result.extract.grid_clipped;
  report.mesh->clamped_vertices = result.extract.clamped_vertices;
  report.mesh->projection = std::move(result.levels);
  return std::move(result.mesh);
}

// Notes if the mesh has another topology than the union. The mesher shrinks to a point each arc or
// circle that is too small for its points to have different coordinates, and this may change the
// topology. Notes as well if it has not, since surfaces may touch in such a point.
void note_points(const ExactMeshStats& s, Report& report) {
  if (s.points + s.contacts + s.joins == 0) return;
  if (s.euler_difference == 0 && s.shell_difference == 0) {
    report.note(
        "{} arcs, {} circles and {} places where curves all but touch were made points: "
        "where surfaces touch in them, triangles of both meet and count as "
        "self-intersections",
        s.points, s.contacts, s.joins);
    return;
  }
  report.notes.push_back(
      fmt::format("the mesh has not the topology of the union: Euler characteristic {:+d}, closed "
                  "surfaces {:+d}; "
                  "arcs up to {:g} and circles up to {:g} of the radius were made points ({} arcs, "
                  "{} circles, {} "
                  "places where curves all but touch)",
                  s.euler_difference, s.shell_difference, s.arc_size, s.circle_size, s.points,
                  s.contacts, s.joins));
}

// Notes how many triangles stay below the least angle, if one was asked for, and how many angles
// stay below their floors.
void note_small_angles(const ExactMeshStats& s, Report& report) {
  constexpr const char* kWhy = "edges would have to be shorter than the limits allow";
  if (s.below_min_angle > 0) {
    const bool is_one = s.below_min_angle == 1;
    report.note("{} {} an angle below --min-angle and {} not near a sharp corner: {}",
                s.below_min_angle, is_one ? "triangle has" : "triangles have",
                is_one ? "is" : "are", kWhy);
  }
  if (const std::uint64_t below = s.below_floor.value_or(0)) {
    report.note("before subdivision {} below 5°, or below half of the exact angle at a corner: {}",
                below == 1 ? "1 angle is" : fmt::format("{} angles are", below), kWhy);
  }
}

// The crease-exact mesher and the refiner, each on the backend asked for.
IndexedMesh mesh_crease_exact(const SphereSet& spheres, const SurfaceOptions& surface,
                              const RefineOptions& refine, Report& report) {
  report.parameters = describe_parameters(surface, std::nullopt, refine.memory_limit);
  const ExactMeshOptions options = exact_mesh_options(surface, refine.memory_limit, refine.monitor);
  ExactMesh exact = make_exact_mesher(report.backend->requested)->mesh(spheres, options);
  account_for_fallback(exact.fallback, report);
  describe_exact_mesh(exact.stats, report);
  if (refine.subdivisions == 0) return std::move(exact.mesh);
  RefineResult refined =
      make_refiner(report.backend->requested)->refine(spheres, exact.mesh, refine);
  account_for_fallback(refined.fallback, report);
  report.timing.refine = refined.seconds;
  report.mesh->projection = std::move(refined.levels);
  return std::move(refined.mesh);
}

}  // namespace

ParametersReport describe_parameters(const SurfaceOptions& surface,
                                     const std::optional<GridSpec>& grid,
                                     std::uint64_t memory_limit) {
  ParametersReport report;
  report.surface = surface;
  report.grid = grid;
  report.memory_limit = memory_limit;
  if (!grid || surface.field.kind == FieldKind::vdw) return report;
  const FieldModel model = make_field_model(surface.field, *grid);
  report.isovalue = model.isovalue;
  if (surface.field.kind == FieldKind::blinn && surface.field.preset == FieldPreset::radius_aware) {
    // 2 is the default of FieldOptions::blobbiness.
    report.blobbiness = surface.field.blobbiness.value_or(2);
  }
  return report;
}

RefineOptions refine_options(const SurfaceOptions& surface, const Session& session) {
  RefineOptions refine;
  refine.subdivisions = surface.subdivisions;
  refine.projection = surface.projection;
  refine.crossings = surface.crossings;
  refine.field = surface.field;
  refine.memory_limit = session.machine.memory_limit;
  refine.monitor = session.monitor;
  return refine;
}

ExactMeshOptions exact_mesh_options(const SurfaceOptions& surface, std::uint64_t memory_limit,
                                    Monitor* monitor) {
  ExactMeshOptions options;
  options.edge_length = surface.edge_length.value_or(options.edge_length);
  options.edge_lengths = surface.edge_lengths;
  options.min_angle = surface.min_angle.value_or(0);
  options.memory_limit = memory_limit;
  options.monitor = monitor;
  return options;
}

void describe_exact_mesh(const ExactMeshStats& stats, Report& report) {
  report.timing.extract = stats.seconds;
  report.mesh.emplace();
  report.mesh->arrangement = stats;  // the report's word for what the crease-exact mesher did
  note_points(stats, report);
  note_small_angles(stats, report);
}

// Tells why no device is used only if the choice was automatic; who asks for the CPU knows why.
BackendReport describe_backend(Backend requested, Backend used) {
  BackendReport report;
  report.requested = requested;
  report.used = used;
  report.threads = cpu_threads();
  if (used == Backend::cpu && requested != Backend::automatic) return report;
  const DeviceList list = cuda_devices();
  if (used == Backend::cpu) {
    report.reason = list.reason;
  } else if (!list.devices.empty()) {
    report.device = list.devices.front().name;
    report.driver = list.devices.front().driver;
  }
  return report;
}

void account_for_fallback(const std::string& fallback, Report& report) {
  if (fallback.empty()) return;
  report.notes.push_back(fallback);
  report.backend->used = Backend::cpu;
  report.backend->devices = 0;
  report.backend->reason = fallback;
}

void describe_input(Molecule& molecule, const InputOptions& options, Session& session) {
  Report& report = session.report;
  report.input = input_of(molecule, options);
  report.notes.insert(report.notes.end(), molecule.notes.begin(), molecule.notes.end());
  if (const std::string remark = remark_on_probe(options.probe, Door::program); !remark.empty())
    report.notes.push_back(remark);
  report.warnings.insert(report.warnings.end(), molecule.warnings.begin(), molecule.warnings.end());
}

ReadOptions read_options(const InputOptions& options, const Session& session) {
  ReadOptions read = options.read;
  read.memory_limit = session.machine.memory_limit;
  return read;
}

Molecule load_molecule(const InputOptions& options, Session& session) {
  const ReadOptions read = read_options(options, session);
  Molecule molecule = options.sample.empty() ? read_structure(options.path, read)
                                             : read_sample(options.sample, read);
  describe_input(molecule, options, session);
  session.end_stage(&Timing::read);
  return molecule;
}

Structure load(const InputOptions& options, Session& session) {
  Molecule molecule = load_molecule(options, session);
  SphereSet spheres = to_spheres(molecule, options.probe);
  session.end_stage(&Timing::read);  // adds to the time of load_molecule()
  return {std::move(molecule), std::move(spheres)};
}

// share_devices(0) makes the first usable device current, which starts it. If no device was asked
// for, only large crease-exact meshes are made on one, and the size is not known yet; so for these
// none is started.
std::future<void> start_device(const MachineOptions& machine, const SurfaceOptions& surface) {
  const bool is_asked_for = machine.backend == Backend::cuda;
  const bool is_likely =
      machine.backend == Backend::automatic && surface.mesher == Mesher::marching_cubes;
  if (!is_asked_for && !is_likely) return {};
  return std::async(std::launch::async, [] {
    try {
      share_devices(0);
    } catch (const std::exception&) {
      // The main thread meets the same failure, and says so.
    }
  });
}

IndexedMesh make_mesh_untimed(const SphereSet& spheres, const SurfaceOptions& surface,
                              Session& session, const WantedMesh& request) {
  Report& report = session.report;
  const Backend requested = session.machine.backend;
  report.backend = describe_backend(requested, resolve(requested));
  report.notes.insert(report.notes.end(), surface.notes.begin(), surface.notes.end());
  report.backend->devices = devices_for(surface, session);
  RefineOptions refine = refine_options(surface, session);
  refine.on_level = request.on_level;
  refine.normals = request.normals;
  refine.half_edges_up_to = request.half_edges_up_to;
  return surface.mesher == Mesher::exact ? mesh_crease_exact(spheres, surface, refine, report)
                                         : mesh_field(spheres, surface, request, refine, report);
}

IndexedMesh make_mesh(const SphereSet& spheres, const SurfaceOptions& surface, Session& session,
                      const WantedMesh& request) {
  IndexedMesh mesh = make_mesh_untimed(spheres, surface, session, request);
  Report& report = session.report;
  // The time that record_levels() took is of a stage of its own, Timing::levels.
  const StageTime lap = session.clock.lap();
  const StageTime observed = report.timing.levels.value_or(StageTime{});
  report.timing.mesh = StageTime{lap.wall - observed.wall, lap.cpu - observed.cpu};
  return mesh;
}

// Levels are examined as they come, because the refinement does not keep them. The last level is
// the finished mesh, which measure() examines; add_last_level() then appends its figures.
LevelObserver record_levels(SelfIntersections wanted, int last, std::vector<LevelReport>& levels,
                            Session& session) {
  return [=, &levels, &session](int level, const IndexedMesh& mesh) {
    if (level == last) return;
    LapClock clock;
    LevelReport record{examine(mesh), level, {}};
    if (wanted == SelfIntersections::count) {
      record.self_intersections =
          self_intersections(mesh, nullptr, edges_of(record.topology), grid_of(session.report));
    }
    levels.push_back(record);
    add(session.report.timing.levels, clock.lap());
  };
}

void add_last_level(int last, std::vector<LevelReport>&& levels, MeshReport& mesh) {
  mesh.levels = std::move(levels);
  if (mesh.levels.empty()) return;  // no levels were recorded
  // The base class of the report: what measure() found of the finished mesh.
  const MeshExamination& examined = mesh;
  mesh.levels.push_back({examined, last, mesh.self_intersections});
}

std::uint64_t most_checked_with_cgal(CgalCheck wanted) {
  switch (wanted) {
    case CgalCheck::run:
      return std::numeric_limits<std::uint64_t>::max();
    case CgalCheck::small_meshes:
      return kCgalMeasuresLimit;
    case CgalCheck::skip:
      break;
  }
  return 0;
}

bool checks_with_cgal(CgalCheck wanted, std::uint64_t triangles) {
  return wanted != CgalCheck::skip && triangles <= most_checked_with_cgal(wanted);
}

void check_with_cgal(const IndexedMesh& mesh, CgalCheck check, Session& session) {
  Report& report = session.report;
  if (check == CgalCheck::skip) return;
  if (!checks_with_cgal(check, mesh.triangle_count())) {
    report.note(
        "area and volume were not checked by CGAL: more than {} triangles "
        "(--cgal-check on)",
        kCgalMeasuresLimit);
    return;
  }
  const MeshTopology& topology = report.mesh->topology;
  if (!topology.manifold || !topology.oriented) {
    report.note("area and volume were not checked by CGAL: the mesh is no oriented 2-manifold");
    return;
  }
  report.mesh->cgal = cgal_measures(to_surface_mesh(mesh));
  session.end_stage(&Timing::cgal_check);
}

std::optional<GridSpec> grid_of(const Report& report) {
  return report.parameters ? report.parameters->grid : std::nullopt;
}

void examine_untimed(const IndexedMesh& mesh, Session& session) {
  begin_stage(session.monitor, "measure", 1);
  if (!session.report.mesh) session.report.mesh.emplace();
  static_cast<MeshExamination&>(*session.report.mesh) = examine(mesh);
  advance(session.monitor, 1);
}

void self_intersections_untimed(const IndexedMesh& mesh, Session& session) {
  MeshReport& report = *session.report.mesh;
  report.self_intersections =
      self_intersections(mesh, session.monitor, edges_of(report.topology), grid_of(session.report));
}

void measure(const IndexedMesh& mesh, SelfIntersections wanted, Session& session) {
  examine_untimed(mesh, session);
  session.end_stage(&Timing::measure);
  if (wanted == SelfIntersections::skip) return;
  self_intersections_untimed(mesh, session);
  session.end_stage(&Timing::self_intersections);
}

void write_atom_file(const std::string& path, const Molecule& molecule, const AtomColumns& figures,
                     VerbSession& session) {
  const auto& [name, values] = figures.front();
  const auto without = std::ranges::count_if(values, [](double x) { return std::isnan(x); });
  if (without > 0) {
    session.report.note("{} atoms have no {}: their B factors are -1.00 in PDB, ? in mmCIF",
                        without, name);
  }
  session.end_progress();
  write_output(path, find_atom_writer(path)(molecule, figures));
  session.end_stage(&Timing::write);
}

std::vector<RgbColor> element_colors(const Molecule& molecule) {
  std::vector<RgbColor> colors;
  colors.reserve(molecule.atoms.size());
  for (const Atom& atom : molecule.atoms) colors.push_back(element_color(atom.element));
  return colors;
}

}  // namespace vdwmesh::apps
