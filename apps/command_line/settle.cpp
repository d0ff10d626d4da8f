// What several options decide together: checks of what goes together, and values that follow from
// others. Each function settles one part of the options. They run when every value has been read,
// so that the order on the command line does not matter.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <utility>

#include "command_line/option_list.hpp"
#include "core/letters.hpp"
#include "mesh/mesh_io.hpp"
#include "named_files.hpp"
#include "render/renderer.hpp"
#include "report/atom_file.hpp"
#include "report/pockets/pocket_spheres.hpp"
#include "report/pockets/scan_plot.hpp"
#include "request/memory_limit.hpp"
#include "request/read_request.hpp"
#include "request/refuse.hpp"
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

// Where every process arranges all balls, marching cubes are usual; verbs that make no mesh of one
// mesher have them too.
void settle_mesh(Draft& d) {
  constexpr VerbSet of_either = kMesh | kReport | kRender | kBatch | kView;
  MeshRequest& m = d.mesh;
  m.surface = d.measure.surface;
  if (!(d.verb & of_either)) m.usual_mesher = Mesher::marching_cubes;
  if (d.verb & (kReport | kRender | kBatch)) m.subdivisions_of_cubes = 1;
  SurfaceOptions& s = d.options.surface;
  s = settle(m);
  refuse_if(s.kind == ExactSurface::excluded && is_given(d, "--devices") && (d.verb & of_either),
            "--devices: does not go with --surface ses; leave one of them out");
  refuse_if(d.verb == kRanksMesh && s.looks_for_crossings() && s.crossings == Crossings::undo,
            "--subdivide {}: ranks do not look for triangles that cross; add --crossings allow, or "
            "--project none",
            s.subdivisions);
}

// The thesis took ATOM records alone, and spheres as they are.
void settle_input(Draft& d) {
  for (const std::string& file : settle(d.read, Door::program)) d.files.add_input("--radii", file);
  const double probe = d.options.exact.probe;
  const bool thesis = d.options.surface.field.preset != FieldPreset::radius_aware;
  d.read.hetero_atoms =
      d.hetero_atoms.value_or(thesis ? Inclusion::drop_where_told : Inclusion::keep);
  refuse_if(d.verb != kBatch && std::ranges::count(d.paths, "-") > 0 &&
                d.read.format == StructureFormat::by_extension,
            "INPUT -: standard input needs --format pdb, mmcif, bcif, pqr, xyzr, gro, mol2, sdf "
            "or xyz");
  const std::string of_file = first_given(d, {"--format", "--units"});
  refuse_if(d.paths.empty() && !d.samples.empty() && !of_file.empty(),
            "{}: is of a file, and --sample has its own; leave it out", of_file);
  for (const std::string& path : d.paths) d.options.inputs.push_back({path, "", d.read, probe});
  for (const std::string& sample : d.samples) {
    d.options.inputs.push_back({"", sample, d.read, probe});
  }
  refuse_if(d.options.inputs.size() > 1 && !(d.verb & (kSeveralInputs | kBatch)),
            "--sample: takes one structure here; name ubiquitin or bpti");
}

// Whether triangles are coloured by a number.
bool shows_values(std::optional<ColorBy> color) {
  return color == ColorBy::distance || color == ColorBy::angle || color == ColorBy::hydropathy ||
         color == ColorBy::exposure || color == ColorBy::b_factor ||
         color == ColorBy::mean_curvature || color == ColorBy::gaussian_curvature;
}

// A mesh file is drawn as it is: what is said about structures would be lost on it.
void settle_render(const Draft& d) {
  if (d.verb != kRender) return;
  const std::optional<ColorBy> color = d.options.picture.color;
  const bool excluded = d.options.surface.kind == ExactSurface::excluded;
  refuse_if(color && is_of_patches(*color) && !excluded,
            "--color: patches and their curvatures are those of --surface ses");
  refuse_if(color == ColorBy::distance && excluded,
            "--color distance: is measured to the boundary of the balls; leave out --surface "
            "ses");
  const bool of_mesh = !d.paths.empty() && find_mesh_format(d.paths.front());
  const std::string of_values = first_given(d, {"--color-map", "--color-range"});
  refuse_if(!of_values.empty() && !shows_values(color),
            "{}: is of colours that show values; add --color angle{}", of_values,
            of_mesh    ? ""
            : excluded ? ", mean-curvature or gaussian-curvature"
                       : " or distance");
  if (!of_mesh) return;
  refuse_if(color && (is_of_atoms(*color) || color == ColorBy::distance),
            "--color: a mesh file has no atoms; vdwmesh compare MESH INPUT --picture FILE.png "
            "colours it by distance");
  for (const auto& [name, group] : d.given) {
    const bool of_structures = group == kInputGroup || group == kSurfaceGroup;
    refuse_if(name != "INPUT" && of_structures,
              "{}: is of structures; {} is a mesh, which is drawn as it is", name, d.paths.front());
  }
}

