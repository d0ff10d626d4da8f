// Pairs of intersecting triangles at hubs, the vertices of very many triangles. The boxes of all
// triangles of a star overlap at its hub, so a search by boxes (facet_tree.hpp) would look at all
// pairs of them. Here they are searched by their directions from the hub.
//
// As seen from the hub, a triangle of its star is an arc of directions, and fills the cone over the
// arc near the hub. Two triangles that share the hub alone intersect elsewhere only if their cones
// have a direction in common. A triangle outside of the star is seen as a triangle of directions;
// where it intersects one of the star, the cones over both have a direction in common as well.
//
// A plane through the hub that has one cone on one side, and the box around the ends of arcs on the
// other, separates them. The planes tried are those of the sides of a triangle's cone. They are
// computed in double and then taken as they are: turned away from the cone by kTurn, with all ends
// beyond a margin for certain, so that no pair is lost. A cone that is too wide for that excludes
// nothing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/crossings/facet_pair.hpp"
#include "analysis/mesh_measures.hpp"
#include "core/buffer.hpp"
#include "core/no_index.hpp"
#include "spheres/box.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// By triangle, the lowest of its vertices that are hubs, or kNoIndex. Empty if there are no hubs. A
// vertex of 512 triangles nearly always is one, and one of fewer than 32 never: one triangle of
// eight is counted. Which are hubs changes what a search takes, not what it finds.
Buffer<std::uint32_t> hubs_of_triangles(const IndexedMesh& mesh);

// The planes through the hub by which the cone of a triangle is told from others.
class HubCone {
 public:
  // From the directions of the corners beside the hub, two or three.
  explicit HubCone(std::span<const Vec3d> ends);
  // Whether no direction within the box is in the cone, for certain.
  bool excludes(const Box& directions) const;

 private:
  void try_plane(const Vec3d& normal, const Vec3d& axis, std::span<const Vec3d> ends);

  std::array<Vec3d, 6> normals_;  // away from the cone
  std::size_t count_ = 0;
};

// Some triangles of the star of a hub, in a tree.
class HubStar {
 public:
  // Triangles without an area are left out. Precondition: all triangles have the vertex `hub`.
  HubStar(const IndexedMesh& mesh, std::uint32_t hub, std::span<const std::uint32_t> triangles);

  std::size_t size() const { return spokes_.size(); }
  // The box around all triangles, Å.
  const Box& box() const { return box_; }
  // Appends the pairs of triangle `place` of the tree and those behind it.
  void join_own(std::size_t place, Monitor* monitor, TrianglePairs& found) const;
  // Appends the pairs of the star and a triangle without its hub.
  void join_other(std::uint32_t triangle, Monitor* monitor, TrianglePairs& found) const;

 private:
  struct Spoke {
    std::array<Vec3d, 2> ends;  // directions of the other corners; not a number if there is none
    std::uint32_t triangle;
  };
  struct StarNode {
    Box directions, box;             // of the ends; around the triangles, Å
    std::uint32_t first, end, next;  // spokes; the node behind all that are below this one
  };

  Vec3d direction_of(std::uint32_t vertex) const;
  Facet facet_of(std::uint32_t triangle) const;
  void build(std::uint32_t first, std::uint32_t end);
  void join(const HubCone& cone, std::uint32_t triangle, std::size_t from, Monitor* monitor,
            TrianglePairs& found) const;

  const IndexedMesh& mesh_;
  std::uint32_t hub_;
  Box box_ = empty_box();
  std::vector<Spoke> spokes_;
  std::vector<StarNode> nodes_;  // the root first, and each before those below it
};

}  // namespace vdwmesh
