// Marching cubes over bricks on the CPU, for anything that knows the node signs of a brick and the
// vertex on an edge: a Surface has visit(BrickIndex), signs(BrickSigns&) and vertex(CrossedEdge).
// Inlined whole into the loops that core/multiversion.hpp compiles twice.
#pragma once

#include <bit>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "extract/brick_map.hpp"
#include "extract/brick_numbering.hpp"
#include "extract/case_table.hpp"
#include "extract/extractor.hpp"
#include "extract/surface_vertex.hpp"

namespace vdwmesh {

inline void count_triangles(const BrickGeometry& geometry, const CaseTable& table,
                            ActiveBrick& brick) {
  brick.triangles = 0;
  brick.clipped_cells = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      brick.row_triangles[z * kBrickSide + y] = static_cast<std::uint16_t>(brick.triangles);
      const std::uint32_t mixed = mixed_cells(brick.signs, y, z);
      for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
        brick.triangles += table.count(cell_case(brick.signs, std::countr_zero(cells), y, z));
      }
      brick.clipped_cells +=
          static_cast<std::uint32_t>(count_bits(mixed & border_cells(geometry, y, z)));
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

// Appends those of the bricks that hold surface.
template <class Surface>
void count_bricks(Surface& surface, const GridSpec& grid, std::span<const std::uint64_t> keys,
                  std::vector<ActiveBrick>& active) {
  const CaseTable& table = case_table();
  for (const std::uint64_t key : keys) {
    ActiveBrick brick;
    brick.key = key;
    const BrickIndex index = brick_of_key(key);
    surface.visit(index);
    surface.signs(brick.signs);
    count_triangles(brick_geometry(grid, index), table, brick);
    count_vertices(brick);
    if (brick.triangles != 0 || brick.vertices != 0) active.push_back(brick);
  }
}

// What emission reads and writes.
struct Emission {
  const BrickList& bricks;
  IndexedMesh& mesh;  // vertex_spheres and opposite may be empty: then they are left out
};

template <class Surface>
std::uint64_t emit_vertices(const Emission& e, std::size_t b, Surface& surface, VertexMap& map) {
  const ActiveBrick& brick = e.bricks.bricks[b];
  surface.visit(brick_of_key(brick.key));
  std::uint64_t next = e.bricks.before[b].vertices, clamped = 0;
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      const RowCrossings c = row_crossings(brick.signs, y, z);
      for (std::uint32_t nodes = c.nodes(); nodes; nodes &= nodes - 1) {
        const int x = std::countr_zero(nodes);
        const bool inside = (brick.signs.row[z][y] >> x & 1) != 0;
        for (int axis = 0; axis < 3; ++axis) {
          if (!c.has(x, axis)) continue;
          const SurfaceVertex v = surface.vertex(crossed_edge(inside, x, y, z, axis));
          e.mesh.positions[next] = v.position;
          e.mesh.normals[next] = v.normal;
          if (!e.mesh.vertex_spheres.empty()) e.mesh.vertex_spheres[next] = on_sphere(v.sphere);
          clamped += v.clamped ? 1 : 0;
          map.set(x, y, z, axis, static_cast<std::uint32_t>(next));
          ++next;
        }
      }
    }
  }
  return clamped;
}

// Triangles and half-edges of one brick.
class TriangleEmitter {
 public:
  TriangleEmitter(const Emission& e, std::size_t b, VertexMap& vertices)
      : e_(e),
        table_(case_table()),
        signs_(e.bricks.bricks[b].signs),
        first_(3 * e.bricks.before[b].triangles),
        near_(e.bricks, b),
        cells_(e.bricks.bricks[b], table_),
        vertices_(vertices) {}

