// The list itself: one entry says what an option is called, which verbs take it, where its value
// goes and how it is read, what it is for, and what holds without it. An option whose value or
// default differs between verbs has several entries. Whoever adds an option adds it here and to
// docs/options.md.
#include "command_line/option_list.hpp"

#include <fmt/format.h>

#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

constexpr VerbSet kInputs = kOneInput | kSeveralInputs;
constexpr VerbSet kOneSurface = kMesh | kReport | kRender;
constexpr VerbSet kSurfaces = kOneSurface | kBatch;  // with --verb report
constexpr VerbSet kGrids = kSurfaces | kRanksMesh;   // marching cubes
constexpr VerbSet kDistances = kReport | kCompare | kStudy | kBatch;
constexpr VerbSet kPictures = kReport | kCompare | kRender;
constexpr VerbSet kExcluded =
    kExact | kMesh | kReport | kCompare | kRender | kStudy | kView | kBatch;
constexpr VerbSet kReports = kMesh | kReport | kExact | kCompare | kPockets;

constexpr const char* kFormats =
    ".pdb .ent .pdbqt .cif .mmcif .bcif .pqr .xyzr .gro .mol2 .sdf .mol .xyz, each also .gz; - is "
    "standard input";
constexpr const char* kNameInput =
    "name a structure file (.pdb .ent .pdbqt .cif .mmcif .bcif .pqr .xyzr .gro .mol2 .sdf .mol "
    ".xyz, each also .gz), - for standard input, or --sample ubiquitin";

// Selections in order; an atom may be in one of them only.
Reader sides(ReadOptions& read) {
  const auto add = [&read](std::string_view, const std::string& selection) {
    read.groups.push_back(selection);
    read.shared_atoms = SharedAtoms::refused;
  };
  return {"", "", add, Use::none, Times::often};
}

// The places of all inputs, one by one.
Reader inputs(std::vector<std::string>& paths, Times times) {
  return {"", "", [&](std::string_view, const std::string& path) { paths.push_back(path); },
          Use::reads, times};
}

Kind<double> density() {
  return {"N", "", [](std::string_view option, const std::string& text) {
            return checked_samples(parse_number(option, text, Range::positive, "10"), text,
                                   Door::program);
          }};
}

Shard parse_shard(std::string_view option, const std::string& text) {
  constexpr std::int64_t kMost = 1'000'000'000;
  const std::size_t slash = text.find('/');
  refuse_if(slash == text.npos, "{} {}: needs I/N, for example 1/8", option, text);
  Shard shard;
  shard.count = static_cast<std::uint64_t>(parse_integer(option, text.substr(slash + 1), 1, kMost));
  shard.number = static_cast<std::uint64_t>(
      parse_integer(option, text.substr(0, slash), 1, static_cast<std::int64_t>(shard.count)));
  return shard;
}

// "0.8:3.0"
Reader probe_range(std::optional<std::array<double, 2>>& range) {
  const auto read = [&range](std::string_view option, const std::string& text) {
    const std::size_t colon = text.find(':');
    refuse_if(colon == text.npos, "{} {}: needs LO:HI, for example 0.8:3.0", option, text);
    range = {parse_number(option, text.substr(0, colon), Range::finite, "0.8"),
             parse_number(option, text.substr(colon + 1), Range::finite, "3.0")};
  };
  return {"LO:HI", "", read, Use::none, Times::once};
}

// A value of pictures that fills more than one field.
using ReadPicture = void (*)(std::string_view, const std::string&, PictureOptions&);
Reader of_picture(PictureOptions& picture, std::string value, ReadPicture read_value,
                  std::vector<std::string_view> words = {}) {
  return {std::move(value),
          "",
          [&picture, read_value](std::string_view option, const std::string& name) {
            read_value(option, name, picture);
          },
          Use::none,
          Times::once,
          std::move(words)};
}

