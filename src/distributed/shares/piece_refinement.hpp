// What refinements on ranks have in common: the loop over the levels, and the arrays of a level.
// How vertices are placed is for the classes that derive from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/ranks.hpp"
#include "distributed/together/border_mesh.hpp"
#include "distributed/together/edges_together.hpp"
#include "refine/crossings/tally.hpp"
#include "refine/crossings/vertex_moves.hpp"
#include "refine/refiner.hpp"

namespace vdwmesh {

class PieceRefinement {
 public:
  // Keeps references to its arguments.
  PieceRefinement(const Ranks& ranks, const SphereSet& spheres, const RefineOptions& options,
                  SurfacePiece& piece)
      : ranks_(ranks), balls_(spheres.spheres().data()), options_(options), piece_(piece) {}
  virtual ~PieceRefinement() = default;

  // Refines the piece, and returns the counts of all levels, from level 0 on. Collective.
  std::vector<ProjectionStats> run() {
    ranks_.together([&] {
      if (projects()) piece_.mesh.normals = Buffer<Vec3f>();
      piece_.mesh.vertex_spheres.widen();
    });
    std::vector<ProjectionStats> levels{project_given()};
    for (int level = 1; level <= options_.subdivisions; ++level) levels.push_back(subdivide());
    part_ = {};
    ranks_.together([&] {
      if (projects()) compute_normals();
    });
    return levels;
  }

 protected:
  // Level 0. Collective.
  virtual ProjectionStats project_given() = 0;
  // The next level. Collective.
  virtual ProjectionStats subdivide() = 0;
  // Makes the normals of a projected mesh.
  virtual void compute_normals() = 0;

  bool projects() const { return options_.projection != Projection::none; }

  // Makes the triangles of the next level and room for its vertices. Then calls make_midpoints() on
  // every rank, with the edges of the parent, and returns its counts. part_ is that of the parent
  // meanwhile. Its first triangles are the own ones, in the same order. Collective.
  template <class MakeMidpoints>
  ProjectionStats make_level(const MakeMidpoints& make_midpoints) {
    const NumberedEdges edges = number_edges_together(ranks_, piece_);
    const std::vector<std::uint64_t> counts = ranks_.of_all(std::uint64_t{edges.own});
    ProjectionStats stats;
    ranks_.together([&] {
      make_children(edges, counts, piece_);
      piece_.mesh.positions.resize(piece_.numbers.own());
      piece_.mesh.vertex_spheres.resize(piece_.numbers.own(), LabelWidth::three);
      stats = make_midpoints(edges);
    });
    return stats;
  }

  // The local number of the first midpoint of the level made last.
  std::size_t first_midpoint() const { return piece_.numbers.runs().back().begin; }

  // The ends of an own half-edge, as indices in part_.
  std::array<std::uint32_t, 2> ends_of(std::size_t h) const {
    const Triangle& corners = part_.mesh.triangles[h / 3];
    return {corners[h % 3], corners[(h + 1) % 3]};
  }

  // Adds the turned triangles of part_ to the counts of a level on this rank, and returns the sum
  // over all ranks. Collective.
  ProjectionStats end_level(ProjectionStats mine) {
    ranks_.together([&] {
      mine.turned = count_turned(balls_, part_.mesh, part_.triangles);
      advance(options_.monitor, 1);
    });
    ProjectionStats all;
    for (const ProjectionStats& theirs : ranks_.of_all(mine)) all = join(all, theirs);
    return all;
  }

  const Ranks& ranks_;
  const Sphere* balls_;  // of the whole set
  const RefineOptions& options_;
  SurfacePiece& piece_;
  BorderMesh part_;  // of the piece
};

// Refines a surface whose triangles say on which spheres they lie.
// What refine_together() does with such a surface: the piece becomes that of the mesh that
// Refiner::refine() makes, bit for bit. Collective.
std::vector<ProjectionStats> constrain_together(const Ranks& ranks, const SphereSet& spheres,
                                                const RefineOptions& options, SurfacePiece& piece);

}  // namespace vdwmesh