  void emit() {
    for (int z = 0; z < kBrickSide; ++z) {
      for (int y = 0; y < kBrickSide; ++y) {
        for (std::uint32_t cells = mixed_cells(signs_, y, z); cells != 0; cells &= cells - 1) {
          const int x = std::countr_zero(cells);
          emit_corners(x, y, z);
          if (!e_.mesh.opposite.empty()) emit_opposites(x, y, z);
        }
      }
    }
  }

 private:
  std::uint64_t first_half_edge_of(const CellMap::Cell& cell) const {
    return first_ + 3u * cell.triangles_before;
  }

  void emit_corners(int x, int y, int z) {
    const CellMap::Cell& cell = cells_.at(x, y, z);
    // The corners of all triangles follow each other.
    std::uint32_t* corner =
        reinterpret_cast<std::uint32_t*>(e_.mesh.triangles.data()) + first_half_edge_of(cell);
    const std::uint8_t* edges = table_.edges[cell.inside];
    const int place = VertexMap::place(x, y, z);
    for (std::uint32_t h = 0; h < 3 * table_.count(cell.inside); ++h)
      corner[h] = vertices_.of_cell(e_.bricks, near_, place, x, y, z, edges[h]);
  }

  void emit_opposites(int x, int y, int z) {
    const CellMap::Cell& cell = cells_.at(x, y, z);
    const std::uint64_t first = first_half_edge_of(cell);
    for (std::uint32_t h = 0; h < 3 * table_.count(cell.inside); ++h)
      e_.mesh.opposite[first + h] = opposite(cell, first, x, y, z, static_cast<int>(h));
  }

  // As opposite_half_edge(), but the cells of this brick need no search.
  std::uint32_t opposite(const CellMap::Cell& cell, std::uint64_t first, int x, int y, int z,
                         int h) {
    const int code = table_.across_code(cell.inside, h);
    if (code < kFirstFaceCode)
      return static_cast<std::uint32_t>(first + static_cast<unsigned>(code));
    const int face = (code - kFirstFaceCode) / 4, slot = (code - kFirstFaceCode) % 4;
    int next[3] = {x, y, z};
    int& moved = next[face / 2];
    moved += face % 2 == 0 ? -1 : 1;
    if (moved < 0 || moved >= kBrickSide)
      return opposite_half_edge(e_.bricks, table_, near_, first, x, y, z, cell.inside, h);
    const CellMap::Cell& beyond = cells_.at(next[0], next[1], next[2]);
    return static_cast<std::uint32_t>(first_half_edge_of(beyond) +
                                      table_.at_face(beyond.inside, face ^ 1, slot));
  }

  const Emission& e_;
  const CaseTable& table_;
  const BrickSigns& signs_;
  std::uint64_t first_;  // half-edge of the brick
  Neighbourhood near_;
  CellMap cells_;
  VertexMap& vertices_;
};

// Vertices and triangles of bricks [begin, end); returns how many vertices were clamped.
template <class Surface>
std::uint64_t emit_bricks(const Emission& e, std::size_t begin, std::size_t end, Surface& surface) {
  std::uint64_t clamped = 0;
  VertexMap vertices;
  for (std::size_t b = begin; b < end; ++b) {
    vertices.clear();
    clamped += emit_vertices(e, b, surface, vertices);
    TriangleEmitter(e, b, vertices).emit();
  }
  return clamped;
}

// The loops over one kind of surface, called from many threads.
struct BrickLoops {
  std::function<void(std::span<const std::uint64_t> keys, std::vector<ActiveBrick>& active)> count;
  std::function<std::uint64_t(const Emission&, std::size_t begin, std::size_t end)> emit;
};

enum class Labels { none, spheres };

// Counts the candidates (keys, rising), numbers what they hold and emits it, on all cores; throws
// LimitExceeded before it takes memory for the mesh. `candidates` gives the keys and its memory up.
ExtractResult mesh_bricks(const GridSpec& grid,
                          const std::function<std::vector<std::uint64_t>()>& candidates,
                          const BrickLoops& loops, Labels labels, const ExtractOptions& options);

}  // namespace vdwmesh