bool is_of_pockets(const Draft& d) {
  return d.verb == kPockets || (d.verb == kBatch && d.options.batch.verb == BatchVerb::pockets);
}

bool is_of_interfaces(const Draft& d) {
  return d.verb == kInterface || (d.verb == kBatch && d.options.batch.verb == BatchVerb::interface);
}

// Ranks have the arcs alone, and so have batches unless more is asked for.
void settle_exact(Draft& d) {
  MeasureRequest& m = d.measure;
  const bool of_ranks = d.verb == kRanksExact;
  refuse_if(of_ranks && m.topology == TopologyRequest::full,
            "--topology full: needs the triangulation, which one process makes (vdwmesh exact); "
            "ranks know counts and off");
  if (of_ranks)
    m.method = UnionMethod::arcs, m.topology = m.topology.value_or(TopologyRequest::counts);
  const bool fast = d.verb == kBatch && d.options.batch.verb == BatchVerb::exact &&
                    m.method.value_or(UnionMethod::automatic) == UnionMethod::automatic;
  const bool of_excluded = is_of_interfaces(d) && m.surface == SurfaceChoice::ses;
  if (is_of_interfaces(d) && is_given(d, "--surface"))
    refuse_if(
        m.surface == SurfaceChoice::vdw,
        "--surface vdw: balls without a probe bury nothing that a solvent sees; choose sas or "
        "ses");
  if (is_of_interfaces(d)) m.surface = SurfaceChoice::sas;
  if (fast) m.usual_topology = TopologyRequest::none;
  m.backend = d.options.machine.backend;
  d.options.exact = settle(m);
  if (of_excluded) d.options.exact.surface = ExactSurface::excluded;
  refuse_if(!d.options.output.voids.empty() && d.options.exact.topology != TopologyRequest::full,
            "--voids: needs the whole topology; leave out {}",
            first_given(d, {"--topology", "--method", "--exact"}));
  const bool of_depth = d.options.output.b_factor == AtomFigure::depth;
  refuse_if((of_depth || !d.options.output.depth.empty()) && !(d.options.exact.probe > 0),
            "{}: needs a probe; add --surface sas or --surface ses",
            of_depth ? "--b-factor depth" : "--depth");
  refuse_if(!d.options.output.gradient.empty() && is_given(d, "--measure"),
            "--gradient: is of the whole union; leave out --measure");
}

// What of the program does not go with the excluded surface, beside what its request refuses.
void settle_excluded(const Draft& d) {
  if (d.options.exact.surface != ExactSurface::excluded || is_of_interfaces(d)) return;
  const std::string other = first_given(d, {"--measure", "--voids", "--rsa"});
  refuse_if(!other.empty(), "{}: does not go with --surface ses; leave one of them out", other);
  refuse_if(d.options.output.b_factor == AtomFigure::exposure,
            "--b-factor exposure: does not go with --surface ses; add --surface sas");
  const bool cuda = d.options.machine.backend == Backend::cuda;
  refuse_if(cuda && d.verb != kExact,
            "--backend cuda: meshes of the excluded surface are made and judged on the CPU; leave "
            "it out");
  refuse_if(cuda && is_given(d, "--gradient"),
            "--gradient: of the excluded surface the CPU knows it; leave out --backend cuda");
  refuse_if(cuda && d.measure.topology == TopologyRequest::full,
            "--topology full: shells are found on the CPU; leave out --backend cuda");
}

// Shape complementarity is for who asks for it.
void settle_interface(Draft& d) {
  if (is_of_interfaces(d))
    d.options.distances.distances = is_given(d, "--samples") ? Switch::on : Switch::off;
  const bool rolls = d.options.exact.surface == ExactSurface::excluded || is_given(d, "--samples");
  refuse_if(is_of_interfaces(d) && rolls && !(d.options.exact.probe > 0),
            "--probe {}: {} needs one above 0", d.options.exact.probe,
            first_given(d, {"--samples", "--surface"}));
  if (d.verb == kInterface && d.read.groups.size() == 1)
    refuse("SIDE {}: an interface has two sides; name another one, or none for all chains",
           d.read.groups.front());
}

// `question`: the option that asks for something else than pockets, or empty.
void settle_pocket_meshes(const Draft& d, const std::string& question) {
  const std::string& path = d.options.output.pocket_meshes;
  refuse_if(d.verb == kPockets && path.empty() && is_given(d, "--edge-length"),
            "--edge-length: is of the pockets' meshes; add --mesh FILE.glb");
  if (path.empty()) return;
  const std::string beside = question.empty() && is_given(d, "--sums") ? "--sums" : question;
  refuse_if(!beside.empty(), "--mesh: is of exact pockets; leave out {}", beside);
  const auto format = find_mesh_format(path);
  refuse_if(!format || !holds_several_meshes(*format),
            "--mesh {}: several meshes with names go into .glb, .obj or .3mf", path);
}

