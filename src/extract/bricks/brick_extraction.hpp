// Marching cubes over bricks on the CPU, for anything that knows the node signs of a brick and the
// vertices on its edges: a Surface has visit(BrickIndex), signs(BrickSigns&) and vertices(edges,
// put). Inlined whole into the loops that core/multiversion.hpp compiles twice.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "extract/bricks/brick_cases.hpp"
#include "extract/bricks/brick_edges.hpp"
#include "extract/bricks/brick_numbering.hpp"
#include "extract/bricks/case_table.hpp"
#include "extract/bricks/edge_vertex.hpp"
#include "extract/bricks/triangle_emitter.hpp"
#include "extract/extractor.hpp"

namespace vdwmesh {

// Before each row, and in all.
inline void count_triangles(const CaseTable& table, const BrickCases& cases, ActiveBrick& brick) {
  std::uint16_t of_row[kBrickSide * kBrickSide] = {};
  cases.for_each_mixed([&](int, int y, int z, std::uint32_t inside) {
    std::uint16_t& count = of_row[z * kBrickSide + y];
    count = static_cast<std::uint16_t>(count + table.count(inside));
  });
  std::uint32_t triangles = 0;
  for (int row = 0; row < kBrickSide * kBrickSide; ++row) {
    brick.row_triangles[row] = static_cast<std::uint16_t>(triangles);
    triangles += of_row[row];
  }
  brick.triangles = triangles;
}

inline void count_clipped_cells(const BrickGeometry& geometry, ActiveBrick& brick) {
  brick.clipped_cells = 0;
  if (!geometry.has_virtual_nodes()) return;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      brick.clipped_cells += static_cast<std::uint32_t>(
          count_bits(mixed_cells(brick.signs, y, z) & border_cells(geometry, y, z)));
    }
  }
}

inline void count_vertices(ActiveBrick& brick) {
  int vertices = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      brick.row_vertices[z * kBrickSide + y] = static_cast<std::uint16_t>(vertices);
      vertices += vertex_count(row_crossings(brick.signs, y, z));
    }
  }
  brick.vertices = static_cast<std::uint32_t>(vertices);
}

// Whether all signs are alike, so that the brick holds no surface.
inline bool is_uniform(const BrickSigns& signs) {
  constexpr std::uint32_t all = (1u << kBrickReach) - 1;
  std::uint32_t any = 0, every = all;
  for (const auto& layer : signs.row) {
    for (const std::uint16_t row : layer) {
      any |= row;
      every &= row;
    }
  }
  return any == 0 || every == all;
}

// Writes those of the bricks that hold surface from `out` on, which has room for all; returns how
// many.
template <class Surface>
std::size_t count_bricks(Surface& surface, const GridSpec& grid,
                         std::span<const std::uint64_t> keys, ActiveBrick* out) {
  const CaseTable& table = case_table();
  const ActiveBrick* const first = out;
  BrickCases cases;
  for (const std::uint64_t key : keys) {
    ActiveBrick& brick = *out;
    brick.key = key;
    const BrickIndex index = brick_of_key(key);
    surface.visit(index);
    surface.signs(brick.signs);
    if (is_uniform(brick.signs)) continue;
    cases.set(brick.signs);
    count_triangles(table, cases, brick);
    count_clipped_cells(brick_geometry(grid, index), brick);
    count_vertices(brick);
    out += brick.triangles != 0 || brick.vertices != 0 ? 1 : 0;
  }
  return static_cast<std::size_t>(out - first);
}

// What is noticed while vertices and triangles are made.
struct EmissionTally {
  std::uint64_t clamped = 0;  // vertices
  // Lower faces of bricks that the surface crosses, less upper ones. Every upper one has the brick
  // beyond it looked up, so that 0 in all says that every lower one has its brick as well.
  std::int64_t unmatched_faces = 0;

  void add(const EmissionTally& other) {
    clamped += other.clamped;
    unmatched_faces += other.unmatched_faces;
  }
};

