// The cases of a brick's cells, whole rows at once, a byte each. CPU.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "extract/bricks/brick.hpp"

namespace vdwmesh {

// Eight rows of eight bits in one word, row(y) from bit 8 y on.
template <class Row>
std::uint64_t layer_bits(Row&& row) {
  static_assert(std::endian::native == std::endian::little);
  std::uint8_t rows[kBrickSide];
  for (int y = 0; y < kBrickSide; ++y) rows[y] = static_cast<std::uint8_t>(row(y));
  std::uint64_t bits;
  std::memcpy(&bits, rows, sizeof bits);
  return bits;
}

// Byte x of pairs[row]: bits x and x + 1 of a row of nine signs.
inline constexpr std::array<std::uint64_t, 1u << kBrickReach> kSignPairs = [] {
  std::array<std::uint64_t, 1u << kBrickReach> pairs{};
  for (std::uint64_t row = 0; row < pairs.size(); ++row) {
    for (int x = 0; x < kBrickSide; ++x) pairs[row] |= (row >> x & 3u) << (8 * x);
  }
  return pairs;
}();

// The cases of all cells of a brick, and which of them the surface crosses. Cells of a layer are
// numbered 8 y + x.
class BrickCases {
 public:
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

  // As cell_case().
  std::uint32_t at(int x, int y, int z) const {
    return cases_[row_begin(y, z) + static_cast<std::size_t>(x)];
  }

  // visit(x, y, z, case) for the cells that the surface crosses, in order, x fastest.
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

  static std::uint64_t pairs(const BrickSigns& s, int y, int z) {
    return kSignPairs[s.row[z][y]] | kSignPairs[s.row[z][y + 1]] << 2;
  }

  std::array<std::uint8_t, kBrickNodes> cases_;
  std::array<std::uint64_t, kBrickSide> mixed_;
};

}  // namespace vdwmesh