// "A/10-40=0.2". The selection may have commas, so each is given by itself; it ends at the last =.
Reader lengths_of_selections(Draft& d) {
  const auto read = [&d](std::string_view option, const std::string& text) {
    const std::size_t equals = text.rfind('=');
    refuse_if(equals == text.npos || equals == 0,
              "{} {}: needs a selection and a length, such as A/10-40=0.2", option, text);
    const double length =
        parse_number(option, text.substr(equals + 1), Range::positive, "A/10-40=0.2");
    d.read.groups.push_back(text.substr(0, equals));
    d.mesh.grading.of_groups.push_back(length);
    d.mesh.grading.groups.push_back(text);
  };
  return {"SELECTION=Å", "", read, Use::none, Times::often};
}

// Which atoms there are, and how large they are.
std::vector<Option> input_options(Draft& d) {
  ReadOptions& r = d.read;
  const std::optional<Inclusion> keep = Inclusion::keep, drop = Inclusion::drop;
  const Kind<double> probe = number("Å", Range::finite, "1.4");
  return {
      {"MESH", kCompare, one(d.options.mesh_path, text(""), Use::reads),
       "mesh file: .ply .obj .off .stl or .glb",
       required("name a mesh file (.ply .obj .off .stl .glb), then INPUT")},
      {"INPUT", kOneInput & ~(kRender | kInterface), inputs(d.paths, Times::once), kFormats,
       required(kNameInput), "--sample"},
      {"INPUT", kInterface, inputs(d.paths, Times::once), kFormats,
       required("name a structure file, and the two sides if they are not chains")},
      {"INPUT", kRender, inputs(d.paths, Times::once),
       "structure: " + std::string(kFormats) + "; or a mesh: .ply .obj .off .stl .glb",
       required("name a structure file (.pdb .cif ...) or a mesh file (.ply .stl ...), or --sample "
                "ubiquitin"),
       "--sample"},
      {"SIDE", kInterface, sides(r),
       "two or more selections (as --select), such as A B or A/1-50 A/51-99",
       otherwise("all chains; those that touch")},
      {"INPUT", kSeveralInputs, inputs(d.paths, Times::often), kFormats, required(kNameInput),
       "--sample"},
      {"INPUT", kBatch, inputs(d.paths, Times::often),
       "structure files, folders, tar archives, and lists of names, one on each line; - is a list "
       "or an archive on standard input",
       required("name structure files, a folder, a tar archive or a list of names, or - for a list "
                "or an archive on standard input")},
      {"--sample", kInputs & ~kInterface, several(d.samples, text("NAME", {"ubiquitin", "bpti"})),
       "built-in structures in place of INPUT: ubiquitin, bpti"},
      {"--format", kStructures, one(r.format, named<StructureFormat>()),
       "of INPUT, where its name does not tell"},
      {"--units", kStructures, one(r.unit, named<LengthUnit>()),
       "of the coordinates in INPUT, where a program wrote others", otherwise("angstrom")},
      {"--radii", kStructures,
       one(r.radii, text("SET|FILE", {"bondi", "alvarez", "protor", "naccess", "oons"})),
       "bondi, alvarez; united atoms, without hydrogens: protor, naccess, oons; or a file of lines "
       "ELEMENT RADIUS or RESIDUE ATOM RADIUS; bondi,FILE: a set with lines of one's own",
       otherwise("bondi; those of PQR and XYZR")},
      {"--probe", kStructures & kExcluded, one(d.measure.probe, probe),
       "radius of a probe of solvent, 1.4 for water: added to every radius, or with --surface "
       "ses rolled over the atoms",
       otherwise("0; 1.4 with --surface sas or ses")},
      {"--probe", kInterface, one(d.measure.probe, probe),
       "radius of a probe of solvent, added to every radius", otherwise("1.4")},
      {"--probe", kPockets, one(d.measure.probe, probe),
       "radius of a probe of solvent, added to every radius: its centre is in the pockets",
       otherwise("1.4")},
      {"--probe", kStructures & ~(kExcluded | kInterface | kPockets), one(d.measure.probe, probe),
       "radius of a probe of solvent, 1.4 for water: added to every radius", otherwise("0")},
      {"--model", kStructures, one(r.model, text("N", {"first", "all"})),
       "model number, first, or all models as one set", by_default("first")},
      {"--assembly", kStructures, one(r.assembly, text("NAME", {"asymmetric"})),
       "biological assembly of the file, such as 1", by_default("asymmetric")},
      {"--select", kStructures, one(r.select, text("SELECTION")),
       "only these atoms, such as 'chain A and not hydrogen', 'resi 10-40', 'ligand', or in "
       "gemmi's syntax A/10-40/CA or (HEM); after the water rule",
       otherwise("everything")},
      {"--altloc", kStructures, one(r.altloc, text("LABEL", {"highest", "all"})),
       "alternate locations: highest (by occupancy), a label where there is one, or all at once",
       by_default("highest")},
      {"--waters", kStructures, flag(r.waters, Inclusion::keep), "keep waters"},
      {"--no-hydrogens", kStructures, flag(r.hydrogens, Inclusion::drop), "drop hydrogens"},
      {"--no-hetatm", kStructures, flag(d.hetero_atoms, drop), "drop HETATM records", no_default(),
       "--hetatm"},
      {"--hetatm", kStructures, flag(d.hetero_atoms, keep),
       "keep HETATM records; only the thesis presets drop them otherwise"}};
}