template <class Surface>
std::uint64_t emit_vertices(const Emission& e, std::size_t b, Surface& surface, BrickEdges& edges) {
  const ActiveBrick& brick = e.bricks.bricks[b];
  const std::uint64_t first = e.bricks.before[b].vertices - e.first.vertices;
  std::uint64_t clamped = 0;
  edges.gather(brick.signs);
  surface.visit(brick_of_key(brick.key));
  surface.vertices(edges, [&](std::size_t i, const EdgeVertex& v) {
    e.mesh.positions[first + i] = v.position;
    if (!e.mesh.normals.empty()) e.mesh.normals[first + i] = v.normal;
    if (!e.mesh.vertex_spheres.empty()) e.mesh.vertex_spheres.atoms[first + i] = v.sphere;
    clamped += v.clamped ? 1 : 0;
  });
  return clamped;
}

// The bricks that hold surface, and the number of vertices and triangles before each, and in all.
struct CountedBricks {
  Buffer<ActiveBrick> bricks;      // by rising key
  std::vector<BrickSums> before;   // one more than bricks
  std::size_t begin = 0, end = 0;  // those of the range that is meshed; the others are its halo
};

// Vertices and triangles of bricks [begin, end).
template <class Surface>
EmissionTally emit_bricks(const Emission& e, std::size_t begin, std::size_t end, Surface& surface) {
  EmissionTally tally;
  BrickEdges edges;
  TriangleEmitter triangles(e);
  for (std::size_t b = begin; b < end; ++b) {
    tally.clamped += emit_vertices(e, b, surface, edges);
    const CrossedFaces faces = crossed_faces(e.bricks.bricks[b].signs);
    triangles.emit(b, edges.all(), faces);
    tally.unmatched_faces += count_bits(faces.lower) - count_bits(faces.upper);
  }
  return tally;
}

// The loops over one kind of surface, called from many threads.
struct BrickLoops {
  // As count_bricks().
  std::function<std::size_t(std::span<const std::uint64_t> keys, ActiveBrick* out)> count;
  std::function<EmissionTally(const Emission&, std::size_t begin, std::size_t end)> emit;
};

// Gives the keys of the bricks that may hold surface, rising.
using CandidateSearch = std::function<std::vector<std::uint64_t>()>;

// Marching cubes over a list of bricks in three steps: count what each brick holds, number it by
// prefix sums, emit it. All cores take part in each step.
class BrickMesher {
 public:
  // `width` is that of the labels of vertices. Bricks and sums stand in memory of the workspace.
  BrickMesher(const GridSpec& grid, BrickLoops loops, LabelWidth width,
              const ExtractOptions& options, Workspace& workspace);

  // Counts and numbers the candidates, which are the bricks of `own` that may hold surface and, if
  // `own` is not everything, those of with_halo(own).
  void count(const CandidateSearch& candidates, const KeyRange& own = {});

  // What the bricks of the range hold that count() was given.
  MeshSize size() const;

  // Throws LimitExceeded if a mesh of that size is beyond the limits of the options, in which what
  // counting holds beside it is included.
  void check_limits() const;

  // Emits the bricks of that range into a mesh that has room for them; `first` as for
  // SurfacePart::emit.
  // Throws InternalError where the surface runs on into a brick that is no candidate.
  void emit(const MeshSize& first, IndexedMesh& mesh);

  // Gives the mesh its arrays, then emits.
  void make_room_and_emit(const MeshSize& first, IndexedMesh& mesh);

  // Counts since count(), seconds since the constructor.
  const ExtractStats& stats() const { return stats_; }

 private:
  MeshArrays arrays() const;

  GridSpec grid_;
  BrickLoops loops_;
  LabelWidth width_;
  ExtractOptions options_;
  CountedBricks& counted_;
  ExtractStats stats_;
};

// A whole mesh from its candidates: counts, checks the limits before it takes memory, tells
// options.on_size, and emits.
void mesh_bricks(ExtractResult& result, const GridSpec& grid, const CandidateSearch& candidates,
                 const BrickLoops& loops, LabelWidth width, const ExtractOptions& options,
                 Workspace& workspace);

}  // namespace vdwmesh
