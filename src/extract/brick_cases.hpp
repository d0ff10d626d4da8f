// The cases of whole rows of cells at once, a byte each. CPU.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "extract/brick.hpp"

namespace vdwmesh {

// Byte x of pairs[row]: bits x and x + 1 of a row of nine signs.
inline constexpr std::array<std::uint64_t, 1u << kBrickReach> kSignPairs = [] {
  std::array<std::uint64_t, 1u << kBrickReach> pairs{};
  for (std::uint64_t row = 0; row < pairs.size(); ++row) {
    for (int x = 0; x < kBrickSide; ++x) pairs[row] |= (row >> x & 3u) << (8 * x);
  }
  return pairs;
}();

// The cases of the cells x = 0 .. 7 of row (y, z), as cell_case() gives them.
struct RowCases {
  std::uint64_t packed;

  std::uint32_t at(int x) const { return static_cast<std::uint32_t>(packed >> (8 * x)) & 255u; }
};

inline RowCases row_cases(const BrickSigns& s, int y, int z) {
  return {kSignPairs[s.row[z][y]] | kSignPairs[s.row[z][y + 1]] << 2 |
          kSignPairs[s.row[z + 1][y]] << 4 | kSignPairs[s.row[z + 1][y + 1]] << 6};
}

// visit(x, y, z, case) for the cells that the surface crosses, in order, x fastest.
template <class Visit>
inline void for_each_mixed_cell(const BrickSigns& s, Visit&& visit) {
  for (int z = 0; z < kBrickSide; ++z) {
    for (int y = 0; y < kBrickSide; ++y) {
      const std::uint32_t mixed = mixed_cells(s, y, z);
      if (mixed == 0) continue;
      const RowCases cases = row_cases(s, y, z);
      for (std::uint32_t cells = mixed; cells != 0; cells &= cells - 1) {
        const int x = std::countr_zero(cells);
        visit(x, y, z, cases.at(x));
      }
    }
  }
}

}  // namespace vdwmesh
