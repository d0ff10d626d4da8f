// The triangles of one brick on the CPU, from what its map knows.
#pragma once

#include <bit>
#include <cstdint>

#include "extract/brick_map.hpp"
#include "extract/case_table.hpp"
#include "extract/indexed_mesh.hpp"

namespace vdwmesh {

// What emission reads and writes.
struct Emission {
  const BrickList& bricks;
  IndexedMesh& mesh;  // vertex_spheres and opposite may be empty: then they are left out
};

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

}  // namespace vdwmesh
