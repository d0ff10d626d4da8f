// Marching cubes over a list of bricks on all cores of the CPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/buffer.hpp"
#include "extract/bricks/brick_extraction.hpp"
#include "extract/extractor.hpp"

namespace vdwmesh {

class Workspace;

// The result of counting: the memory behind a BrickList, which a Workspace keeps.
struct CountedBricks {
  Buffer<ActiveBrick> bricks;     // the bricks that hold surface, by rising key
  std::vector<BrickSums> before;  // BrickList::before
  // Indices into `bricks`: [begin, end) is the range to be meshed. The bricks around it, its halo,
  // are only counted, because triangles of the range refer to their vertices and triangles.
  std::size_t begin = 0, end = 0;
};

// Returns the keys of the bricks that may hold surface, in rising order.
using CandidateSearch = std::function<std::vector<std::uint64_t>()>;

// Marching cubes over a list of bricks in three steps: count what each brick holds, number it by
// prefix sums, emit it. All cores take part in each step.
class BrickMesher {
 public:
  // `width` says how many sphere ids label a vertex. The workspace keeps the CountedBricks.
  BrickMesher(const GridSpec& grid, BrickLoops loops, LabelWidth width,
              const ExtractOptions& options, Workspace& workspace);

  // Counts and numbers the candidates: the bricks of `own` and of its halo (brick_search.hpp) that
  // may hold surface. Only the bricks of `own` will be emitted. The default is all bricks.
  // `halo_room` is the most bricks that set_halo() will add; room is made for them, but not for
  // many more than there are candidates.
  void count(const CandidateSearch& candidates, const KeyRange& own = {},
             std::uint64_t halo_room = 0);

  // What was counted in the bricks of a range.
  std::span<const ActiveBrick> counted(const KeyRange& range) const;
  // Adds a halo behind the range that count() was given and has counted alone. It comes in parts,
  // one behind the other.
  void set_halo(std::span<const std::vector<ActiveBrick>> parts);

  // The vertices and triangles of the bricks in the range that count() was given.
  MeshSize size() const;
  // The vertices of the bricks around the range.
  HaloVertices halo() const;

  // Throws LimitExceeded if a mesh of size() exceeds a limit (check_mesh_limits()). The memory that
  // the counts take is added to the memory of the mesh.
  void check_limits() const;

  // Gives the mesh arrays of size() and emits the bricks of the range that count() was given into
  // them. `first` is the number of vertices and triangles before them, as for SurfacePart::emit().
  // Throws InternalError if the surface continues through an upper face or edge of a brick into a
  // brick that is no candidate.
  void emit(const MeshSize& first, IndexedMesh& mesh);

  // The counts of bricks and clipped cells are set by count(), the other counts by emit(), and the
  // seconds by both.
  const ExtractStats& stats() const { return stats_; }

 private:
  MeshArrays arrays() const;

  GridSpec grid_;
  BrickLoops loops_;
  LabelWidth width_;
  ExtractOptions options_;
  CountedBricks& counted_;
  std::uint64_t naming_triangles_ = 0;  // see HaloVertices
  ExtractStats stats_;
};

// Makes a whole mesh from its candidates: counts, checks the limits before the mesh takes memory,
// calls options.on_size with the size, and emits. Throws InternalError if the surface leaves a
// brick for one that is no candidate.
void mesh_bricks(ExtractResult& result, const GridSpec& grid, const CandidateSearch& candidates,
                 const BrickLoops& loops, LabelWidth width, const ExtractOptions& options,
                 Workspace& workspace);

}  // namespace vdwmesh
