// The triangles of bricks on the CPU, from what their maps know.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "extract/brick_cases.hpp"
#include "extract/brick_map.hpp"
#include "extract/case_table.hpp"
#include "extract/indexed_mesh.hpp"

namespace vdwmesh {

// What emission reads and writes.
struct Emission {
  const BrickList& bricks;
  IndexedMesh& mesh;  // vertex_spheres and opposite may be empty: then they are left out
};

// Triangles and half-edges, brick by brick.
class TriangleEmitter {
 public:
  explicit TriangleEmitter(const Emission& e)
      : e_(e), table_(case_table()), places_(corner_places()) {}

  // Brick b, whose own vertices are on `edges`.
  void emit(std::size_t b, std::span<const BrickEdge> edges) {
    const ActiveBrick& brick = e_.bricks.bricks[b];
    near_.emplace(e_.bricks, b);
    vertices_.set(edges, e_.bricks.before[b].vertices);
    vertices_.set_neighbours(e_.bricks, brick.signs, *near_);
    emit_corners(brick, e_.bricks.before[b].triangles);
    if (e_.mesh.opposite.empty()) return;
    cells_.fill(brick, table_);
    first_ = 3 * e_.bricks.before[b].triangles;
    for (int z = 0; z < kBrickSide; ++z) {
      for (int y = 0; y < kBrickSide; ++y) {
        for (std::uint32_t cells = mixed_cells(brick.signs, y, z); cells != 0; cells &= cells - 1)
          emit_opposites(std::countr_zero(cells), y, z);
      }
    }
  }

 private:
  static const CornerPlaces& corner_places() {
    static const CornerPlaces places = VertexMap::corner_places(case_table());
    return places;
  }

  static constexpr std::uint32_t kMostCorners = kBrickNodes * kCaseHalfEdges;

  // Copies the corners of a case, those of more triangles than it has as well: what is written
  // beyond them means nothing and is written over.
  void copy_corners(std::uint32_t inside, const std::uint32_t* vertex,
                    std::uint32_t* corner) const {
    constexpr std::uint32_t few = 6;  // corners of two triangles: what most cells have
    const std::uint16_t* place = places_.of[inside];
    for (std::uint32_t h = 0; h < few; ++h) corner[h] = vertex[place[h]];
    if (table_.count(inside) <= few / 3) return;
    for (std::uint32_t h = few; h < kCaseHalfEdges; ++h) corner[h] = vertex[place[h]];
  }

  void emit_corners(const ActiveBrick& brick, std::uint64_t first_triangle) {
    std::uint32_t* corner = corners_.data();
    for_each_mixed_cell(brick.signs, [&](int x, int y, int z, std::uint32_t inside) {
      copy_corners(inside, vertices_.from(VertexMap::place(x, y, z)), corner);
      corner += 3 * table_.count(inside);
    });
    if (brick.triangles == 0) return;
    std::memcpy(e_.mesh.triangles.data() + first_triangle, corners_.data(),
                brick.triangles * sizeof(Triangle));
  }

  std::uint64_t first_half_edge_of(const CellMap::Cell& cell) const {
    return first_ + 3u * cell.triangles_before;
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
      return opposite_half_edge(e_.bricks, table_, *near_, first, x, y, z, cell.inside, h);
    const CellMap::Cell& beyond = cells_.at(next[0], next[1], next[2]);
    return static_cast<std::uint32_t>(first_half_edge_of(beyond) +
                                      table_.at_face(beyond.inside, face ^ 1, slot));
  }

  const Emission& e_;
  const CaseTable& table_;
  const CornerPlaces& places_;
  VertexMap vertices_;
  std::optional<Neighbourhood> near_;  // of the brick at hand
  std::array<std::uint32_t, kMostCorners + kCaseHalfEdges> corners_;
  // Of the brick at hand, for half-edges.
  CellMap cells_;
  std::uint64_t first_ = 0;
};

}  // namespace vdwmesh
