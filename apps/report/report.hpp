// Everything a run found out. What was not computed is absent, never 0.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/comparison.hpp"
#include "analysis/exposure.hpp"
#include "analysis/mesh_measures.hpp"
#include "analysis/survey/cgal_measures.hpp"
#include "creases/exact_mesher.hpp"
#include "excluded/excluded_bounds.hpp"
#include "excluded/excluded_measures.hpp"
#include "interface/complementarity.hpp"
#include "interface/excluded_burial.hpp"
#include "measures/exact_union.hpp"
#include "options.hpp"
#include "remesh/surface_remesher.hpp"
#include "render/color_scale.hpp"
#include "report/pockets/pocket_report.hpp"
#include "report/pockets/scan_report.hpp"
#include "steps/stopwatch.hpp"
#include "structure/molecule.hpp"

namespace vdwmesh::apps {

// What is known of the molecule; its atoms are not here.
struct InputReport : Molecule {
  std::uint64_t spheres = 0;           // an assembly has several of one atom
  double probe = 0;                    // Å
  std::optional<std::string> measure;  // the selection; nothing if all spheres are measured
  std::uint64_t measured = 0;          // spheres
};

struct ParametersReport {
  SurfaceOptions surface;
  std::optional<GridSpec> grid;                  // of marching cubes
  std::optional<double> isovalue, blobbiness;    // of the fields that have them
  std::uint64_t memory_limit = 0;                // bytes
  std::optional<std::uint64_t> memory_estimate;  // bytes, of the stage that takes the most
};

struct BackendReport {
  Backend requested = Backend::automatic;
  Backend used = Backend::cpu;
  std::optional<std::string> device, driver;
  std::optional<std::string> reason;  // why automatic did not take CUDA, or fell back from it
  int devices = 0;                    // that made the mesh; 0 on the CPU
  int threads = 1;
};

// The mesh between two levels of refinement; level 0 is the extracted one.
struct LevelReport : MeshExamination {
  int level = 0;
  std::optional<std::uint64_t> self_intersections;
};

// Of one kind of patch of the excluded surface.
struct PatchCount {
  std::uint64_t patches = 0, triangles = 0;
  double area = 0;  // Å², of the triangles
};
struct PatchReport {
  PatchCount contact, saddle, concave;
};

struct MeshReport : MeshExamination {
  std::optional<std::uint64_t> grid_clipped, clamped_vertices;  // of our own extraction only
  std::optional<ExactMeshStats> arrangement;                    // of the crease-exact mesher
  std::optional<PatchReport> patches;                           // of the excluded surface
  std::optional<RemeshStats> remeshing;                         // if it does not follow its curves
  std::optional<std::uint64_t> self_intersections;
  std::vector<ProjectionStats> projection;  // empty: no refinement ran
  std::vector<LevelReport> levels;          // empty: no refinement ran, or not asked for
  std::optional<double> extrapolated_area, extrapolated_volume;  // Å², Å³; see extrapolate()
  std::optional<CgalMeasures> cgal;  // the same measures by CGAL, where asked for
  std::optional<std::string> path;   // of a mesh that was read
  std::vector<std::string> notes;    // how it was read
};

struct PictureReport {
  std::string path, view, device;
  int width = 0, height = 0;  // pixels
  std::uint64_t triangles = 0;
  std::optional<ColorScale> scale;  // of a picture that shows values
};

// The stages of a run follow each other without gaps; what did not run is empty.
struct Timing {
  using Stage = std::optional<StageTime>;
  Stage read;                                    // files
  Stage plan;                                    // the estimate of memory
  Stage mesh;                                    // all of making the mesh, but for `levels`
  std::optional<double> field, extract, refine;  // s of wall time: parts of `mesh`
  Stage levels;                                  // measuring the levels of a refinement
  Stage measure, self_intersections, cgal_check;
  Stage exact, compare, picture, build;
  Stage write;  // files but for pictures, and but for the report itself
  StageTime total;
};

// Adds a lap to a stage.
void add(Timing::Stage& stage, const StageTime& lap);

// Names and seconds of the stages in their order, the total last. By the clock, `mesh` stands as
// its parts: field, extract, refine, and setup for what is left of it, as starting a device.
struct Seconds {
  std::vector<std::pair<const char*, std::optional<double>>> stages;
};
Seconds wall_seconds(const Timing& timing);
Seconds cpu_seconds(const Timing& timing);

struct ExactReport : ExactUnion {
  std::optional<AreaByPolarity> by_polarity;  // where the radius set has one
  Backend backend = Backend::cpu;             // that measured the spheres
};

// How far the area of an atom's triangles is from the exact area of its patch, as a fraction of
// it. Of the measured atoms with at least 1 Å² exposed; smaller patches may be one triangle.
struct AtomErrors {
  double max = 0, rms = 0;
  std::uint64_t atoms = 0;  // that count
  std::string worst;        // the atom of the largest error: "A/40 GLN CB"
};

// What a mesh whose triangles belong to atoms can be held against, beside the figures of any mesh.
struct MeshProof {
  // Whether Euler characteristic, components and voids are those of the exact union; empty if these
  // were not computed.
  std::optional<bool> topology_is_exact;
  std::optional<AtomErrors> atoms;  // empty: no atom counts
  // ExactMeshStats::below_floor, before subdivision; empty with min_angle or an excluded surface.
  std::optional<std::uint64_t> below_floor;
  // (extrapolated - exact) / exact; empty without two levels.
  std::optional<double> extrapolated_area_error, extrapolated_volume_error;
};

struct ComparisonReport : Comparison {
  ExactSurface surface = ExactSurface::vdw;     // that the mesh is compared with
  std::optional<MeshProof> proof;               // of meshes along the curves of the surface
  std::optional<Comparison> exterior;           // with the exterior excluded surface
  std::optional<HausdorffBounds> bounds;        // proven; of the excluded surface
  Backend distances_backend = Backend::cpu;     // that measured the distances
  std::optional<std::string> distances_reason;  // why automatic did not take CUDA for them
};

// One side of an interface. Areas in Å².
struct SideReport {
  double area = 0, area_in_pair = 0, area_in_whole = 0;  // alone; with the other side; with all
  double buried_area = 0;                                // by the other side
  std::uint64_t atoms = 0, residues = 0;                 // that lose area to it
};

// The faces that the atoms of two residues share, Å².
struct ResidueContact {
  std::string a, b;  // "A/10 GLN"
  double area = 0;
};

struct InterfaceReport {
  std::string a, b;                          // chains or selections
  double buried_area = 0, contact_area = 0;  // Å², of both sides; of all contacts
  SideReport side_a, side_b;
  std::optional<AreaByPolarity> buried_by_polarity;  // where the radius set has one
  std::vector<ResidueContact> contacts;              // largest first
  std::optional<Complementarity> complementarity{};  // where asked for
  std::optional<ExcludedBurial> excluded{};          // where asked for
};

struct Report {
  InputReport input;
  std::optional<ParametersReport> parameters;
  std::optional<BackendReport> backend;
  std::optional<MeshReport> mesh;
  std::optional<ExactReport> exact;
  std::optional<ExcludedMeasures> excluded;
  std::optional<std::vector<InterfaceReport>> interfaces;
  std::optional<ComparisonReport> comparison;
  std::optional<PictureReport> picture;
  std::optional<PocketReport> pockets;
  std::optional<ScanReport> scan;
  std::optional<ShellReport> shell;
  std::optional<WayReport> way;
  Timing timing;
  std::vector<std::string> notes;     // for people: what was chosen or left out
  std::vector<std::string> warnings;  // for people: what may be wrong with the result