// -o names a table, unless its extension is one of spheres or of plots.
void settle_pockets(Draft& d) {
  OutputOptions& o = d.options.output;
  const bool of_spheres = find_sphere_format(o.spheres).has_value(), of_plot = is_plot(o.spheres);
  const std::string question = first_given(d, {"--scan", "--shell", "--from"});
  refuse_if(!question.empty() && is_given(d, "--sums"), "--sums: is of pockets; leave out {}",
            question);
  refuse_if(of_plot && (question.empty() || is_given(d, "--shell")),
            "-o {}: plots are of --scan and --from; add one of them", o.spheres);
  refuse_if(of_spheres && is_given(d, "--shell"),
            "-o {}: a shell has no spheres; leave out --shell", o.spheres);
  refuse_if(of_spheres && is_given(d, "--sums"),
            "-o {}: spheres are those of exact pockets; leave out --sums", o.spheres);
  settle_pocket_meshes(d, question);
  if (of_spheres || of_plot) return;
  const std::string extension = lower_case(std::filesystem::path(o.spheres).extension().string());
  refuse_if(
      !extension.empty() && extension != ".csv",
      "-o {}: writes .csv, spheres as .pdb .pml .bild .mvsj, or a plot as .svg; --csv names a "
      "table as you like",
      o.spheres);
  refuse_if(!o.spheres.empty() && !o.csv.empty(), "--csv: -o names a table too; leave out one");
  if (!o.spheres.empty()) o.csv = std::exchange(o.spheres, "");
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
    const MeshFormat format = mesh_format(path);
    refuse_if(
        d.options.ascii == Switch::on && format != MeshFormat::ply && format != MeshFormat::stl,
        "--ascii: is of .ply and .stl files; the others have one form, .glb and .3mf binary");
  }
  const OutputOptions& o = d.options.output;
  refuse_if(!o.atoms.empty() && find_atom_writer(o.atoms) == nullptr,
            "--write {}: atoms are written as .pdb .ent .cif .mmcif", o.atoms);
  refuse_if(is_given(d, "--b-factor") && o.atoms.empty(),
            "--b-factor: is of the atoms that --write FILE names; add that");
  refuse_if(is_given(d, "--group") && !is_given(d, "--per-atom") && !is_given(d, "--depth"),
            "--group: says how --per-atom FILE is grouped; add that or --depth FILE");
}

void settle_view(const Draft& d) {
  const std::filesystem::path path = d.options.view.path;
  const std::string extension = lower_case(path.extension().string());
  refuse_if(d.verb == kView && extension != ".html" && extension != ".htm",
            "-o {}: a page is HTML; name a .html file", path.string());
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
  const bool of_interfaces = is_of_interfaces(d);
  refuse_if(is_given(d, "--sums") && !is_of_pockets(d), "--sums: is of --verb pockets; add that");
  const bool of_report = d.options.batch.verb == BatchVerb::report;
  refuse_if(of_report && d.measure.surface == SurfaceChoice::ses,
            "--surface ses: rows of --verb report are of other surfaces; leave one of them out");
  refuse_if(is_of_pockets(d) && is_given(d, "--surface"),
            "--surface: does not go with --verb pockets; leave it out");
  if (of_report) return;
  for (const auto& [name, group] : d.given) {
    const bool of_union = name == "--measure" || name == "--method" || name == "--topology";
    refuse_if((of_interfaces || is_of_pockets(d)) && of_union,
              "{}: does not go with --verb {}; leave it out", name, name_of(d.options.batch.verb));
    if (of_interfaces && (name == "--samples" || name == "--seed")) continue;
    if (name == "--surface") continue;
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
  refuse_if(!other.empty(), "{}: does not go with --surface ses; leave one of them out", other);
  refuse_if(is_given(d, "--mesher") && axes.meshers != std::vector{Mesher::exact},
            "--mesher: --surface ses is meshed along its curves, which is --mesher exact");
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
  const std::filesystem::path folder = study.folder;
  const std::string extension = lower_case(folder.extension().string());
  refuse_if(
      d.verb == kStudy && (extension == ".html" || extension == ".csv" || extension == ".json"),
      "-o {}: a study is a folder of a page and tables; name a folder, such as {}", folder.string(),
      folder.stem().string());
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

// The surface comes first, because the preset decides which atoms are taken. Pockets are those of
// the accessible surface.
void settle(Draft& d) {
  if (is_of_pockets(d)) d.measure.surface = SurfaceChoice::sas;
  settle_mesh(d);
  settle_exact(d);
  settle_input(d);
  settle_excluded(d);
  settle_interface(d);
  settle_pockets(d);
  settle_distances(d);
  settle_machine(d);
  settle_output(d);
  settle_view(d);
  settle_render(d);
  settle_picture(d);
  settle_study(d);
  if (d.verb == kBatch) settle_batch_verb(d);
  if (d.verb == kBatch) settle_batch(d);
}

}  // namespace vdwmesh::apps
