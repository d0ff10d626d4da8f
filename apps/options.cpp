#include "options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "memory.hpp"
#include "parse.hpp"

namespace vdwmesh::apps {
namespace {

constexpr Choice<Mesher> kMeshers[] = {{"marching-cubes", Mesher::marching_cubes},
                                       {"exact", Mesher::exact}};
constexpr Choice<FieldKind> kFields[] = {{"vdw", FieldKind::vdw},
                                         {"blinn", FieldKind::blinn},
                                         {"soft", FieldKind::soft_object},
                                         {"inverse-squared", FieldKind::inverse_squared}};
constexpr Choice<FieldPreset> kPresets[] = {{"radius-aware", FieldPreset::radius_aware},
                                            {"thesis", FieldPreset::thesis},
                                            {"thesis-vdw", FieldPreset::thesis_vdw}};
constexpr Choice<Projection> kProjections[] = {
    {"vdw", Projection::vdw}, {"field", Projection::field}, {"none", Projection::none}};
constexpr Choice<Backend> kBackends[] = {
    {"auto", Backend::automatic}, {"cpu", Backend::cpu}, {"cuda", Backend::cuda}};
constexpr Choice<UnionMethod> kMethods[] = {
    {"cgal", UnionMethod::cgal}, {"arcs", UnionMethod::arcs}, {"both", UnionMethod::both}};
constexpr Choice<Switch> kSwitches[] = {{"on", Switch::on}, {"off", Switch::off}};
constexpr Choice<AtomGroup> kGroups[] = {
    {"atom", AtomGroup::atom}, {"residue", AtomGroup::residue}, {"chain", AtomGroup::chain}};
constexpr Choice<StructureFormat> kFormats[] = {
    {"pdb", StructureFormat::pdb}, {"mmcif", StructureFormat::mmcif},
    {"pqr", StructureFormat::pqr}, {"xyzr", StructureFormat::xyzr},
    {"ent", StructureFormat::pdb}, {"cif", StructureFormat::mmcif}};

void check_model(const std::string& model) {
  if (model == "first" || model == "all") return;
  try {
    parse_integer("--model", model, 0, 999'999'999);
  } catch (const InvalidInput&) {
    throw InvalidInput(
        fmt::format("--model {}: needs a model number of the file, first or all", model));
  }
}

void check_input_is_named(const std::string& path, const std::string& sample) {
  if (path.empty() && sample.empty()) {
    throw InvalidInput(
        "no INPUT: name a structure file (.pdb .ent .cif .mmcif .pqr .xyzr, each also .gz), - for "
        "standard input, or --sample ubiquitin");
  }
  if (!path.empty() && !sample.empty()) {
    throw InvalidInput(
        fmt::format("INPUT {} and --sample {}: give only one of them", path, sample));
  }
}

// Samples beyond this take hours even on a single atom.
double parse_samples(const std::string& text) {
  constexpr double kMostSamples = 1e6;  // per Å²
  const double samples = parse_number("--samples", text, Range::positive, "10");
  if (samples <= kMostSamples) return samples;
  throw InvalidInput(fmt::format("--samples {}: needs at most {} per Å²", text, kMostSamples));
}

Inclusion keep_unless(bool drop) { return drop ? Inclusion::drop : Inclusion::keep; }

}  // namespace

std::string_view mesher_name(Mesher mesher) { return name_of(mesher, kMeshers); }
std::string_view field_name(FieldKind kind) { return name_of(kind, kFields); }
std::string_view preset_name(FieldPreset preset) { return name_of(preset, kPresets); }
std::string_view projection_name(Projection projection) {
  return name_of(projection, kProjections);
}
std::string_view backend_name(Backend backend) { return name_of(backend, kBackends); }
std::string_view method_name(UnionMethod method) { return name_of(method, kMethods); }

Mesher mesher_of_name(std::string_view name, std::string_view option) {
  return choose(option, name, kMeshers);
}
FieldKind field_of_name(std::string_view name, std::string_view option) {
  return choose(option, name, kFields);
}
Projection projection_of_name(std::string_view name, std::string_view option) {
  return choose(option, name, kProjections);
}
Switch switch_of_name(std::string_view option, std::string_view name) {
  return choose(option, name, kSwitches);
}

Backend backend_of_name(std::string_view name, std::string_view option) {
  return choose(option, name, kBackends);
}

void InputFlags::add_to(CLI::App& verb, Inputs inputs) {
  const char* formats = ".pdb .ent .cif .mmcif .pqr .xyzr, each also .gz; - is standard input";
  const char* samples = "built-in structure in place of INPUT: ubiquitin, bpti";
  if (inputs == Inputs::one) {
    verb.add_option("INPUT", path_, formats);
    verb.add_option("--sample", sample_, samples);
  } else {
    verb.add_option("INPUT", paths_, formats);
    verb.add_option("--sample", samples_, samples)->delimiter(',')->allow_extra_args(false);
  }
  verb.add_option("--format", format_, "of INPUT where its name does not tell: pdb mmcif pqr xyzr");
  verb.add_option(
      "--radii", radii_,
      "bondi, alvarez, or a file of lines ELEMENT RADIUS or RESIDUE ATOM RADIUS [bondi]");
  verb.add_option("--probe", probe_, "added to every radius, Å [0]");
  verb.add_option("--model", model_, "model number, first, or all models as one set [first]");
  verb.add_option("--assembly", assembly_, "biological assembly of the file [asymmetric]");
  verb.add_option("--select", select_, "gemmi selection, after the water rule [everything]");
  verb.add_option("--altloc", altloc_, "alternate locations: highest, or a label [highest]");
  verb.add_flag("--waters", waters_, "keep waters");
  verb.add_flag("--no-hydrogens", no_hydrogens_, "drop hydrogens");
  CLI::Option* drop = verb.add_flag("--no-hetatm", no_hetatm_, "drop HETATM records");
  verb.add_flag("--hetatm", hetatm_, "keep HETATM records (default but for the thesis presets)")
      ->excludes(drop);
}

InputOptions InputFlags::resolve(NamedFiles& files, FieldPreset preset) const {
  check_input_is_named(path_, sample_);
  check_model(model_);
  InputOptions options;
  options.path = path_;
  options.sample = sample_;
  options.probe = parse_number("--probe", probe_, Range::finite, "1.4");
  options.read.format =
      format_.empty() ? StructureFormat::by_extension : choose("--format", format_, kFormats);
  if (path_ == "-" && format_.empty()) {
    throw InvalidInput("INPUT -: standard input needs --format pdb, mmcif, pqr or xyzr");
  }
  options.read.model = model_;
  options.read.assembly = assembly_;
  options.read.select = select_;
  options.read.waters = waters_ ? Inclusion::keep : Inclusion::drop;
  options.read.hydrogens = keep_unless(no_hydrogens_);
  const bool atom_records_only = preset != FieldPreset::radius_aware && !hetatm_;
  options.read.hetero_atoms = keep_unless(no_hetatm_ || atom_records_only);
  options.read.altloc = altloc_;
  options.read.radii = radii_;
  files.add_input("INPUT", path_);
  if (radii_ != "bondi" && radii_ != "alvarez") files.add_input("--radii", radii_);
  return options;
}

std::vector<InputOptions> InputFlags::resolve_all(NamedFiles& files) const {
  check_input_is_named(paths_.empty() && samples_.empty() ? "" : "given", "");
  std::vector<InputOptions> inputs;
  InputFlags one = *this;
  for (const std::string& path : paths_) {
    one.path_ = path;
    inputs.push_back(one.resolve(files));
  }
  one.path_.clear();
  for (const std::string& sample : samples_) {
    one.sample_ = sample;
    inputs.push_back(one.resolve(files));
  }
  return inputs;
}

void SurfaceFlags::add_to(CLI::App& verb, int default_subdivisions) {
  subdivide_ = std::to_string(default_subdivisions);
  verb.add_option("--mesher", mesher_,
                  "marching-cubes, or exact: crease-exact, one atom per triangle [marching-cubes]");
  verb.add_option("--edge-length", edge_length_, "of --mesher exact, Å [0.35]");
  verb.add_option("--field", field_, "vdw, blinn, soft or inverse-squared [vdw]");
  verb.add_option("--preset", preset_, "radius-aware, thesis or thesis-vdw [radius-aware]");
  verb.add_option("--spacing", spacing_, "grid spacing, Å [0.5; thesis presets 0.4]");
  verb.add_option("--padding", padding_, "grid beyond the box of the spheres, Å [3 spacings]");
  verb.add_option("--isovalue", isovalue_, "T of the blended fields [1]");
  verb.add_option("--blobbiness", blobbiness_, "B of --field blinn [2]");
  verb.add_option("--subdivide", subdivide_,
                  "midpoint subdivisions, Newton projection after each [" + subdivide_ + "]");
  verb.add_option("--project", project_,
                  "surface that vertices are moved to after a subdivision: vdw, field or none [as "
                  "--field]");
}

FieldOptions SurfaceFlags::resolve_field() const {
  FieldOptions field;
  field.kind = choose("--field", field_, kFields);
  field.preset = choose("--preset", preset_, kPresets);
  if (field.kind == FieldKind::vdw && field.preset != FieldPreset::radius_aware) {
    throw InvalidInput(fmt::format(
        "--preset {}: is of the blended fields; add --field blinn, soft or inverse-squared",
        preset_));
  }
  if (isovalue_) field.isovalue = parse_number("--isovalue", *isovalue_, Range::positive, "1");
  if (blobbiness_) {
    field.blobbiness = parse_number("--blobbiness", *blobbiness_, Range::positive, "2");
  }
  if (isovalue_ && field.kind == FieldKind::vdw) {
    throw InvalidInput(
        "--isovalue: --field vdw has none; add --field blinn, soft or inverse-squared");
  }
  if (blobbiness_ && field.kind != FieldKind::blinn) {
    throw InvalidInput(fmt::format("--blobbiness: --field {} has none; add --field blinn", field_));
  }
  return field;
}

// The crease-exact mesher has neither field nor grid.
void SurfaceFlags::resolve_mesher(SurfaceOptions& options) const {
  options.mesher = choose("--mesher", mesher_, kMeshers);
  if (options.mesher == Mesher::marching_cubes) {
    if (edge_length_) {
      throw InvalidInput(
          "--edge-length: is of --mesher exact; marching cubes takes --spacing instead");
    }
    return;
  }
  options.edge_length =
      parse_number("--edge-length", edge_length_.value_or("0.35"), Range::positive, "0.35");
  if (options.field.kind != FieldKind::vdw) {
    throw InvalidInput(fmt::format(
        "--field {}: --mesher exact meshes the union of the spheres, which is --field vdw",
        field_));
  }
  if (spacing_ || padding_) {
    throw InvalidInput(fmt::format("{}: --mesher exact has no grid; --edge-length sets the size",
                                   spacing_ ? "--spacing" : "--padding"));
  }
}

SurfaceOptions SurfaceFlags::resolve() const {
  SurfaceOptions options;
  options.field = resolve_field();
  resolve_mesher(options);
  std::optional<double> spacing, padding;
  if (spacing_) spacing = parse_number("--spacing", *spacing_, Range::positive, "0.5");
  if (padding_) padding = parse_number("--padding", *padding_, Range::non_negative, "1.5");
  options.grid = preset_grid(options.field.preset, spacing, padding);
  options.subdivisions =
      static_cast<int>(parse_integer("--subdivide", subdivide_, 0, kMaxSubdivisions));
  const bool union_surface = options.field.kind == FieldKind::vdw;
  Projection projection = union_surface ? Projection::vdw : Projection::field;
  if (project_) projection = choose("--project", *project_, kProjections);
  // The field of --field vdw is the union itself.
  if (union_surface && projection == Projection::field) projection = Projection::vdw;
  if (options.subdivisions > 0) {
    options.projection = projection;
  } else if (project_ && projection != Projection::none) {
    options.notes.push_back(fmt::format(
        "--project {} has no effect with --subdivide 0: projection follows a subdivision",
        *project_));
  }
  return options;
}

void ExactFlags::add_to(CLI::App& verb) {
  verb.add_option("--method", method_, "of the exact union: cgal, arcs or both [cgal]");
  verb.add_option("--topology", topology_, "exact topology, on or off [on; off with arcs]");
}

ExactOptions ExactFlags::resolve() const {
  ExactOptions options;
  if (topology_) options.topology = switch_of_name("--topology", *topology_);
  options.method = options.topology == Switch::off ? UnionMethod::arcs : UnionMethod::cgal;
  if (method_) options.method = choose("--method", *method_, kMethods);
  if (options.method == UnionMethod::arcs) {
    if (topology_ && options.topology == Switch::on) {
      throw InvalidInput(
          "--topology on: needs the triangulation, which --method arcs does without; choose "
          "--method cgal or both");
    }
    options.topology = Switch::off;
  }
  return options;
}

void DistanceFlags::add_to(CLI::App& verb) {
  verb.add_option("--distances", distances_, "between mesh and exact surface, on or off [on]");
  verb.add_option("--samples", samples_, "of --distances, per Å² [10]");
  verb.add_option("--seed", seed_, "of the samples [1]");
}

DistanceChoice DistanceFlags::resolve() const {
  DistanceChoice choice;
  choice.distances = switch_of_name("--distances", distances_);
  if (samples_) choice.samples_per_area = parse_samples(*samples_);
  if (seed_) {
    const std::int64_t seed = parse_integer("--seed", *seed_, 0, 4'294'967'295);
    choice.seed = static_cast<std::uint64_t>(seed);
  }
  if (choice.distances == Switch::off && (samples_ || seed_)) {
    throw InvalidInput(fmt::format("{}: is of the distances; leave out --distances off",
                                   samples_ ? "--samples" : "--seed"));
  }
  return choice;
}

void MachineFlags::add_to(CLI::App& verb, Backends backends) {
  if (backends == Backends::choose) {
    verb.add_option("--backend", backend_, "auto, cpu or cuda [auto]");
    verb.add_option("--devices", devices_, "CUDA devices that share an extraction [1]");
  }
  verb.add_option("--threads", threads_, "CPU threads [all]");
  verb.add_option("--memory-limit", memory_limit_,
                  "bytes, for example 8G; a run that needs more is refused [80 % of what is free]");
  CLI::Option* quiet = verb.add_flag("--quiet", quiet_, "no text on standard output, no progress");
  verb.add_flag("--progress", progress_, "progress bars even where standard error is no terminal")
      ->excludes(quiet);
}

MachineOptions MachineFlags::resolve() const {
  MachineOptions options;
  options.backend = choose("--backend", backend_, kBackends);
  if (devices_) options.devices = static_cast<int>(parse_integer("--devices", *devices_, 1, 64));
  if (devices_ && options.backend == Backend::cpu) {
    throw InvalidInput("--devices: says how many CUDA devices work; leave out --backend cpu");
  }
  if (threads_) options.threads = static_cast<int>(parse_integer("--threads", *threads_, 1, 4096));
  options.memory_limit =
      memory_limit_ ? parse_bytes("--memory-limit", *memory_limit_) : default_memory_limit();
  options.progress = progress_ ? Progress::always
                     : quiet_  ? Progress::never
                               : Progress::terminal_only;
  options.verbosity = quiet_ ? Verbosity::quiet : Verbosity::normal;
  return options;
}

void OutputFlags::add_to(CLI::App& verb, PerAtom per_atom) {
  verb.add_option("--json", json_, "the report as JSON into this file; - is standard output");
  if (per_atom == PerAtom::none) return;
  verb.add_option("--per-atom", per_atom_,
                  "CSV of radius, exact area, mesh area, exact volume; - is standard output");
  verb.add_option("--group", group_, "rows of --per-atom: atom, residue or chain [atom]");
}

OutputOptions OutputFlags::resolve(NamedFiles& files) const {
  OutputOptions options;
  options.json = json_;
  options.per_atom = per_atom_;
  if (group_) {
    options.group = choose("--group", *group_, kGroups);
    if (per_atom_.empty()) {
      throw InvalidInput("--group: says how --per-atom FILE is grouped, and needs it");
    }
  }
  files.add_output("--json", json_);
  files.add_output("--per-atom", per_atom_);
  return options;
}

}  // namespace vdwmesh::apps
