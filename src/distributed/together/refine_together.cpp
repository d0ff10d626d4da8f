// refine_together(): a rank keeps the children of its triangles, which stand behind each other as
// those of the whole mesh, and owns the midpoints of its edges (edges_together.hpp). It projects
// its vertices with the functions that one process has for them, and asks the owners of the other
// vertices of its part (border_mesh.hpp) where these are.
//
// A part has all triangles around its own vertices. So a rank finds by itself which of its vertices
// are in turned triangles and have to go back. After each pass the vertices of other ranks are
// updated, until a pass puts no vertex back on any rank. Each pass looks at the same triangles in
// the same states as a pass of one process (bad_moves.hpp), so the outcome is the same.
#include "distributed/together/refine_together.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "analysis/survey/stage_bytes.hpp"
#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "core/workspace.hpp"
#include "distributed/shares/chosen_spheres.hpp"
#include "distributed/shares/piece_refinement.hpp"
#include "distributed/shares/surface_shares.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/field.hpp"
#include "refine/crossings/preparation.hpp"
#include "refine/refiner.hpp"
#include "refine/surface_view.hpp"
#include "spheres/list_ids.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {
namespace {

// The surface that a rank projects to, made from the spheres near its part alone. Spheres are
// chosen by z, as the shares of a surface are. A projection tries points that are no farther from
// its start than its reach. At a point it asks for balls that are no farther than the reach, or for
// atoms whose field reaches the point. So the spheres whose interval of z comes within twice the
// reach of a start are enough. Their cell list has the frame of the list of all spheres, so it
// visits them in the same order, and they keep their canonical order. So sums and ties have the
// same outcome.
class NearSurface {
 public:
  // All spheres, and the options of the refinement, whose frame is that of the whole set. Both must
  // outlive the object.
  NearSurface(const SphereSet& spheres, const RefineOptions& options);

  // Chooses enough spheres for projections that start at points with z in this interval (Å) and try
  // points within `reach` of them: for all these points surface() gives the results that it has
  // with all spheres.
  void cover(double lower, double upper, double reach);

  // Labels that it makes or takes name spheres of the whole set. Precondition: cover().
  const SurfaceView& surface() const { return *surface_; }

 private:
  void choose_spheres(double lower, double upper);

  const SphereSet& spheres_;
  const RefineOptions& options_;
  FieldModel model_;
  double lower_ = 0, upper_ = -1;  // covered; at first nothing
  ChosenSpheres near_;
  SphereSet near_set_;  // a view of near_
  Workspace workspace_;
  Buffer<SphereId> ids_;  // by list place: id in the whole set
  std::optional<SurfaceView> surface_;
};

constexpr double kBoxSlack = 1e-6;  // Å: more than kProjectionTolerance and rounding

NearSurface::NearSurface(const SphereSet& spheres, const RefineOptions& options)
    : spheres_(spheres), options_(options), model_(projection_model(options)) {}

// Later levels move vertices by less, so the spheres chosen before are mostly enough.
void NearSurface::cover(double lower, double upper, double reach) {
  lower -= 2 * reach + kBoxSlack;
  upper += 2 * reach + kBoxSlack;
  if (surface_ && lower >= lower_ && upper <= upper_) return;
  choose_spheres(lower, upper);
}

void NearSurface::choose_spheres(double lower, double upper) {
  lower_ = lower;
  upper_ = upper;
  near_ = choose(spheres_, [&](SphereId, const Sphere& s) {
    const double reach = field_reach(model_, s.radius);
    return s.center.z + reach >= lower && s.center.z - reach <= upper;
  });
  if (near_.spheres.empty()) near_ = {{spheres_[0]}, {0}};
  near_set_ = SphereSet::view(near_.spheres);
  SurfaceView view{options_.projection,
                   projection_list(near_set_, options_, TriangleLabels::none, workspace_), model_,
                   spheres_.spheres().data()};
  use_ids(near_.ids, view.list, ids_);
  surface_.emplace(view);
}

// The interval of z in which the projections of a level start, and the largest distance by which
// one may move its vertex.
struct Starts {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;  // of z, Å
  double reach = 0;                                                        // Å

