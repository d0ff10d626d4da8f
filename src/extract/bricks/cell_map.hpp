// A table (map) of the cells of one brick and of the cells beyond its six faces, so that the CPU
// finds the opposite of a half-edge with two look-ups: the cell that has it, and its number within
// that cell's case. Only cells that the surface crosses are set; no others are read.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "extract/bricks/brick_cases.hpp"
#include "extract/bricks/brick_numbering.hpp"
#include "extract/bricks/case_table.hpp"

namespace vdwmesh {

// How to go from a half-edge to its opposite without branches: its code (CaseTable::across) gives
// the step to the cell that has the opposite; the code and that cell's case give its number there.
struct OppositeTable {
  static constexpr std::size_t kCodes = kFirstFaceCode + 24;
  std::uint8_t code[256][kCaseHalfEdges];  // CaseTable::across; 0 beyond the case's half-edges
  std::int16_t step[kCodes];               // difference of map indices; 0: the same cell
  std::uint8_t half_edge[256][kCodes];     // [case of the cell stepped to][code]: the opposite
};

class CellMap {
 public:
  struct Cell {
    std::uint32_t first_half_edge, inside;  // its number in the mesh; the case of the cell
  };
  // Map index of a cell; its coordinates are -1 .. 8, and -1 and 8 are in neighbouring bricks.
  static constexpr int place(int x, int y, int z) {
    return ((z + 1) * kSide + y + 1) * kSide + x + 1;
  }
  static OppositeTable opposite_places(const CaseTable& table);

  // Sets the cells of brick b and those beyond its faces. near(slot) returns the index in the list
  // of a neighbour, as NeighbourCache does; it is called only if the surface crosses the face.
  template <class Neighbour>
  void fill(const BrickList& list, std::uint64_t b, const BrickCases& cases, const CaseTable& table,
            Neighbour&& near);
  const Cell* from(int place) const { return &cell_[static_cast<std::size_t>(place)]; }

 private:
  static constexpr int kSide = kBrickSide + 2;
  static constexpr int kLast = kBrickSide - 1;

