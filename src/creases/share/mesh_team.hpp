// The processes that make one crease-exact mesh together, as the mesher sees them. Each of them
// meshes the patches of a run of balls. It has arranged these and the balls around them, or all.
// One process alone is a team too. src/distributed/ has the team of all ranks.
//
// All members must call the functions in the same order. Work that may throw is done inside of
// together(), which makes all of them throw; whatever else the mesher does depends on nothing but
// what all of them know, or they tell each other.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "creases/arcs/arc_sampling.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// What one process makes of a mesh, before its vertices have their numbers in the whole. Its own
// vertices are its runs of corners, of points of arcs and of interior points, in this order, and it
// has the triangles of its patches. In the whole mesh all corners come first, then the points of
// all arcs, then the interior points; of each kind, the runs of the processes stand behind each
// other.
struct UnnumberedPiece {
  // A corner of a triangle below the number n of own vertices is one of them, and corner n + i is
  // the vertex elsewhere[i] of another process.
  IndexedMesh mesh;
  std::vector<std::uint64_t> elsewhere;  // numbers in the whole mesh, ascending
  std::array<std::uint64_t, 3> own{};    // how many corners, points of arcs, interior points
};

// The Euler characteristic of a closed surface, and the number of its connected pieces. A vertex
// without triangles counts as a piece.
struct SurfaceTopology {
  std::int64_t euler_characteristic, shells;
  bool operator==(const SurfaceTopology&) const = default;
};
// Of a closed mesh.
SurfaceTopology surface_topology(const IndexedMesh& mesh);

class MeshTeam {
 public:
  virtual ~MeshTeam() = default;
  // How many processes there are, and the number of this one, from 0.
  virtual std::size_t count() const = 0;
  virtual std::size_t number() const = 0;
  // Does `work`, which calls no function of the team but count() and number(), in all processes.
  // If it throws in one, all throw that exception.
  virtual void together(const std::function<void()>& work) const = 0;
  // The requests of all processes, sorted by piece, each piece once (merge_splits()).
  virtual void merge(std::vector<PieceSplit>& splits) const = 0;
  virtual std::uint32_t least(std::uint32_t mine) const = 0;
  virtual std::uint64_t sum(std::uint64_t mine) const = 0;
  // The sum over the processes of lower numbers.
  virtual std::uint64_t sum_before(std::uint64_t mine) const = 0;
  // Sends to_each[p] to process p, and returns what came from each of them.
  virtual std::vector<std::vector<std::uint64_t>> exchange(
      const std::vector<std::vector<std::uint64_t>>& to_each) const = 0;

  // Takes a mesh that was made, in place of the one taken before. If corners were joined, the fans
  // of triangles at its first `joined_corners` vertices are parted (split_fans()).
  virtual void take(UnnumberedPiece&& piece, std::uint64_t joined_corners) = 0;
  // Of the mesh taken last.
  virtual SurfaceTopology topology() = 0;
  // Makes the mesh taken last the result.
  virtual void keep() = 0;
  // The bytes that the result takes here; 0 if there is none yet.
  virtual std::uint64_t kept_bytes() const = 0;
};

}  // namespace vdwmesh