  void add(double z, double r) {
    lower = std::min(lower, z);
    upper = std::max(upper, z);
    reach = std::max(reach, r);
  }
  static Starts join(Starts a, const Starts& b) {
    a.lower = std::min(a.lower, b.lower);
    a.upper = std::max(a.upper, b.upper);
    a.reach = std::max(a.reach, b.reach);
    return a;
  }
};

// The moves of the vertices that a level handles: the own vertices from `first` on.
struct Moves {
  std::size_t first = 0;
  Buffer<Vec3d> starts;      // by vertex of the part, where it was before the moves
  Buffer<SphereId> atoms;    // by handled vertex, its label before the moves
  Buffer<MoveState> states;  // by handled vertex
};

class Refinement final : public PieceRefinement {
 public:
  Refinement(const Ranks& ranks, const SphereSet& spheres, const RefineOptions& options,
             SurfacePiece& piece)
      : PieceRefinement(ranks, spheres, options, piece) {
    ranks.together([&] { surface_.emplace(spheres, options_); });
    has_normals_ = !projects() && ranks.sum(std::uint64_t{piece.mesh.normals.size()}) > 0;
  }

 private:
  // Copies an array over the own vertices into one over the vertices of the part.
  template <class T>
  void put_into_part(const Buffer<T>& own, Buffer<T>& of_part) const {
    of_part.resize(part_.mesh.vertex_count());
    for_all(own.size(), [&](std::size_t v) { of_part[v] = own[v]; });
  }

  // Brings the part up to date with the own vertices of all ranks. Collective.
  void refresh_part() {
    IndexedMesh& mesh = part_.mesh;
    ranks_.together([&] {
      put_into_part(piece_.mesh.positions, mesh.positions);
      put_into_part(piece_.mesh.vertex_spheres.atoms, mesh.vertex_spheres.atoms);
      if (has_normals_) put_into_part(piece_.mesh.normals, mesh.normals);
    });
    part_.halo.refresh(ranks_, mesh.positions);
    part_.halo.refresh(ranks_, mesh.vertex_spheres.atoms);
    if (has_normals_) part_.halo.refresh(ranks_, mesh.normals);
  }

  MoveState put(const PlacedVertex& placed, std::size_t own_vertex) {
    piece_.mesh.positions[own_vertex] = placed.position;
    piece_.mesh.vertex_spheres.set(own_vertex, placed.label);
    return placed.state;
  }

  ProjectionStats project_given() override {
    part_ = copy_border_mesh(ranks_, piece_);
    ProjectionStats stats;
    Moves moves;
    if (projects()) {
      ranks_.together([&] {
        moves.starts = part_.mesh.positions;
        moves.atoms = piece_.mesh.vertex_spheres.atoms;
        stats = project_own(moves);
      });
    }
    return finish_level(moves, stats);
  }

  // Projects the own vertices of the given mesh.
  ProjectionStats project_own(Moves& moves) {
    const std::size_t own = piece_.mesh.vertex_count();
    const Buffer<std::uint64_t> squares = longest_edge_squares(part_.mesh);
    const auto reach_of = [&](std::size_t v) {
      return std::sqrt(std::bit_cast<double>(squares[v]));
    };
    cover(own, [&](std::size_t v, Starts& starts) {
      starts.add(piece_.mesh.positions[v].z, reach_of(v));
    });
    moves.states.resize(own);
    return tally(own, options_.monitor, [&](std::size_t v, ProjectionStats& stats) {
      moves.states[v] = put(place_given(surface_->surface(), piece_.mesh.positions[v],
                                        piece_.mesh.vertex_spheres[v], reach_of(v), stats),
                            v);
    });
  }

  template <class Add>
  void cover(std::size_t count, const Add& add) {
    const Starts starts = reduce_all(count, Starts{}, add, Starts::join);
    surface_->cover(starts.lower, starts.upper, starts.reach);
  }

