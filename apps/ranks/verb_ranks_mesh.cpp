// The verb mesh of vdwmesh-mpi: from a structure to one mesh file, to which every rank adds its
// part of the surface.
#include <fmt/format.h>

#include "distributed/ply_file.hpp"
#include "distributed/shared_file.hpp"
#include "distributed/surface_piece.hpp"
#include "grid_checks.hpp"
#include "interrupt.hpp"
#include "output.hpp"
#include "ranks/rank_session.hpp"
#include "ranks/rank_verbs.hpp"

namespace vdwmesh::apps {
namespace {

ExtractOptions extract_options(const Options& options, const Session& session) {
  ExtractOptions extract;
  extract.field = options.surface.field;
  extract.grid = options.surface.grid;
  extract.memory_limit = session.machine.memory_limit;
  extract.monitor = session.monitor;
  return extract;
}

// The isovalue of a blended field.
std::optional<double> isovalue_of(const SphereSet& spheres, const SurfaceOptions& surface) {
  if (surface.field.kind == FieldKind::vdw) return std::nullopt;
  return make_field_model(surface.field, make_grid(spheres, surface.grid)).isovalue;
}

SurfacePiece make_piece(const Ranks& ranks, const SphereSet& spheres, const Options& options,
                        Session& session) {
  const SurfaceOptions& surface = options.surface;
  ranks.together([&] { require_sensible_spacing(spheres, surface.grid.spacing); });
  SurfacePiece piece =
      mesh_together(ranks, spheres, extract_options(options, session), session.machine.backend);
  ranks.together([&] {
    require_triangles(piece.whole.triangles, spheres, surface.grid.spacing,
                      isovalue_of(spheres, surface));
    check_ply_size(piece.whole);
  });
  session.report.timing.field = piece.stats.field_seconds;
  session.report.timing.extract = piece.stats.extract_seconds;
  session.end_stage(&Timing::mesh);
  return piece;
}

void write_piece(const Ranks& ranks, const SurfacePiece& piece, const Molecule& molecule,
                 const std::string& path, Session& session) {
  const std::vector<RgbColor> colors = share_colors(ranks, molecule);
  const std::filesystem::path hidden = choose_hidden_name(ranks, path);
  const RemoveOnSignal remove(hidden);
  SharedFile file(ranks, path, hidden);
  write_ply(ranks, piece, colors, file);
  file.commit();
  session.end_stage(&Timing::write);
}

// Every edge of a closed mesh is on two triangles.
std::string mesh_text(const MeshSize& size) {
  const auto chi =
      static_cast<std::int64_t>(size.vertices) - static_cast<std::int64_t>(size.triangles / 2);
  return fmt::format("{} vertices, {} triangles; Euler characteristic {}", size.vertices,
                     size.triangles, chi);
}

}  // namespace

void run_ranks_mesh(const Ranks& ranks, const Options& options) {
  VerbSession session(machine_of_rank(ranks, options.machine));
  const SharedStructure shared = load_together(ranks, options.inputs.front(), session);
  const SurfacePiece piece = make_piece(ranks, shared.spheres, options, session);
  write_piece(ranks, piece, shared.molecule, options.mesh_path, session);
  session.end_progress();
  session.stop_watch();
  session.deliver_text(options.output, [&] {
    return fmt::format("Mesh         {}\n{}{}", mesh_text(piece.whole), ranks_text(ranks, session),
                       timing_text(session.report.timing));
  });
}

}  // namespace vdwmesh::apps
