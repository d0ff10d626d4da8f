// What several options decide together: checks of what goes together, and values that follow from
// others. Each function settles one part of the options. They run when every value has been read,
// so that the order on the command line does not matter.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <system_error>

#include "command_line/option_list.hpp"
#include "core/letters.hpp"
#include "creases/exact_mesher.hpp"
#include "excluded/excluded_measures.hpp"
#include "memory.hpp"
#include "mesh/mesh_io.hpp"
#include "named_files.hpp"
#include "refuse.hpp"
#include "render/renderer.hpp"
#include "structure/radii.hpp"
#include "structure/reader.hpp"

namespace vdwmesh::apps {
namespace {

// The first of the names that was given; empty where none was.
std::string first_given(const Draft& d, std::initializer_list<const char*> names) {
  for (const auto& [given, group] : d.given) {
    if (std::ranges::count(names, given) > 0) return given;
  }
  return {};
}

bool is_given(const Draft& d, const char* name) { return !first_given(d, {name}).empty(); }

// A parameter that a field does not have would be silently without effect.
void settle_field(const FieldOptions& field) {
  const bool of_union = field.kind == FieldKind::vdw;
  refuse_if(of_union && field.preset != FieldPreset::radius_aware,
            "--preset {}: is of the blended fields; add --field blinn, soft or inverse-squared",
            name_of(field.preset));
  refuse_if(of_union && field.isovalue,
            "--isovalue: --field vdw has none; add --field blinn, soft or inverse-squared");
  refuse_if(field.blobbiness && field.kind != FieldKind::blinn,
            "--blobbiness: --field {} has none; add --field blinn", name_of(field.kind));
}

// The option that asks for marching cubes without naming them: only they have a grid and fields
// other than the union. Empty where none does.
std::string option_of_marching_cubes(const Draft& d) {
  const bool is_union = d.options.surface.field.kind == FieldKind::vdw;
  const std::string of_field = is_union ? "" : first_given(d, {"--field"});
  return of_field.empty() ? first_given(d, {"--preset", "--spacing", "--padding"}) : of_field;
}

// The crease-exact mesher has neither field nor grid. It is what people get who ask for neither,
// but from several processes: each of these arranges all balls, which limits how many there may be.
void settle_mesher(Draft& d) {
  SurfaceOptions& s = d.options.surface;
  const std::string of_cubes = option_of_marching_cubes(d);
  const std::string of_edges =
      first_given(d, {"--edge-length", "--relative-edge", "--edge-length-of", "--edge-lengths"});
  const bool is_exact = of_cubes.empty() && (d.verb != kRanksMesh || !of_edges.empty());
  s.mesher = d.mesher.value_or(is_exact ? Mesher::exact : Mesher::marching_cubes);
  s.mesher_reason = is_given(d, "--mesher")            ? "--mesher"
                    : d.mesher                         ? "--surface"
                    : is_exact && d.verb == kRanksMesh ? of_edges
                    : of_cubes.empty()                 ? "default"
                                                       : of_cubes;
  const bool exact = s.mesher == Mesher::exact;
  const std::string of_grid = first_given(d, {"--spacing", "--padding"});
  refuse_if(!exact && !of_edges.empty(),
            "{}: is of --mesher exact; marching cubes, which {} asks for, takes --spacing instead",
            of_edges, s.mesher_reason);
  refuse_if(!exact && s.min_angle,
            "--min-angle: is of --mesher exact; marching cubes, which {} asks for, bound no angles",
            s.mesher_reason);
  refuse_if(s.min_angle > kLargestMinAngle, "--min-angle {}: needs at most {} degrees",
            s.min_angle.value_or(0), kLargestMinAngle);
  const char* asked = s.kind == ExactSurface::excluded ? "--surface excluded" : "--mesher exact";
  refuse_if(exact && s.field.kind != FieldKind::vdw,
            "--field {}: {} is of the spheres themselves, which is --field vdw",
            name_of(s.field.kind), asked);
  refuse_if(exact && !of_grid.empty(), "{}: {} has no grid; --edge-length sets the size", of_grid,
            asked);
}

// Meshes of marching cubes are projected once before they are looked at or measured, because their
// vertices lie on edges of the grid's cells, where the surface is only near. Those of the exact
// mesher lie on the surface.
void settle_levels(Draft& d) {
  if (is_given(d, "--subdivide") || !(d.verb & (kReport | kRender | kBatch))) return;
  d.options.surface.subdivisions = d.options.surface.mesher == Mesher::marching_cubes ? 1 : 0;
}

// Projection follows a subdivision. A default that is without effect is nothing to speak of; where
// it was asked for, a note says so.
void settle_projection(Draft& d) {
  SurfaceOptions& s = d.options.surface;
  const bool of_union = s.field.kind == FieldKind::vdw;
  Projection projection = d.projection.value_or(of_union ? Projection::vdw : Projection::field);
  // The field of --field vdw is the union itself.
  if (of_union && projection == Projection::field) projection = Projection::vdw;
  if (s.subdivisions > 0) {
    s.projection = projection;
  } else if (d.projection && projection != Projection::none) {
    s.notes.push_back(fmt::format(
        "--project {} has no effect with --subdivide 0: projection follows a subdivision",
        name_of(*d.projection)));
  }
}

// Meshes along the creases, and meshes whose vertices do not move, are not searched for crossings.
// Ranks don't search any, and so do not make the mesh that the default of the other verbs makes.
void settle_crossings(Draft& d) {
  SurfaceOptions& s = d.options.surface;
  refuse_if(d.verb == kRanksMesh && s.looks_for_crossings() && s.crossings == Crossings::undo,
            "--subdivide {}: ranks do not look for triangles that cross; add --crossings allow, or "
            "--project none",
            s.subdivisions);
  if (!is_given(d, "--crossings") || s.looks_for_crossings()) return;
  s.notes.push_back(fmt::format(
      "--crossings {} has no effect {}: crossings are looked for where a projection moves vertices",
      name_of(s.crossings),
      s.mesher == Mesher::exact ? "with --mesher exact"
      : s.subdivisions == 0     ? "with --subdivide 0"
                                : "with --project none"));
}

// The excluded surface has one mesher, whose edges are all alike. Its meshes are refined to the
// patches without a choice.
void settle_excluded_mesh(Draft& d) {
  if (!(d.verb & (kMesh | kReport | kRender))) return;
  refuse_if(d.mesher == Mesher::marching_cubes,
            "--mesher {}: --surface excluded is meshed along its curves, which is --mesher exact",
            name_of(Mesher::marching_cubes));
  d.mesher = Mesher::exact;
  const std::string other =
      first_given(d, {"--relative-edge", "--edge-length-of", "--edge-lengths", "--min-angle",
                      "--project", "--crossings", "--devices"});
  refuse_if(!other.empty(), "{}: does not go with --surface excluded; leave one of them out",
            other);
}

// The meshers are told apart only by verbs that make one mesh; a study sweeps over both.
void settle_surface(Draft& d) {
  SurfaceOptions& s = d.options.surface;
  s.kind = d.options.exact.surface;
  if (s.kind == ExactSurface::excluded) settle_excluded_mesh(d);
  if (s.grading.relative && !is_given(d, "--edge-length")) s.edge_length.reset();
  settle_field(s.field);
  if (d.verb & (kMesh | kReport | kRender | kBatch | kRanksMesh)) settle_mesher(d);
  settle_levels(d);
  s.grid = preset_grid(s.field.preset, d.spacing, d.padding);
  settle_projection(d);
  settle_crossings(d);
}

// Whether the file has the model is known when it is read; that this is no number is known now.
void check_model(const std::string& model) {
  const bool is_number = !model.empty() && model.size() < 10 &&
                         model.find_first_not_of("0123456789") == std::string::npos;
  refuse_if(model != "first" && model != "all" && !is_number,
            "--model {}: needs a model number of the file, first or all", model);
}

// Papers write the names of sets with capitals. Files among the parts are inputs.
void settle_radii(Draft& d) {
  if (d.read.radii.empty()) return;
  std::vector<std::string> parts = RadiusTable::parts_of(d.read.radii);
  for (std::string& part : parts) {
    const auto is_set = [](const std::string& name) {
      return std::ranges::count(RadiusTable::names(), name) > 0;
    };
    std::error_code error;
    if (is_set(lower_case(part)) && !std::filesystem::exists(part, error)) part = lower_case(part);
    if (!is_set(part)) d.files.add_input("--radii", part);
  }
  d.read.radii = fmt::format("{}", fmt::join(parts, ","));
}

// The thesis took ATOM records alone.
void settle_input(Draft& d) {
  check_model(d.read.model);
  settle_radii(d);
  const bool thesis = d.options.surface.field.preset != FieldPreset::radius_aware;
  d.read.hetero_atoms = d.hetero_atoms.value_or(thesis ? Inclusion::drop : Inclusion::keep);
  refuse_if(d.verb != kBatch && std::ranges::count(d.paths, "-") > 0 &&
                d.read.format == StructureFormat::by_extension,
            "INPUT -: standard input needs --format pdb, mmcif, bcif, pqr or xyzr");
  for (const std::string& path : d.paths) d.options.inputs.push_back({path, "", d.read, d.probe});
  for (const std::string& sample : d.samples) {
    d.options.inputs.push_back({"", sample, d.read, d.probe});
  }
  refuse_if(d.options.inputs.size() > 1 && !(d.verb & (kSeveralInputs | kBatch)),
            "--sample: takes one structure here; name ubiquitin or bpti");
}

// Whether triangles are coloured by a number.
bool shows_values(std::optional<ColorBy> color) {
  return color == ColorBy::distance || color == ColorBy::angle ||
         color == ColorBy::mean_curvature || color == ColorBy::gaussian_curvature;
}

// A mesh file is drawn as it is: what is said about structures would be lost on it.
void settle_render(const Draft& d) {
  if (d.verb != kRender) return;
  const std::optional<ColorBy> color = d.options.picture.color;
  const bool excluded = d.options.surface.kind == ExactSurface::excluded;
  refuse_if(color && is_of_patches(*color) && !excluded,
            "--color: patches and their curvatures are those of --surface excluded");
  refuse_if(color == ColorBy::distance && excluded,
            "--color distance: is measured to the boundary of the balls; leave out --surface "
            "excluded");
  const bool of_mesh = !d.paths.empty() && find_mesh_format(d.paths.front());
  const std::string of_values = first_given(d, {"--color-map", "--color-range"});
  refuse_if(!of_values.empty() && !shows_values(color),
            "{}: is of colours that show values; add --color angle{}", of_values,
            of_mesh    ? ""
            : excluded ? ", mean-curvature or gaussian-curvature"
                       : " or distance");
  if (!of_mesh) return;
  refuse_if(color == ColorBy::element || color == ColorBy::distance,
            "--color: a mesh file has no atoms; vdwmesh compare MESH INPUT --picture FILE.png "
            "colours it by distance");
  for (const auto& [name, group] : d.given) {
    const bool of_structures = group == kInputGroup || group == kSurfaceGroup;
    refuse_if(name != "INPUT" && of_structures,
              "{}: is of structures; {} is a mesh, which is drawn as it is", name, d.paths.front());
  }
}

// Arcs are quicker, and know no more of the topology than counts. A certificate needs the
// triangulation anyway. Ranks have the arcs alone.
void settle_exact(Draft& d) {
  ExactOptions& exact = d.options.exact;
  if (d.verb == kRanksExact) {
    refuse_if(d.topology == TopologyRequest::full,
              "--topology on: needs the triangulation, which one process makes (vdwmesh exact); "
              "ranks know counts and off");
    exact.method = UnionMethod::arcs;
    exact.topology = d.topology.value_or(TopologyRequest::counts);
    return;
  }
  const bool fast = d.verb == kBatch && d.options.batch.verb == BatchVerb::exact &&
                    d.method.value_or(UnionMethod::automatic) == UnionMethod::automatic;
  const TopologyRequest wanted =
      d.topology.value_or(fast ? TopologyRequest::none : TopologyRequest::full);
  exact.method = method_for(d.method.value_or(UnionMethod::automatic),
                            exact.certify == Switch::on ? TopologyRequest::full : wanted);
  const bool arcs = exact.method == UnionMethod::arcs;
  refuse_if(arcs && d.topology == TopologyRequest::full,
            "--topology on: needs the triangulation, which --method arcs does without; choose "
            "--method cgal or both");
  exact.topology = arcs ? d.topology.value_or(TopologyRequest::none) : wanted;
  refuse_if(!d.options.output.voids.empty() && exact.topology != TopologyRequest::full,
            "--voids: needs the whole topology; leave out {}",
            first_given(d, {"--topology", "--method", "--exact"}));
}

// The excluded surface has one method, and its probe does not make the atoms larger.
void settle_excluded(Draft& d) {
  if (d.options.exact.surface != ExactSurface::excluded) return;
  const std::string other = first_given(d, {"--method", "--certify", "--measure", "--voids"});
  refuse_if(!other.empty(), "{}: does not go with --surface excluded; leave one of them out",
            other);
  refuse_if(d.topology == TopologyRequest::counts,
            "--topology counts: --surface excluded knows on and off");
  const bool cuda = d.options.machine.backend == Backend::cuda;
  refuse_if(cuda && d.verb != kExact,
            "--backend cuda: meshes of the excluded surface are made and judged on the CPU; leave "
            "it out");
  refuse_if(cuda && d.topology == TopologyRequest::full,
            "--topology on: shells are found on the CPU; leave out --backend cuda");
  for (InputOptions& input : d.options.inputs) {
    if (!is_given(d, "--probe")) input.probe = kWaterProbe;
    refuse_if(!(input.probe > 0), "--probe {}: the excluded surface needs a radius above 0",
              input.probe);
  }
}

void settle_distances(const Draft& d) {
  const std::string of_samples = first_given(d, {"--samples", "--seed"});
  refuse_if(!of_samples.empty() && d.options.distances.distances == Switch::off,
            "{}: is of the distances; leave out --distances off", of_samples);
}

// Memory is looked up only where no limit was given: the figure changes from moment to moment.
void settle_machine(Draft& d) {
  MachineOptions& m = d.options.machine;
  refuse_if(m.backend == Backend::cpu && is_given(d, "--devices"),
            "--devices: says how many CUDA devices work; leave out --backend cpu");
  m.memory_limit = d.memory_limit ? *d.memory_limit : default_memory_limit(d.processes);
  if (m.verbosity == Verbosity::quiet) m.progress = Progress::never;
}

// The format of a mesh file follows from its name, before anything is computed for it.
void settle_output(const Draft& d) {
  const std::string& path = d.options.mesh_path;
  refuse_if(d.verb == kCompare && has_structure_extension(path),
            "MESH {}: is a structure; the mesh comes first: vdwmesh compare MESH INPUT", path);
  if (d.verb == kRanksMesh) {
    refuse_if(!is_vtkhdf(path) && find_mesh_format(path) != MeshFormat::ply,
              "-o {}: ranks write PLY or VTKHDF together; name a .ply or .vtkhdf file", path);
  } else if (!path.empty()) {
    mesh_format(path);
  }
  refuse_if(is_given(d, "--group") && !is_given(d, "--per-atom"),
            "--group: says how --per-atom FILE is grouped; add that");
}

// Where nothing can draw, that is said before any work.
void settle_picture(const Draft& d) {
  const std::filesystem::path path = d.options.picture.path;
  for (const auto& [name, group] : d.given) {
    refuse_if(group == kPictureGroup && path.empty(),
              "{}: says how --picture FILE is drawn; add that", name);
  }
  if (path.empty()) return;
  refuse_if(lower_case(path.extension().string()) != ".png",
            "{} {}: pictures are PNG; name a .png file", first_given(d, {"-o", "--picture"}),
            path.string());
  const Renderer available;
}

// Options of the mesh would be without effect where none is made.
void settle_batch_verb(const Draft& d) {
  if (d.options.batch.verb == BatchVerb::report) return;
  for (const auto& [name, group] : d.given) {
    const bool of_mesh = group == kSurfaceGroup || name == "--distances" || name == "--samples" ||
                         name == "--seed" || name == "--self-intersections" ||
                         name == "--cgal-check";
    refuse_if(of_mesh, "{}: is of --verb report; without it no mesh is made", name);
  }
}

// An archive on standard input can be read only once, and a shard needs to know how many structures
// there are.
void settle_batch(Draft& d) {
  BatchChoice& batch = d.options.batch;
  const bool has_standard_input = std::ranges::count(d.paths, "-") > 0;
  refuse_if(
      has_standard_input && batch.shard.count > 1,
      "--shard: standard input is not counted beforehand; name the list or archive as a file");
  refuse_if(std::ranges::count(d.paths, "-") > 1, "INPUT -: standard input can be read only once");
  if (batch.rows != RowFormat::by_extension) return;
  const std::string extension =
      lower_case(std::filesystem::path(batch.output).extension().string());
  const bool lines = extension == ".jsonl" || extension == ".ndjson" || extension == ".json";
  refuse_if(!batch.output.empty() && !lines && extension != ".csv",
            "-o {}: rows are .jsonl, .ndjson, .json or .csv; or say --rows", batch.output);
  batch.rows = extension == ".csv" ? RowFormat::csv : RowFormat::jsonl;
}

// Meshes of the excluded surface are told apart by edge length and subdivisions alone.
void settle_excluded_study(Draft& d) {
  StudyAxes& axes = d.options.study.axes;
  const std::string other = first_given(d, {"--spacing", "--field", "--project"});
  refuse_if(!other.empty(), "{}: does not go with --surface excluded; leave one of them out",
            other);
  refuse_if(is_given(d, "--mesher") && axes.meshers != std::vector{Mesher::exact},
            "--mesher: --surface excluded is meshed along its curves, which is --mesher exact");
  refuse_if(std::ranges::count(axes.backends, Backend::cuda) > 0,
            "--backend cuda: meshes of the excluded surface are made and judged on the CPU; leave "
            "it out");
  axes.meshers = {Mesher::exact};
  axes.backends = {Backend::cpu};
  axes.spacings.clear();
  axes.fields = {FieldKind::vdw};
  axes.projections = {StudyProjection::own};
}

// An axis of a mesher or projection that the study leaves out would be dropped.
void settle_axes(const Draft& d) {
  if (d.verb != kStudy) return;
  const StudyAxes& axes = d.options.study.axes;
  const auto has = [&](Mesher mesher) { return std::ranges::count(axes.meshers, mesher) > 0; };
  const std::string of_cubes = first_given(d, {"--spacing", "--field", "--project"});
  refuse_if(!of_cubes.empty() && !has(Mesher::marching_cubes),
            "{}: is of marching cubes; add marching-cubes to --mesher", of_cubes);
  refuse_if(is_given(d, "--edge-length") && !has(Mesher::exact),
            "--edge-length: is of the exact mesher; add exact to --mesher");
  refuse_if(is_given(d, "--project") && std::ranges::all_of(axes.subdivisions, std::logical_not()),
            "--project: follows a subdivision; add 1 to --subdivide");
}

// The axes of a study are in order whatever was typed, and so are its table and its page.
void settle_study(Draft& d) {
  StudyOptions& study = d.options.study;
  for (const char* name : {kStudyTable, kStudyDocument, kStudyPage}) {
    if (d.verb == kStudy) d.files.add_output_in("-o", study.folder, name);
  }
  std::ranges::sort(study.axes.spacings, std::greater());
  std::ranges::sort(study.axes.edge_lengths, std::greater());
  std::ranges::sort(study.axes.subdivisions);
  study.surface = d.options.exact.surface;
  if (study.surface == ExactSurface::excluded) {
    settle_excluded_study(d);
  } else {
    settle_axes(d);
  }
  study.distances = d.options.distances;
  study.self_intersections = d.options.self_intersections;
  study.machine = d.options.machine;
}

}  // namespace

// The surface comes first, because the preset decides which atoms are taken.
void settle(Draft& d) {
  settle_surface(d);
  settle_input(d);
  settle_exact(d);
  settle_excluded(d);
  settle_distances(d);
  settle_machine(d);
  settle_output(d);
  settle_render(d);
  settle_picture(d);
  settle_study(d);
  if (d.verb == kBatch) settle_batch_verb(d);
  if (d.verb == kBatch) settle_batch(d);
}

}  // namespace vdwmesh::apps
