// Writes corners, arcs and patches to their places in the mesh of a union, or in the piece of it
// that one process of several has.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "complex/placed_balls.hpp"
#include "creases/arcs/patch_boundary.hpp"
#include "creases/patch/patch_mesher.hpp"
#include "creases/share/mesh_borders.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// Vertices of arcs and corners have the numbers that the sampling has given them. In the piece, the
// corners of the share come first, then the points of its arcs (UnnumberedPiece). The mesh needs
// room for all, and kPatchArrays. Keeps references to its arguments.
class MeshPlacement {
 public:
  MeshPlacement(const PlacedBalls& balls, const BoundaryArcs& boundary, const ArcSampling& sampling,
                const PatchIndex& index, const MeshShare& share)
      : t_(balls),
        boundary_(boundary),
        sampling_(sampling),
        index_(index),
        share_(share),
        unit_(std::ldexp(1.0, t_.scale_exponent)),
        first_point_(sampling.first_vertex(share.arcs.first)),
        points_(sampling.first_vertex(share.arcs.second) - first_point_) {}

  // How many corners the share has, and points between the ends of its arcs.
  std::uint32_t corners() const { return share_.corners.second - share_.corners.first; }
  std::uint32_t points() const { return points_; }

  // Finds the corners and points of arcs of other shares that patches of this one have. To be
  // called before anything is placed. `has_patch` tells the balls with a patch. The piece has
  // `own_vertices` vertices, and those elsewhere come behind them.
  void find_elsewhere(const std::function<bool(std::uint32_t ball)>& has_patch,
                      std::uint64_t own_vertices);
  const std::vector<std::uint64_t>& elsewhere() const { return elsewhere_; }

  // Both on all cores.
  void place_corners(IndexedMesh& mesh) const;
  void place_arcs(IndexedMesh& mesh) const;
  // What they place, for a device that places the boundary of a whole mesh itself.
  const BoundaryArcs& boundary() const { return boundary_; }
  const ArcSampling& sampling() const { return sampling_; }
  const PlacedBalls& balls() const { return t_; }
  // Å for each unit of the balls' lengths.
  double unit() const { return unit_; }
  // Writes the interior vertices of the patch of a ball, from vertex first_vertex on, and its
  // triangles, from first_triangle on. The patch has its sources.
  void place_patch(const PatchMesh& patch, std::uint32_t ball, std::uint64_t first_vertex,
                   std::uint64_t first_triangle, IndexedMesh& mesh) const;

 private:
  // Whether the share has all corners and arcs.
  bool is_whole() const;
  bool is_own(std::uint32_t number) const;
  // The vertex of the piece with this number of a corner or a point of an arc.
  std::uint32_t local(std::uint32_t number) const;
  void place(const Vec3d& p, const std::array<std::uint32_t, 3>& balls, std::size_t vertex,
             IndexedMesh& mesh) const;
  // From scaled lengths to Å. The scale is a power of two, so this does not round.
  Vec3d unscaled(const Vec3d& p) const { return unit_ * p; }

  const PlacedBalls& t_;
  const BoundaryArcs& boundary_;
  const ArcSampling& sampling_;
  const PatchIndex& index_;
  const MeshShare& share_;
  double unit_;  // of scaled lengths, in Å: a power of two
  std::uint32_t first_point_,
      points_;  // of the arcs of the share: number of the first, and how many
  std::uint64_t own_vertices_ = 0;
  std::vector<std::uint64_t> elsewhere_;  // numbers, ascending
};

}  // namespace vdwmesh