  ProjectionStats subdivide() override {
    Moves moves;
    Buffer<Vec3d> starts;
    const ProjectionStats stats = make_level([&](const NumberedEdges& edges) {
      moves.first = first_midpoint();
      return make_midpoints(edges, moves, starts);
    });
    part_ = {};
    part_ = copy_border_mesh(ranks_, piece_);
    if (projects()) {
      ranks_.together([&] {
        put_into_part(piece_.mesh.positions, moves.starts);
        for_all(starts.size(), [&](std::size_t i) { moves.starts[moves.first + i] = starts[i]; });
        starts = Buffer<Vec3d>();  // frees the memory, as {} would not
      });
      part_.halo.refresh(ranks_, moves.starts);
    }
    return finish_level(moves, stats);
  }

  ProjectionStats make_midpoints(const NumberedEdges& edges, Moves& moves, Buffer<Vec3d>& starts) {
    IndexedMesh &mesh = piece_.mesh, &parent = part_.mesh;
    if (has_normals_) mesh.normals.resize(mesh.positions.size());
    const auto edge_ends = [&](std::size_t h) -> EdgeEnds {
      const auto [a, b] = ends_of(h);
      return {parent.positions[a], parent.positions[b], parent.vertex_spheres.atoms[a],
              parent.vertex_spheres.atoms[b]};
    };
    cover(edges.edge.size(), [&](std::size_t h, Starts& all) {
      if (edges.is_lower[h] == 0) return;
      const EdgeEnds ends = edge_ends(h);
      all.add(ends.start().z, midpoint_reach(ends.a, ends.b));
    });
    starts.resize(edges.own);
    moves.atoms.resize(edges.own);
    moves.states.resize(edges.own);
    return tally(edges.edge.size(), options_.monitor, [&](std::size_t h, ProjectionStats& stats) {
      if (edges.is_lower[h] == 0) return;
      const std::size_t i = edges.edge[h], v = moves.first + i;
      const auto [a, b] = ends_of(h);
      if (has_normals_) {
        mesh.normals[v] = mean_normal(parent.normals[a], parent.normals[b]);
      }
      const EdgeEnds ends = edge_ends(h);
      starts[i] = ends.start();
      moves.atoms[i] = ends.unprojected_label(balls_)[0];
      moves.states[i] = put(place_midpoint(surface_->surface(), balls_, ends, stats), v);
    });
  }

  // Takes back the moves that turn triangles, and returns the counts of all ranks. Collective.
  ProjectionStats finish_level(Moves& moves, ProjectionStats stats) {
    refresh_part();
    if (projects()) {
      while (ranks_.sum(put_back(moves, stats)) > 0) refresh_part();
    }
    return end_level(stats);
  }

  // One pass. Returns how many vertices of this rank it has put back. Collective.
  std::uint64_t put_back(Moves& moves, ProjectionStats& stats) {
    std::uint64_t undone = 0;
    ranks_.together([&] {
      mark_turned(moves);
      undone = sum_all(moves.states.size(), [&](std::size_t i, std::uint64_t& count) {
        if (moves.states[i] != MoveState::to_undo) return;
        const std::size_t v = moves.first + i;
        moves.states[i] = put({moves.starts[v], on_sphere(moves.atoms[i]), MoveState::stayed}, v);
        ++count;
      });
    });
    stats.undone += undone;
    stats.projected -= undone;  // it had moved, so it was counted as projected
    return undone;
  }

  void mark_turned(Moves& moves) const {
    const IndexedMesh& mesh = part_.mesh;
    for_all(mesh.triangle_count(), [&](std::size_t t) {
      std::array<Vec3d, 3> now, before;
      std::array<SphereId, 3> atom;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangles[t][k];
        now[k] = mesh.positions[v];
        before[k] = moves.starts[v];
        atom[k] = mesh.vertex_spheres.atoms[v];
      }
      if (!is_turned(balls_, before, now, atom)) return;
      for (const std::uint32_t v : mesh.triangles[t]) mark(moves, v);
    });
  }

  // Threads may mark one vertex at the same time: they all store the same value.
  void mark(Moves& moves, std::uint32_t v) const {
    const std::size_t i = v - moves.first;  // wraps around below
    if (i >= moves.states.size()) return;
    const std::atomic_ref state(moves.states[i]);
    if (state.load(std::memory_order_relaxed) != MoveState::moved) return;
    state.store(MoveState::to_undo, std::memory_order_relaxed);
  }