// What is meshed, and how.
std::vector<Option> surface_options(Draft& d) {
  MeshRequest& m = d.mesh;
  const auto length = [](const char* example) { return number("Å", Range::positive, example); };
  const Kind<int> levels = whole<int>(0, kMaxSubdivisions);
  const char *subdivide = "midpoint subdivisions; the new vertices move to the surface after each",
             *project = "surface that vertices are moved to after a subdivision";
  return {
      {"--surface", kExcluded, one(d.measure.surface, named<SurfaceChoice>()),
       "which one: the boundary of the balls, the accessible surface (the same with --probe 1.4), "
       "or the solvent-excluded one",
       by_default("vdw")},
      {"--surface", kInterface, one(d.measure.surface, named<SurfaceChoice>()),
       "sas, or ses: what is buried of the solvent-excluded surface as well, and the gap between "
       "the sides",
       otherwise("sas")},
      {"--mesher", kSurfaces | kRanksMesh, one(m.mesher, named<Mesher>()),
       "exact follows the creases, with one atom per triangle",
       otherwise(d.verb == kRanksMesh
                     ? "marching-cubes; exact with an edge length"
                     : "exact; marching-cubes with --spacing, --padding or a blended --field")},
      {"--edge-length", kSurfaces | kRanksMesh, one(m.edge_length, length("0.35")),
       "length of the mesh's edges; marching cubes take --spacing instead", otherwise("0.35")},
      {"--edge-length", kPockets, one(d.options.pocket_query.edge_length, length("0.35")),
       "length of the edges of meshes of pockets", otherwise("0.35")},
      {"--density", kOneSurface, one(m.density, number("per Å²", Range::positive, "2")),
       "triangles of --surface ses: any number, few good ones or many", no_default()},
      {"--max-distance", kOneSurface, one(m.max_distance, number("Å", Range::positive, "0.1")),
       "of --surface ses, in place of --density: the proven distance between mesh and surface",
       no_default()},
      {"--relative-edge", kSurfaces | kRanksMesh,
       one(m.grading.relative, number("N", Range::positive, "0.2")),
       "edge length as a share of the radius; beside --edge-length the shorter one holds",
       no_default()},
      {"--edge-length-of", kSurfaces | kRanksMesh, lengths_of_selections(d),
       "edge length of some atoms (as --select); the last one that names an atom holds",
       no_default()},
      {"--edge-lengths", kOneSurface | kRanksMesh, one(m.grading.table, text("FILE"), Use::reads),
       "table of --per-atom with a column edge_length, Å; an empty field leaves the atom to the "
       "other options",
       no_default()},
      {"--min-angle", kSurfaces, one(m.min_angle, number("DEG", Range::positive, "20")),
       "triangles have no smaller angle, up to 25, but at sharp corners of an atom's patch",
       no_default()},
      {"--field", kGrids, one(m.field, named<FieldKind>()), "what is meshed", by_default("vdw")},
      {"--preset", kGrids, one(m.preset, named<FieldPreset>()), "parameters of the blended fields",
       otherwise("radius-aware")},
      {"--spacing", kGrids, one(m.spacing, length("0.5")), "of the grid of marching cubes",
       otherwise("0.5; thesis presets 0.4")},
      {"--padding", kGrids, one(m.padding, number("Å", Range::non_negative, "1.5")),
       "grid beyond the box of the spheres", otherwise("3 spacings")},
      {"--isovalue", kGrids, one(m.isovalue, number("T", Range::positive, "1")),
       "of the blended fields", otherwise("1")},
      {"--blobbiness", kGrids, one(m.blobbiness, number("B", Range::positive, "2")),
       "of --field blinn", otherwise("2")},
      {"--subdivide", kMesh | kRanksMesh, one(m.subdivisions, levels), subdivide, otherwise("0")},
      {"--subdivide", kReport | kRender | kBatch, one(m.subdivisions, levels), subdivide,
       otherwise("0; 1 with marching cubes")},
      {"--project", kGrids, one(m.projection, named<Projection>()), project,
       otherwise("as --field")},
      {"--crossings", kGrids, one(m.crossings, named<Crossings>()),
       "moves of vertices after which triangles cross are taken back, or stay", otherwise("undo")}};
}

