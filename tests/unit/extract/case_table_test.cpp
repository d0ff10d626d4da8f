// Every case of the table, and every pair of neighbouring cells.
#include "extract/bricks/case_table.hpp"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>
#include <utility>

#include "core/vec3.hpp"

namespace vdwmesh {
namespace {

using EdgePlace = std::array<int, 4>;  // node of the edge's lower end, axis
using HalfEdge = std::pair<EdgePlace, EdgePlace>;

EdgePlace place_of(int edge, const std::array<int, 3>& cell) {
  const CellEdge e = cell_edge(edge);
  return {cell[0] + e.x, cell[1] + e.y, cell[2] + e.z, e.axis};
}

std::uint32_t corner_sign(std::uint32_t inside, int x, int y, int z) {
  return inside >> (x + 2 * y + 4 * z) & 1u;
}

void add_half_edges(std::uint32_t inside, const std::array<int, 3>& cell,
                    std::map<HalfEdge, int>& count) {
  const CaseTable& table = case_table();
  for (int t = 0; t < table.triangle_count[inside]; ++t) {
    for (int k = 0; k < 3; ++k) {
      const EdgePlace a = place_of(table.edges[inside][3 * t + k], cell);
      const EdgePlace b = place_of(table.edges[inside][3 * t + (k + 1) % 3], cell);
      ++count[{a, b}];
    }
  }
}

// Twice the middle of the grid edge, so that it is whole.
std::array<int, 3> doubled_middle(const EdgePlace& e) {
  std::array<int, 3> p{2 * e[0], 2 * e[1], 2 * e[2]};
  ++p[static_cast<std::size_t>(e[3])];
  return p;
}

TEST(CaseTable, UsesExactlyTheCrossedEdgesOfEveryCase) {
  for (std::uint32_t inside = 0; inside < 256; ++inside) {
    std::set<int> crossed, used;
    for (int e = 0; e < 12; ++e) {
      const CellEdge edge = cell_edge(e);
      const int dx = edge.axis == 0, dy = edge.axis == 1, dz = edge.axis == 2;
      if (corner_sign(inside, edge.x, edge.y, edge.z) !=
          corner_sign(inside, edge.x + dx, edge.y + dy, edge.z + dz)) {
        crossed.insert(e);
      }
    }
    ASSERT_LE(case_table().triangle_count[inside], kMaxCaseTriangles);
    for (int h = 0; h < 3 * case_table().triangle_count[inside]; ++h) {
      used.insert(case_table().edges[inside][h]);
    }
    EXPECT_EQ(used, crossed) << "case " << inside;
  }
}

TEST(CaseTable, OneInsideCornerFacesAwayFromIt) {
  for (int corner = 0; corner < 8; ++corner) {
    const std::uint32_t inside = 1u << corner;
    ASSERT_EQ(case_table().triangle_count[inside], 1);
    std::array<Vec3d, 3> p{};
    for (int k = 0; k < 3; ++k) {
      const auto m = doubled_middle(place_of(case_table().edges[inside][k], {0, 0, 0}));
      p[static_cast<std::size_t>(k)] = {m[0] / 2.0, m[1] / 2.0, m[2] / 2.0};
    }
    const Vec3d normal = cross(p[1] - p[0], p[2] - p[0]);
    const Vec3d to_center{0.5 - (corner & 1), 0.5 - (corner >> 1 & 1), 0.5 - (corner >> 2)};
    EXPECT_GT(dot(normal, to_center), 0) << "corner " << corner;
  }
}

// All 2^12 sign patterns of two cells that share a face, along each axis: in the shared face every
// half-edge of one cell is met by exactly one of the other, running back; nowhere does an edge run
// twice the same way. A diagonal drawn inside the face would run four times.
class NeighbouringCells : public ::testing::TestWithParam<int> {};

TEST_P(NeighbouringCells, MeetEdgeToEdge) {
  const int axis = GetParam();
  for (std::uint32_t pattern = 0; pattern < 4096; ++pattern) {
    // Node with offset a along the axis, b and c along the others: bit a + 3 (b + 2 c).
    const auto cell_inside = [&](int first) {
      std::uint32_t inside = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const int xyz[3] = {corner & 1, corner >> 1 & 1, corner >> 2};
        const int b = xyz[axis == 0 ? 1 : 0], c = xyz[axis == 2 ? 1 : 2];
        inside |= (pattern >> (first + xyz[axis] + 3 * (b + 2 * c)) & 1u) << corner;
      }
      return inside;
    };
    std::array<int, 3> second{0, 0, 0};
    second[static_cast<std::size_t>(axis)] = 1;
    std::map<HalfEdge, int> count;
    add_half_edges(cell_inside(0), {0, 0, 0}, count);
    add_half_edges(cell_inside(1), second, count);
    for (const auto& [half_edge, times] : count) {
      ASSERT_EQ(times, 1) << "pattern " << pattern;
      const auto a = doubled_middle(half_edge.first), b = doubled_middle(half_edge.second);
      const auto i = static_cast<std::size_t>(axis);
      if (a[i] != 2 || b[i] != 2) continue;
      ASSERT_TRUE(count.contains({half_edge.second, half_edge.first})) << "pattern " << pattern;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Axes, NeighbouringCells, ::testing::Values(0, 1, 2));

TEST(CaseTable, LinksHalfEdgesWithinTheCellAndAcrossFaces) {
  const CaseTable& table = case_table();
  for (std::uint32_t inside = 0; inside < 256; ++inside) {
    for (int h = 0; h < 3 * table.triangle_count[inside]; ++h) {
      const int next = h % 3 == 2 ? h - 2 : h + 1;
      const int start = table.edges[inside][h], end = table.edges[inside][next];
      const int code = table.across[inside][h];
      if (code < kCaseHalfEdges) {
        const int after = code % 3 == 2 ? code - 2 : code + 1;
        EXPECT_EQ(table.edges[inside][code], end);
        EXPECT_EQ(table.edges[inside][after], start);
        continue;
      }
      const int face = (code - kFirstFaceCode) / 4, axis = face / 2;
      const auto a = doubled_middle(place_of(start, {0, 0, 0}));
      const auto b = doubled_middle(place_of(end, {0, 0, 0}));
      EXPECT_EQ(a[static_cast<std::size_t>(axis)], 2 * (face & 1));
      EXPECT_EQ(b[static_cast<std::size_t>(axis)], 2 * (face & 1));
    }
  }
}

}  // namespace
}  // namespace vdwmesh
