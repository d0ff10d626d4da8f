// The levels of refine/level.cpp for a mesh with labelled triangles, on pieces. The midpoint of an
// edge lies on the spheres of the two triangles beside it. If one of the triangles is of another
// rank, edges_together.hpp has its sphere. The positions of vertices of other ranks come from
// border_mesh.hpp. Vertices do not move once they are made, so nothing has to be taken back.
#include "core/blocks.hpp"
#include "distributed/shares/piece_refinement.hpp"
#include "refine/crossings/constraint_formulas.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

class ConstrainedRefinement final : public PieceRefinement {
 public:
  using PieceRefinement::PieceRefinement;

 private:
  // The part of the present mesh, with the labels of its own triangles, and normals if it has any.
  // Collective.
  void update_part() {
    part_ = {};
    part_ = copy_border_mesh(ranks_, piece_);
    ranks_.together([&] {
      part_.mesh.triangle_spheres = piece_.mesh.triangle_spheres;
      if (projects()) return;
      part_.mesh.normals.resize(part_.mesh.vertex_count());
      for_all(piece_.mesh.normals.size(),
              [&](std::size_t v) { part_.mesh.normals[v] = piece_.mesh.normals[v]; });
    });
    if (!projects()) part_.halo.refresh(ranks_, part_.mesh.normals);
  }

  ProjectionStats project_given() override {
    ProjectionStats stats;
    update_part();
    ranks_.together([&] { stats = check_given(); });
    return end_level(stats);
  }

  // The given vertices stay where they are.
  ProjectionStats check_given() const {
    if (!projects()) return {};
    const IndexedMesh& mesh = piece_.mesh;
    return tally(mesh.vertex_count(), options_.monitor, [&](std::size_t v, ProjectionStats& total) {
      count_residual(sphere_residual(balls_, mesh.vertex_spheres[v], mesh.positions[v]), total);
    });
  }

  ProjectionStats subdivide() override {
    const ProjectionStats stats =
        make_level([&](const NumberedEdges& edges) { return make_midpoints(edges); });
    update_part();
    return end_level(stats);
  }

  ProjectionStats make_midpoints(const NumberedEdges& edges) {
    IndexedMesh& mesh = piece_.mesh;
    const IndexedMesh& parent = part_.mesh;
    if (!projects()) mesh.normals.resize(mesh.positions.size());
    return tally(edges.edge.size(), options_.monitor, [&](std::size_t h, ProjectionStats& stats) {
      if (edges.is_lower[h] == 0) return;
      const auto [a, b] = ends_of(h);
      const VertexSpheres label = edge_label(parent.triangle_spheres[h / 3], edges.other_sphere[h]);
      const std::size_t v = first_midpoint() + edges.edge[h];
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

  void compute_normals() override {
    IndexedMesh& mesh = piece_.mesh;
    mesh.normals.resize(mesh.vertex_count());
    for_all(mesh.vertex_count(), [&](std::size_t v) {
      const VertexSpheres label = mesh.vertex_spheres[v];
      mesh.normals[v] = constrained_normal(balls_, label.data(), mesh.positions[v]);
    });
  }
};

}  // namespace

std::vector<ProjectionStats> constrain_together(const Ranks& ranks, const SphereSet& spheres,
                                                const RefineOptions& options, SurfacePiece& piece) {
  return ConstrainedRefinement(ranks, spheres, options, piece).run();
}

}  // namespace vdwmesh