  template <class... Values>
  void note(fmt::format_string<Values...> text, Values&&... values) {
    notes.push_back(fmt::format(text, std::forward<Values>(values)...));
  }
  template <class... Values>
  void warn_if(bool holds, fmt::format_string<Values...> text, Values&&... values) {
    if (holds) warnings.push_back(fmt::format(text, std::forward<Values>(values)...));
  }
};

// All levels of a refinement in one line of figures.
struct NewtonSummary {
  int iterations_max = 0;
  double residual_max = 0;  // Å
  std::uint64_t projected = 0, unconverged = 0, out_of_reach = 0, undone = 0;
  std::uint64_t turned = 0;  // in the finished mesh
  std::vector<ProjectionStats> levels;
};
NewtonSummary summarize(const std::vector<ProjectionStats>& levels);

// Area and volume at edge length 0, from the last two levels; none from fewer. Precondition: the
// mesh follows the curves of its surface, because only such a mesh is of second order.
void extrapolate(MeshReport& mesh);

// What the figures themselves say is wrong: an open or inside-out mesh, vertices left off the
// surface, and so on. Added to report.warnings.
void add_warnings(Report& report);

std::string to_json(const Report& report);
// The answer in about ten lines, with notes and warnings; all that the report has with
// Verbosity::verbose.
std::string to_text(const Report& report, Verbosity verbosity);
// The lines of to_text() about the picture, its times, and its notes and warnings.
std::string picture_text(const PictureReport& picture);
std::string timing_text(const Timing& timing);
std::string remarks_text(const Report& report);

}  // namespace vdwmesh::apps
