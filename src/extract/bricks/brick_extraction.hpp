// Marching cubes over bricks on the CPU: template loops that count and emit bricks one after the
// other. BrickMesher (brick_mesher.hpp) runs them on all cores and numbers the mesh.
//
// The loops are templates over a Surface, a class that knows the node signs of a brick and the
// vertices on its edges. It has visit(BrickIndex), which moves it to a brick, signs(BrickSigns&),
// and vertices(edges, put), which calls put(i, vertex) for every edge i of a BrickEdges. The
// callers of the loops are marked VDWMESH_MULTIVERSION: the loops are inlined into them and
// compiled for two processor versions (core/lanes/multiversion.hpp).
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

// Sets row_triangles, the triangles in the rows of cells before each row, and `triangles`, those of
// all rows.
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

// Whether all 9 x 9 x 9 signs are alike, so that the brick holds no surface.
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

// Counts the bricks with these keys and writes those that hold surface from `out` on, in the order
// of the keys; returns their number. `out` must have space for all keys: each brick is written to
// the next free element, which the next brick overwrites if the brick holds no surface.
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

// Counts that are made while vertices and triangles are emitted.
struct EmissionTally {
  std::uint64_t clamped = 0;  // vertices that were clamped
  // Number of lower faces of bricks that the surface crosses, less the number of upper ones. The
  // emission looks up the brick beyond every crossed upper face and throws if there is none. So
  // each crossed upper face is the lower face of another brick, and a total of 0 over the whole
  // mesh says that each crossed lower face has a brick below it, too.
  std::int64_t unmatched_faces = 0;

  void add(const EmissionTally& other) {
    clamped += other.clamped;
    unmatched_faces += other.unmatched_faces;
  }
};

// Writes the vertices of brick b of the list and returns how many of them were clamped. Leaves the
// crossed edges of the brick in `edges`.
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

// Writes the vertices and triangles of bricks [begin, end) of the list e.bricks.
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

// The two loops for one kind of surface: functions that call count_bricks() and emit_bricks() with
// a Surface of that kind. Many threads call them at once, so each call must make its own Surface.
struct BrickLoops {
  std::function<std::size_t(std::span<const std::uint64_t> keys, ActiveBrick* out)> count;
  std::function<EmissionTally(const Emission&, std::size_t begin, std::size_t end)> emit;
};

}  // namespace vdwmesh
