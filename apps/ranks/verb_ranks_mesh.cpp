// The verb mesh of vdwmesh-mpi: from a structure to one mesh file, to which every rank adds its
// part of the surface. The report is that of the plain program.
#include <chrono>

#include "distributed/files/ply_file.hpp"
#include "distributed/files/shared_file.hpp"
#include "distributed/files/vtkhdf_file.hpp"
#include "distributed/shares/exact_piece.hpp"
#include "distributed/shares/surface_piece.hpp"
#include "distributed/together/components_together.hpp"
#include "distributed/together/examine_together.hpp"
#include "distributed/together/refine_together.hpp"
#include "interrupt.hpp"
#include "named_files.hpp"
#include "ranks/rank_verbs.hpp"
#include "ranks/shared_structure.hpp"
#include "report/output.hpp"
#include "request/refuse.hpp"
#include "steps/edge_lengths.hpp"
#include "steps/exact_steps.hpp"
#include "steps/grid_checks.hpp"
#include "steps/steps.hpp"

namespace vdwmesh::apps {
namespace {

// A format that this build cannot write is refused before anything is computed.
void require_format(const std::string& path) {
  refuse_if(is_vtkhdf(path) && !has_vtkhdf(),
            "-o {}: this vdwmesh-mpi was built without HDF5 (Debian's libhdf5-openmpi-dev), which "
            "writes VTKHDF; name a .ply file",
            path);
}

ExtractOptions extract_options(const Options& options, const Session& session) {
  ExtractOptions extract;
  extract.field = options.surface.field;
  extract.grid = options.surface.grid;
  // A projection makes normals of its own.
  if (options.surface.projection != Projection::none) extract.normals = Normals::none;
  extract.memory_limit = session.machine.memory_limit;
  extract.monitor = session.monitor;
  return extract;
}

// What the report says before there is a mesh.
void describe(const Ranks& ranks, const SphereSet& spheres, const Options& options,
              Session& session) {
  const SurfaceOptions& surface = options.surface;
  const MachineOptions& machine = session.machine;
  Report& report = session.report;
  const std::uint64_t threads = ranks.sum(static_cast<std::uint64_t>(machine.threads));
  ranks.together([&] {
    std::optional<GridSpec> grid;
    if (surface.mesher == Mesher::marching_cubes) {
      require_sensible_spacing(spheres, surface.grid.spacing);
      grid = make_grid(spheres, surface.grid);
    }
    report.parameters = describe_parameters(surface, grid, machine.memory_limit);
    report.backend = describe_backend(machine.backend, resolve(machine.backend));
  });
  report.backend->devices = report.backend->used == Backend::cuda ? 1 : 0;
  report.backend->threads = static_cast<int>(threads);
  report.notes.insert(report.notes.end(), surface.notes.begin(), surface.notes.end());
  report.note("made by {} rank{}, {} CPU thread{} each", ranks.count(),
              ranks.count() == 1 ? "" : "s", machine.threads, machine.threads == 1 ? "" : "s");
}

// As the plain program does, which refines if a level is asked for.
void refine_piece(const Ranks& ranks, const SphereSet& spheres, const Options& options,
                  SurfacePiece& piece, Session& session) {
  if (options.surface.subdivisions == 0) return;
  const auto begin = std::chrono::steady_clock::now();
  RefineOptions refine = refine_options(options.surface, session);
  if (session.report.parameters->grid) refine.grid = *session.report.parameters->grid;
  session.report.mesh->projection = refine_together(ranks, spheres, refine, piece);
  session.report.timing.refine =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (session.report.backend->used == Backend::cuda) {
    session.report.note("the CPU refined the mesh: ranks do not refine on devices");
  }
}

// A file that cannot hold the mesh is refused as soon as its size is known.
void check_size(const SurfacePiece& piece, const Options& options) {
  if (is_vtkhdf(options.mesh_path)) return;
  check_ply_size(subdivided(piece.whole, options.surface.subdivisions));
}

// Along the creases. The first rank alone knows the atoms, by which edge lengths may differ.
SurfacePiece make_exact_piece(const Ranks& ranks, const SharedStructure& shared,
                              const Options& options, Session& session) {
  std::vector<double> lengths;
  ranks.together([&] {
    if (!ranks.is_first()) return;
    lengths = edge_lengths_of(options.surface, shared.molecule, shared.spheres);
  });
  ranks.share(lengths);
  SurfaceOptions surface = options.surface;
  surface.edge_lengths = std::move(lengths);
  ExactPiece made = mesh_union_together(
      ranks, shared.spheres,
      exact_mesh_options(surface, session.machine.memory_limit, session.monitor));
  describe_exact_mesh(made.stats, session.report);
  ranks.together([&] { check_size(made.piece, options); });
  if (session.report.backend->used == Backend::cuda) {
    account_for_fallback("the CPU made the mesh: ranks do not mesh along creases on devices",
                         session.report);
  }
  return std::move(made.piece);
}

SurfacePiece make_cubes_piece(const Ranks& ranks, const SphereSet& spheres, const Options& options,
                              Session& session) {
  Report& report = session.report;
  SurfacePiece piece =
      mesh_together(ranks, spheres, extract_options(options, session), session.machine.backend);
  account_for_fallback(piece.fallback, report);
  ranks.together([&] {
    require_triangles(piece.whole.triangles, spheres, report.parameters->grid->spacing,
                      report.parameters->isovalue);
    check_size(piece, options);
  });
  report.timing.field = piece.stats.field_seconds;
  report.timing.extract = piece.stats.extract_seconds;
  report.mesh.emplace();
  report.mesh->grid_clipped = piece.stats.grid_clipped;
  report.mesh->clamped_vertices = piece.stats.clamped_vertices;
  return piece;
}

SurfacePiece make_piece(const Ranks& ranks, const SharedStructure& shared, const Options& options,
                        Session& session) {
  describe(ranks, shared.spheres, options, session);
  SurfacePiece piece = options.surface.mesher == Mesher::exact
                           ? make_exact_piece(ranks, shared, options, session)
                           : make_cubes_piece(ranks, shared.spheres, options, session);
  refine_piece(ranks, shared.spheres, options, piece, session);
  session.end_stage(&Timing::mesh);
  return piece;
}

void measure_piece(const Ranks& ranks, SurfacePiece& piece, const SphereSet& spheres,
                   Session& session) {
  static_cast<MeshExamination&>(*session.report.mesh) = examine_together(ranks, piece);
  session.end_stage(&Timing::measure);
  if (session.report.parameters->surface.field.kind != FieldKind::vdw) return;
  const std::uint64_t pieces = components_together(ranks, spheres);
  ranks.together([&] {
    if (ranks.is_first()) warn_of_lost_balls(pieces, session);
  });
}

void write_piece(const Ranks& ranks, const SurfacePiece& piece, const SharedStructure& shared,
                 const std::string& path, Session& session) {
  const HostArray<RgbColor> colors = share_colors(ranks, shared);
  const std::filesystem::path hidden = choose_hidden_name(ranks, path);
  const RemoveOnSignal remove(hidden);
  SharedFile file(ranks, path, hidden);
  const auto& write = is_vtkhdf(path) ? write_vtkhdf : write_ply;
  write(ranks, piece, colors.span(), file);
  file.commit();
  session.report.mesh->path = path;
  session.end_stage(&Timing::write);
}

}  // namespace

void run_ranks_mesh(const Ranks& ranks, const Options& options) {
  VerbSession session(machine_of_rank(ranks, options.machine));
  ranks.together([&] { require_format(options.mesh_path); });
  // Edge lengths may differ from atom to atom.
  const AtomRecords records =
      options.surface.grading.is_uniform() ? AtomRecords::needless : AtomRecords::needed;
  const SharedStructure shared = load_together(ranks, options.inputs.front(), records, session);
  SurfacePiece piece = make_piece(ranks, shared, options, session);
  measure_piece(ranks, piece, shared.spheres, session);
  write_piece(ranks, piece, shared, options.mesh_path, session);
  ranks.together([&] {
    if (ranks.is_first()) session.deliver_report(options.output);
  });
}

}  // namespace vdwmesh::apps
