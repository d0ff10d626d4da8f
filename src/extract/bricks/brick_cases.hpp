// The marching-cubes cases of all 512 cells of a brick, on the CPU. The cases of a row of eight
// cells are computed at once as a 64-bit word with a byte per cell. A table turns the nine signs of
// a row of nodes into such a word, with the two corners that the row gives to cell x in byte x. The
// words of the four rows of nodes around a row of cells are shifted and combined into the cases.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "extract/bricks/brick.hpp"

namespace vdwmesh {

// Packs eight rows of eight bits into one word: the low eight bits of row(y) begin at bit 8 y.
// Higher bits of row(y) are dropped.
template <class Row>
std::uint64_t layer_bits(Row&& row) {
  static_assert(std::endian::native == std::endian::little);
  std::uint8_t rows[kBrickSide];
  for (int y = 0; y < kBrickSide; ++y) rows[y] = static_cast<std::uint8_t>(row(y));
  std::uint64_t bits;
  std::memcpy(&bits, rows, sizeof bits);
  return bits;
}

// Byte x of kSignPairs[row] holds bits x and x + 1 of `row`, nine signs: the two corners that the
// row of nodes gives to cell x.
inline constexpr std::array<std::uint64_t, 1u << kBrickReach> kSignPairs = [] {
  std::array<std::uint64_t, 1u << kBrickReach> pairs{};
  for (std::uint64_t row = 0; row < pairs.size(); ++row) {
    for (int x = 0; x < kBrickSide; ++x) pairs[row] |= (row >> x & 3u) << (8 * x);
  }
  return pairs;
}();

// The cases of all cells of a brick, and which of the cells are mixed, that is, crossed by the
// surface. One pass over the signs prepares both.
class BrickCases {
 public:
  // Computes the cases of a brick with these node signs. Bits 0-3 of a case come from the nodes at
  // z and bits 4-7 from the nodes at z + 1. So pairs(s, y, z + 1) is used for the cells at z and
  // again for the cells at z + 1.
  void set(const BrickSigns& s) {
    std::uint64_t below[kBrickSide];
    for (int y = 0; y < kBrickSide; ++y) below[y] = pairs(s, y, 0);
    for (int z = 0; z < kBrickSide; ++z) {
      for (int y = 0; y < kBrickSide; ++y) {
        const std::uint64_t above = pairs(s, y, z + 1);
        const std::uint64_t row = below[y] | above << 4;
        std::memcpy(cases_.data() + row_begin(y, z), &row, sizeof row);
        below[y] = above;
      }
      mixed_[static_cast<std::size_t>(z)] = layer_bits([&](int y) { return mixed_cells(s, y, z); });
    }
  }

  // The case of cell (x, y, z), as cell_case() computes it.
  std::uint32_t at(int x, int y, int z) const {
    return cases_[row_begin(y, z) + static_cast<std::size_t>(x)];
  }

  // Calls visit(x, y, z, case) for the cells that the surface crosses, x fastest and z slowest.
  // This is the order of the triangles.
  template <class Visit>
  void for_each_mixed(Visit&& visit) const {
    for (int z = 0; z < kBrickSide; ++z) {
      for (std::uint64_t cells = mixed_[static_cast<std::size_t>(z)]; cells != 0;
           cells &= cells - 1) {
        const int cell = std::countr_zero(cells);
        const int x = cell % kBrickSide, y = cell / kBrickSide;
        visit(x, y, z, at(x, y, z));
      }
    }
  }

 private:
  static std::size_t row_begin(int y, int z) {
    return std::size_t{kBrickSide} * static_cast<std::size_t>(kBrickSide * z + y);
  }

  // Byte x: the signs of the four corners of cell x that lie in the plane z.
  static std::uint64_t pairs(const BrickSigns& s, int y, int z) {
    return kSignPairs[s.row[z][y]] | kSignPairs[s.row[z][y + 1]] << 2;
  }

  std::array<std::uint8_t, kBrickNodes> cases_;  // at 64 z + 8 y + x
  std::array<std::uint64_t, kBrickSide> mixed_;  // of each z: bit 8 y + x: cell (x, y, z) is mixed
};

}  // namespace vdwmesh