  void compute_normals() override {
    IndexedMesh& mesh = piece_.mesh;
    cover(mesh.vertex_count(),
          [&](std::size_t v, Starts& starts) { starts.add(mesh.positions[v].z, 0); });
    mesh.normals.resize(mesh.vertex_count());
    for_all(mesh.vertex_count(), [&](std::size_t v) {
      mesh.normals[v] =
          surface_->surface().normal(mesh.positions[v], mesh.vertex_spheres[v].data());
    });
  }

  std::optional<NearSurface> surface_;
  // Whether midpoints get normals. All ranks say the same, also one that has triangles, but no
  // vertices, and so no normals of its own.
  bool has_normals_ = false;
};

// Beside the mesh of the last level, a rank holds its part of that mesh, starts and states, and the
// parent, which is a quarter as large. Later, while the result is measured, it holds a part and
// what measuring takes.
void check_memory(const Ranks& ranks, const SurfacePiece& piece, const RefineOptions& options) {
  const MeshSize own{piece.numbers.own(), piece.mesh.triangle_count()};
  const auto bytes_at = [&](int levels) {
    const MeshSize size = subdivided(own, levels);
    const std::uint64_t mesh = indexed_mesh_bytes(
                            size, {.labels = piece.labels, .width = LabelWidth::three}),
                        part = sizeof(Vec3d) * size.vertices + sizeof(Triangle) * size.triangles,
                        moves = (sizeof(Vec3d) + 2 * sizeof(SphereId) + 1) * size.vertices;
    return mesh + part + std::max((mesh + part) / 4 + moves, measures_bytes(size));
  };
  const std::uint64_t bytes = bytes_at(options.subdivisions);
  if (bytes <= options.memory_limit) return;
  throw LimitExceeded(fmt::format(
      "{} triangles need {} MiB of memory, {} MiB are allowed to a rank: more ranks than {}, fewer "
      "subdivisions or --memory-limit {}M would do",
      subdivided(own, options.subdivisions).triangles, bytes >> 20, options.memory_limit >> 20,
      ranks.count(), (bytes >> 20) + 1));
}

// A rank numbers the half-edges of its piece by 32 bits, on all levels but the last one.
void check_refinement_of_piece(const Ranks& ranks, const SurfacePiece& piece,
                               const RefineOptions& options) {
  if (piece.labels == TriangleLabels::none && options.projection != Projection::none &&
      options.crossings != Crossings::allow) {
    throw InvalidInput("ranks do not look for triangles that cross: allow crossings");
  }
  const std::uint64_t parents =
      options.subdivisions == 0
          ? 0
          : subdivided({0, piece.mesh.triangle_count()}, options.subdivisions - 1).triangles;
  if (3 * parents > kMaxHalfEdges) {
    throw LimitExceeded(fmt::format(
        "a rank has {} triangles to subdivide, of which {} can be numbered: more ranks or fewer "
        "subdivisions would do",
        parents, kMaxHalfEdges / 3));
  }
  check_memory(ranks, piece, options);
}

}  // namespace

std::vector<ProjectionStats> refine_together(const Ranks& ranks, const SphereSet& spheres,
                                             const RefineOptions& options, SurfacePiece& piece) {
  RefineOptions own = options;
  FieldModel model;
  ranks.together([&] {
    check_refinement_of_piece(ranks, piece, options);
    if (piece.labels == TriangleLabels::none) model = projection_model(options);
    begin_stage(own.monitor, "refine", static_cast<std::uint64_t>(options.subdivisions) + 1);
  });
  if (piece.labels == TriangleLabels::spheres) {
    return constrain_together(ranks, spheres, options, piece);
  }
  CellListFrame frame;
  if (options.projection == Projection::field) {
    frame = frame_together(ranks, spheres, model);
    own.frame = &frame;
  }
  return Refinement(ranks, spheres, own, piece).run();
}

}  // namespace vdwmesh
