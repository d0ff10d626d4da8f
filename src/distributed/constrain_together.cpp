// The levels of refine/level.cpp for a mesh with labelled triangles, on pieces. The midpoint of an
// edge lies on the spheres of the two triangles beside it. If one of the triangles is of another
// rank, edges_together.hpp has its sphere. The positions of vertices of other ranks come from
// border_mesh.hpp. Vertices do not move once they are made, so nothing has to be taken back.
#include "distributed/constrain_together.hpp"

#include <utility>

#include "core/blocks.hpp"
#include "distributed/border_mesh.hpp"
#include "distributed/children_together.hpp"
#include "distributed/edges_together.hpp"
#include "refine/constraint_formulas.hpp"
#include "refine/subdivision_formulas.hpp"
#include "refine/tally.hpp"
#include "refine/vertex_moves.hpp"

namespace vdwmesh {
namespace {

class ConstrainedRefinement {
 public:
  ConstrainedRefinement(const Ranks& ranks, const SphereSet& spheres, const RefineOptions& options,
                        SurfacePiece& piece)
      : ranks_(ranks), balls_(spheres.spheres().data()), options_(options), piece_(piece) {}

  std::vector<ProjectionStats> run() {
    ranks_.together([&] {
      if (projects()) piece_.mesh.normals = {};
    });
    std::vector<ProjectionStats> levels;
    update_part();
    levels.push_back(end_level([&] { return check_given(); }));
    for (int level = 1; level <= options_.subdivisions; ++level) levels.push_back(subdivide());
    part_ = {};
    ranks_.together([&] { compute_normals(); });
    return levels;
  }

 private:
  bool projects() const { return options_.projection != Projection::none; }

  // The part of the present mesh, with the labels of its own triangles, and normals if it has any.
  // Collective.
  void update_part() {
    part_ = {};
    part_ = make_border_mesh(ranks_, piece_);
    ranks_.together([&] {
      part_.mesh.triangle_spheres = piece_.mesh.triangle_spheres;
      if (projects()) return;
      part_.mesh.normals.resize(part_.mesh.vertex_count());
      for_all(piece_.mesh.normals.size(), [&](std::size_t v) {
        part_.mesh.normals[part_.first_vertex + v] = piece_.mesh.normals[v];
      });
    });
    if (!projects()) part_.halo.refresh(ranks_, part_.mesh.normals);
  }

  // Adds the turned triangles to what `count` counts on this rank, and returns the sum over all
  // ranks. Collective.
  template <class Count>
  ProjectionStats end_level(const Count& count) {
    ProjectionStats mine, all;
    ranks_.together([&] {
      mine = count();
      mine.turned = count_turned(balls_, part_.mesh, part_.triangles);
      advance(options_.monitor, 1);
    });
    for (const ProjectionStats& theirs : ranks_.of_all(mine)) all = join(all, theirs);
    return all;
  }

  // The given vertices stay where they are.
  ProjectionStats check_given() const {
    if (!projects()) return {};
    const IndexedMesh& mesh = piece_.mesh;
    return tally(mesh.vertex_count(), options_.monitor, [&](std::size_t v, ProjectionStats& total) {
      count_residual(sphere_residual(balls_, mesh.vertex_spheres[v], mesh.positions[v]), total);
    });
  }

  ProjectionStats subdivide() {
    const NumberedEdges edges = number_edges_together(ranks_, piece_);
    const std::vector<std::uint64_t> counts = ranks_.of_all(std::uint64_t{edges.own});
    ProjectionStats stats;
    ranks_.together([&] {
      Buffer<SphereId> spheres = piece_.mesh.triangle_spheres;  // of the parent
      make_children(edges, counts, piece_);
      stats = make_midpoints(edges, spheres);
    });
    update_part();
    return end_level([&] { return stats; });
  }

  // part_ is still that of the parent. Its first triangles are the own ones, in the same order.
  ProjectionStats make_midpoints(const NumberedEdges& edges, const Buffer<SphereId>& spheres) {
    IndexedMesh& mesh = piece_.mesh;
    const IndexedMesh& parent = part_.mesh;
    const std::size_t own = piece_.numbers.own(), first = piece_.numbers.runs().back().begin;
    mesh.positions.resize(own);
    mesh.vertex_spheres.resize(own, LabelWidth::three);
    if (!projects()) mesh.normals.resize(own);
    return tally(edges.edge.size(), options_.monitor, [&](std::size_t h, ProjectionStats& stats) {
      if (edges.is_lower[h] == 0) return;
      const Triangle& corners = parent.triangles[h / 3];
      const std::uint32_t a = corners[h % 3], b = corners[(h + 1) % 3];
      const VertexSpheres label = edge_label(spheres[h / 3], edges.other_sphere[h]);
      const std::size_t v = first + edges.edge[h];
      mesh.vertex_spheres.set(v, label);
      if (projects()) {
        mesh.positions[v] =
            constrained_midpoint(balls_, label.data(), parent.positions[a], parent.positions[b]);
        count_residual(sphere_residual(balls_, label, mesh.positions[v]), stats);
      } else {
        mesh.positions[v] = midpoint(parent.positions[a], parent.positions[b]);
        mesh.normals[v] = mean_normal(parent.normals[a], parent.normals[b]);
      }
    });
  }

  void compute_normals() {
    if (!projects()) return;
    IndexedMesh& mesh = piece_.mesh;
    mesh.normals.resize(mesh.vertex_count());
    for_all(mesh.vertex_count(), [&](std::size_t v) {
      const VertexSpheres label = mesh.vertex_spheres[v];
      mesh.normals[v] = constrained_normal(balls_, label.data(), mesh.positions[v]);
    });
  }

  const Ranks& ranks_;
  const Sphere* balls_;  // of the whole set
  const RefineOptions& options_;
  SurfacePiece& piece_;
  BorderMesh part_;
};

}  // namespace

std::vector<ProjectionStats> constrain_together(const Ranks& ranks, const SphereSet& spheres,
                                                const RefineOptions& options, SurfacePiece& piece) {
  return ConstrainedRefinement(ranks, spheres, options, piece).run();
}

}  // namespace vdwmesh