  // Sets one cell. `triangles_before` is the number in the mesh of its first triangle.
  void put(int x, int y, int z, std::uint64_t triangles_before, std::uint32_t inside) {
    cell_[static_cast<std::size_t>(place(x, y, z))] = {
        static_cast<std::uint32_t>(3 * triangles_before), inside};
  }
  // Sets a row of cells along x beyond the lower (side 0) or upper (side 1) face across `axis`, 1
  // or 2. `along` is the row's coordinate along the other of these two axes.
  void put_row(const BrickList& list, std::uint64_t neighbour, const CaseTable& table, int axis,
               int side, int along);
  // Sets the cell of row (y, z) beyond the lower (side 0) or upper (side 1) face across x.
  void put_end(const BrickList& list, std::uint64_t neighbour, const CaseTable& table, int side,
               int y, int z);
  std::array<Cell, static_cast<std::size_t>(kSide* kSide* kSide)> cell_;
};

inline OppositeTable CellMap::opposite_places(const CaseTable& table) {
  constexpr int strides[3] = {1, kSide, kSide * kSide};
  OppositeTable places{};
  for (std::uint32_t inside = 0; inside < 256; ++inside) {
    for (std::uint32_t h = 0; h < 3 * table.count(inside); ++h)
      places.code[inside][h] =
          static_cast<std::uint8_t>(table.across_code(inside, static_cast<int>(h)));
    for (std::uint8_t code = 0; code < kFirstFaceCode; ++code)
      places.half_edge[inside][code] = code;  // of the same cell: the code is the half-edge
    for (int face = 0; face < 6; ++face) {    // face ^ 1: the face as the cell beyond it numbers it
      for (int slot = 0; slot < 4; ++slot)
        places.half_edge[inside][kFirstFaceCode + 4 * face + slot] =
            static_cast<std::uint8_t>(table.at_face(inside, face ^ 1, slot));
    }
  }
  for (int face = 0; face < 6; ++face) {
    const int step = face % 2 == 0 ? -strides[face / 2] : strides[face / 2];
    std::fill_n(places.step + kFirstFaceCode + std::ptrdiff_t{4} * face, 4,
                static_cast<std::int16_t>(step));
  }
  return places;
}

// Bit i is set if the surface crosses the cell face between nodes i and i + 1 of two adjacent rows.
inline std::uint32_t mixed_faces(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t any = a | b, all = a & b;
  return (any | any >> 1) & ~(all & all >> 1) & ((1u << kBrickSide) - 1);
}

template <class Neighbour>
void CellMap::fill(const BrickList& list, std::uint64_t b, const BrickCases& cases,
                   const CaseTable& table, Neighbour&& near) {
  std::uint64_t triangles = list.before[b].triangles;
  cases.for_each_mixed([&](int x, int y, int z, std::uint32_t inside) {
    put(x, y, z, triangles, inside);
    triangles += table.count(inside);
  });
  const BrickSigns& signs = list.bricks[b].signs;
  for (int side = 0; side < 2; ++side) {
    const int node = side * kBrickSide, to = 2 * side - 1;  // the face's nodes; brick offset
    std::uint32_t column[kBrickReach] = {};  // bit y of column[z]: sign of node (x = node, y, z)
    for (int z = 0; z < kBrickReach; ++z) {
      for (int y = 0; y < kBrickReach; ++y) column[z] |= (signs.row[z][y] >> node & 1u) << y;
    }
    for (int i = 0; i < kBrickSide; ++i) {
      for (std::uint32_t rows = mixed_faces(column[i], column[i + 1]); rows != 0; rows &= rows - 1)
        put_end(list, near(neighbour_slot(to, 0, 0)), table, side, std::countr_zero(rows), i);
      if (mixed_faces(signs.row[i][node], signs.row[i + 1][node]) != 0)
        put_row(list, near(neighbour_slot(0, to, 0)), table, 1, side, i);
      if (mixed_faces(signs.row[node][i], signs.row[node][i + 1]) != 0)
        put_row(list, near(neighbour_slot(0, 0, to)), table, 2, side, i);
    }
  }
}

inline void CellMap::put_row(const BrickList& list, std::uint64_t neighbour, const CaseTable& table,
                             int axis, int side, int along) {
  const ActiveBrick& owner = list.bricks[neighbour];
  const int theirs = side == 0 ? kLast : 0, ours = side == 0 ? -1 : kBrickSide;
  const int y = axis == 1 ? theirs : along, z = axis == 1 ? along : theirs;
  std::uint64_t triangles =
      list.before[neighbour].triangles + owner.row_triangles[z * kBrickSide + y];
  for (std::uint32_t cells = mixed_cells(owner.signs, y, z); cells != 0; cells &= cells - 1) {
    const int x = std::countr_zero(cells);
    const std::uint32_t inside = cell_case(owner.signs, x, y, z);
    put(x, axis == 1 ? ours : y, axis == 1 ? z : ours, triangles, inside);
    triangles += table.count(inside);
  }
}

inline void CellMap::put_end(const BrickList& list, std::uint64_t neighbour, const CaseTable& table,
                             int side, int y, int z) {
  const ActiveBrick& owner = list.bricks[neighbour];
  const std::uint64_t before = list.before[neighbour].triangles;
  const int row = z * kBrickSide + y;
  if (side == 1) {
    put(kBrickSide, y, z, before + owner.row_triangles[row], cell_case(owner.signs, 0, y, z));
    return;
  }
  // The triangles of the row's last cell end where the next row begins.
  const std::uint32_t end =
      row + 1 < kBrickSide * kBrickSide ? owner.row_triangles[row + 1] : owner.triangles;
  const std::uint32_t inside = cell_case(owner.signs, kLast, y, z);
  put(-1, y, z, before + end - table.count(inside), inside);
}

}  // namespace vdwmesh