// The axes of a study: the options of a single mesh, each with several values.
std::vector<Option> axis_options(StudyAxes& a) {
  const Kind<double> length = number("Å", Range::positive, "1,0.5,0.25");
  return {{"--mesher", kStudy, several(a.meshers, named<Mesher>()), "meshers",
           by_default("marching-cubes,exact")},
          {"--edge-length", kStudy, several(a.edge_lengths, length),
           "edge lengths, of --mesher exact", by_default("0.7,0.35")},
          {"--spacing", kStudy, several(a.spacings, length), "grid spacings, of marching cubes",
           by_default("1,0.5,0.25")},
          {"--subdivide", kStudy, several(a.subdivisions, whole<int>(0, kMaxSubdivisions)),
           "numbers of subdivisions", by_default("0,1")},
          {"--field", kStudy, several(a.fields, named<FieldKind>()), "fields",
           by_default("vdw,blinn,soft,inverse-squared")},
          {"--project", kStudy, several(a.projections, named<StudyProjection>()),
           "surfaces that vertices are moved to after a subdivision; own is that of the field",
           by_default("own,vdw")},
          {"--backend", kStudy, several(a.backends, named<Backend>()), "who makes the meshes",
           by_default("auto")}};
}

// What is computed of the union and the mesh. The defaults are what a person waits for; costly
// checks are left to the size of the mesh.
std::vector<Option> measure_options(Draft& d) {
  Options& o = d.options;
  DistanceChoice& c = o.distances;
  return {
      {"--measure", kReport | kExact | kBatch | kRanksExact, one(d.read.measure, text("SELECTION")),
       "measure only these atoms; all others cover them (as --select)", otherwise("all atoms")},
      {"--method", kReport | kExact | kCompare | kBatch,
       one(d.measure.method, named<UnionMethod>()), "of the exact union",
       otherwise("auto: cgal; arcs without the whole topology")},
      {"--topology", kReport | kExact | kCompare, one(d.measure.topology, named<TopologyRequest>()),
       "exact topology; counts: components and Euler characteristic alone",
       otherwise("full; off with arcs")},
      {"--topology", kBatch, one(d.measure.topology, named<TopologyRequest>()),
       "exact topology; counts: components and Euler characteristic alone",
       otherwise("off; full with --verb report, and by the triangulation")},
      {"--topology", kRanksExact, one(d.measure.topology, named<TopologyRequest>()),
       "components and Euler characteristic: counts or off", otherwise("counts")},
      {"--certify", kReport | kExact, flag(d.measure.certify, true),
       "intervals that are proven to contain the exact area and volume"},
      {"--sums", kPockets | kBatch, flag(o.pocket_measures, PocketMeasures::sums),
       "of pockets CASTp's sums alone, several times as fast: no exact volumes, no lining"},
      {"--distances", kDistances, one(c.distances, named<Switch>()),
       "between mesh and exact surface", by_default("on")},
      {"--samples", kDistances, one(c.samples_per_area, density()), "of --distances, per Å²",
       by_default("10")},
      {"--samples", kInterface, one(c.samples_per_area, density()),
       "shape complementarity (Sc) as well, with so many samples per Å² to begin with",
       otherwise("none, and no Sc")},
      {"--seed", kDistances | kInterface, one(c.seed, whole<std::uint64_t>(0, 4'294'967'295)),
       "of the samples", by_default("1")},
      {"--self-intersections", kReport | kCompare | kStudy | kBatch,
       one(o.self_intersections, named<SelfIntersections>()), "count them; auto is on",
       by_default("auto")},
      {"--cgal-check", kReport | kBatch, one(o.cgal_check, named<CgalCheck>()),
       "area and volume by CGAL as well, with auto of up to a million triangles",
       by_default("auto")}};
}

// What a run may use of the machine, and what it says meanwhile.
std::vector<Option> machine_options(Draft& d) {
  MachineOptions& m = d.options.machine;
  return {
      {"--backend", kOneSurface | kExact | kCompare | kRanksMesh, one(m.backend, named<Backend>()),
       "who makes the mesh, and measures by arcs and distances", by_default("auto")},
      {"--devices", kOneSurface, one(m.devices, whole<int>(1, 64)),
       "CUDA devices that share an extraction", by_default("1")},
      {"--threads", kStructures, one(m.threads, whole<int>(1, 4096)), "CPU threads",
       otherwise("all")},
      {"--memory-limit", kStructures,
       one(d.memory_limit, Kind<std::uint64_t>{"BYTES", "", parse_bytes}),
       "for example 8G; a run that needs more is refused", otherwise("80 % of what is free")},
      {"--quiet", kStructures, flag(m.verbosity, Verbosity::quiet),
       "no text on standard output, no progress", no_default(), "--progress"},
      {"--verbose", kReports | kInterface | kRanks, flag(m.verbosity, Verbosity::verbose),
       "more text: parameters, counts, quality, proof and times", no_default(), "--quiet"},
      {"--progress", kStructures, flag(m.progress, Progress::always),
       "progress bars even where standard error is no terminal"}};
}

// How pictures look. `render` draws nothing else, so its file is an output; other verbs draw only
// where they are asked to.
std::vector<Option> picture_options(Draft& d) {
  PictureOptions& p = d.options.picture;
  RenderOptions& r = p.render;
  return {
      {"--picture", kReport | kCompare, one(p.path, text("FILE"), Use::writes),
       "PNG of the mesh, triangles coloured by the distance of their centres to the exact "
       "surface"},
      {"--view", kPictures, of_picture(p, "VIEW", read_view, names_of_views()),
       "from where: front back right left top bottom (along the principal axes), x -x y -y z -z "
       "(along the file's), or a direction X,Y,Z",
       otherwise("front: the broadest side")},
      {"--size", kPictures, of_picture(p, "WIDTHxHEIGHT", read_size), "in pixels",
       by_default("1200x900")},
      {"--background", kPictures,
       of_picture(p, "COLOR", read_background, {"transparent", "white", "black", "grey"}),
       "transparent, white, black, grey or #rrggbb", by_default("white")},
      {"--transparency", kPictures, of_picture(p, "T", read_transparency),
       "of the surface, from 0 to below 1 or in percent: all its layers are seen, each through "
       "those "
       "in front",
       by_default("0")},
      {"--outline", kPictures, flag(r.outline, kUsualOutline),
       "a line where the surface ends in front of what is farther"},
      {"--ambient-occlusion", kPictures, flag(p.ambient_occlusion, true),
       "light from all sides, which is dim in grooves and pockets"},
      {"--camera", kPictures, one(r.projection, named<CameraProjection>()), "how depth is drawn",
       by_default("orthographic")},
      {"--shading", kPictures, one(r.shading, named<Shading>()), "where light is computed",
       by_default("pixel")},
      {"--antialias", kPictures, one(r.samples_per_axis, whole<int>(1, 8)),
       "samples along each side of a pixel, 1 to 8", by_default("3")},
      {"--color-map", kPictures, one(p.color_map, named<ColorMap>()), "of values",
       otherwise("cool-warm for distances and curvatures, else viridis")},
      {"--color-range", kPictures, of_picture(p, "LOWER,UPPER", read_color_range),
       "values at the ends of the colour map", otherwise("what holds 99 % of them")},
      {"--color", kRender,
       of_picture(
           p, "COLOR", read_color,
           {"element", "chain", "residue", "hydropathy", "exposure", "b-factor", "distance",
            "angle", "kind", "mean-curvature", "gaussian-curvature", "white", "black", "grey"}),
       "element, chain, residue (its kind), hydropathy (Kyte-Doolittle), exposure (relative "
       "accessible area of the residue), b-factor (of the atoms of the file), distance (of "
       "triangle centres to the exact surface), angle (smallest of each "
       "triangle), kind, mean-curvature, gaussian-curvature (of the patches of --surface ses), "
       "or one colour: white, black, grey, #rrggbb",
       otherwise("element; of a MESH: grey")}};
}

// Where results go. Everything here is checked before the work begins, which may take hours.
std::vector<Option> output_options(Draft& d) {
  Options& o = d.options;
  return {
      {"-o,--output", kMesh, one(o.mesh_path, text("FILE"), Use::writes),
       "mesh file: .ply .obj .off .stl .glb, .msh (Gmsh; .msh4: version 4.1), .vtp .vtu (ParaView, "
       "meshio) or .3mf (printers)",
       required("name the mesh file to write (.ply .obj .off .stl .glb .msh .vtp .vtu .3mf)")},
      {"--ascii", kMesh, flag(o.ascii, Switch::on),
       "text in place of the binary form of .ply and .stl"},
      {"--scale", kMesh, one(o.mesh_scale, number("N", Range::positive, "0.1")),
       "lengths in the mesh file for 1 Å, such as 0.1 for nm; --units is of INPUT, and figures "
       "stay "
       "in Å",
       by_default("1")},
      {"-o,--output", kRanksMesh, one(o.mesh_path, text("FILE"), Use::writes),
       "mesh file, which all ranks write: .ply or .vtkhdf",
       required("name the mesh file to write (.ply .vtkhdf)")},
      {"-o,--output", kRender, one(o.picture.path, text("FILE"), Use::writes), "the picture: .png",
       required("name the picture to write (.png)")},
      {"-o,--output", kView, one(o.view.path, text("FILE"), Use::writes), "the page: .html",
       required("name the page to write (.html)")},
      {"-o,--output", kStudy, one(o.study.folder, text("FOLDER")),
       "gets study.csv, study.json and index.html",
       required("name the folder that the study is written to")},
      {"-o,--output", kBatch, one(o.batch.output, text("FILE"), Use::writes),
       "the rows: .jsonl .ndjson .json (JSON lines) or .csv", otherwise("standard output")},
      {"--verb", kBatch, one(o.batch.verb, named<BatchVerb>()),
       "whose figures the rows have; report makes a mesh of each structure as well",
       by_default("exact")},
      {"--rows", kBatch, one(o.batch.rows, named<RowFormat>()), "of which kind they are",
       otherwise("by extension; jsonl")},
      {"--shard", kBatch, one(o.batch.shard, Kind<Shard>{"I/N", "", parse_shard}),
       "the I-th of N parts of the inputs, which follow each other", otherwise("all")},
      {"--resume", kBatch, one(o.batch.resume, named<Switch>()),
       "keep the rows that FILE has, and go on behind them", by_default("on")},
      {"--resume", kStudy, one(o.study.resume, named<Switch>()),
       "take finished runs from the folder", by_default("on")},
      {"--time-limit", kStudy, one(o.study.time_limit, number("s", Range::non_negative, "3600")),
       "after which no further run begins; what is finished is written", otherwise("none")},
      {"--page-triangles", kStudy,
       one(o.study.page_triangles, whole<std::uint64_t>(0, 100'000'000)),
       "most triangles of all meshes shown on the page", by_default("1000000")},
      {"--page-triangles", kView,
       one(o.view.most_triangles, whole<std::uint64_t>(1'000, 100'000'000)),
       "about how many triangles the surface on the page may have, where as few can mesh it",
       by_default("500000")},
      {"--json", kReports | kInterface | kInfo | kRanks,
       one(o.output.json, text("FILE"), Use::writes), "the report as JSON; - is standard output"},
      {"--per-atom", kReport, one(o.output.per_atom, text("FILE"), Use::writes),
       "CSV of radius, exact area, mesh area, exact volume; - is standard output"},
      {"--per-atom", kExact | kRanksExact, one(o.output.per_atom, text("FILE"), Use::writes),
       "CSV of radius, exact area, exact volume; - is standard output"},
      {"--per-atom", kInterface, one(o.output.per_atom, text("FILE"), Use::writes),
       "CSV of the atoms of each interface: area alone, in the pair and among all, buried area, "
       "area of contacts; - is standard output"},
      {"--group", kReport | kExact | kInterface | kRanksExact,
       one(o.output.group, named<AtomGroup>()),
       "rows of --per-atom; of residues with the relative areas of radius sets such as protor",
       by_default("atom")},
      {"-o,--output", kPockets, one(o.output.spheres, text("FILE"), Use::writes),
       "table: .csv, - is standard output; or spheres for viewers: .pdb .pml (PyMOL) .bild "
       "(ChimeraX) .mvsj (Mol*); of places and ways also a plot: .svg"},
      {"--csv", kPockets, one(o.output.csv, text("FILE"), Use::writes),
       "the table; - is standard output"},
      {"--mesh", kPockets, one(o.output.pocket_meshes, text("FILE"), Use::writes),
       "a closed mesh of each pocket, its wall and mouths as parts with names: .glb .obj .3mf"},
      {"--scan", kPockets, probe_range(o.pocket_query.scan),
       "the places for probes of LO to HI Å, and at which radii they join, in place of the pockets",
       no_default(), "--shell"},
      {"--shell", kPockets, one(o.pocket_query.shell, number("Å", Range::positive, "4")),
       "the room for the probe, but not for a larger one of this radius", no_default(), "--from"},
      {"--from", kPockets, one(o.pocket_query.from, text("PLACE")),
       "the widest way out from an atom, such as \"A/HIS 57/NE2\", X,Y,Z or pocket:1", no_default(),
       "--scan"},
      {"--voids", kReport | kExact, one(o.output.voids, text("FILE"), Use::writes),
       "CSV of the voids: volume, area, centre, clearance, atoms, - is standard output; or a "
       "sphere "
       "in each for viewers: .pdb .pml (PyMOL) .bild (ChimeraX) .mvsj (Mol*)"},
      {"--depth", kExact, one(o.output.depth, text("FILE"), Use::writes),
       "CSV of how deep atoms, or residues in the mean (--group), lie below the accessible, the "
       "excluded and its exterior surface, Å; - is standard output"},
      {"--write", kExact | kInterface, one(o.output.atoms, text("FILE"), Use::writes),
       "the atoms in use with the figure that --b-factor names: .pdb .ent .cif .mmcif"},
      {"--b-factor", kExact, one(o.output.b_factor, named<AtomFigure>()),
       "of --write: exact area or volume of the atom, its depth below the surface, or the exposure "
       "of its residue (100 times the relative area)",
       by_default("area")},
      {"--b-factor", kInterface, one(o.output.interface_figure, named<InterfaceFigure>()),
       "of --write: what the atom loses in all interfaces, the area of its contacts, or its area "
       "with its own side alone",
       by_default("buried")},
      {"--rsa", kExact, one(o.output.residues, text("FILE"), Use::writes),
       "areas of residues and their shares of extended ones, as NACCESS prints them; - is standard "
       "output"},
      {"--gradient", kExact | kRanksExact, one(o.output.gradient, text("FILE"), Use::writes),
       "CSV of the derivatives of area and volume by each atom's centre and radius; - is standard "
       "output"}};
}

}  // namespace

std::vector<OptionGroup> all_options(Draft& d) {
  return {{kInputGroup, input_options(d)},
          {kSurfaceGroup, surface_options(d)},
          {"Sweep", axis_options(d.options.study.axes)},
          {"Measures", measure_options(d)},
          {kPictureGroup, picture_options(d)},
          {"Output", output_options(d)},
          {"Machine", machine_options(d)}};
}

}  // namespace vdwmesh::apps
