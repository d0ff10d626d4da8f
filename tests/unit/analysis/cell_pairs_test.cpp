// Meshes in the cells of a grid against the search that knows nothing of grids, which
// intersecting_pairs_test.cpp compares with CGAL: random signs with vertices anywhere on their
// edges, triangles put in and taken out, and whatever must not pass for such a mesh.
#include "analysis/crossings/cell_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/bricks/case_table.hpp"
#include "support/dice.hpp"
#include "support/extract_sets.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;
using Place = std::array<std::int64_t, 3>;  // lattice indices

// The key by which a place comes in the order of bricks, then of rows.
std::array<std::int64_t, 6> in_order(const Place& p) {
  return {p[2] / 8, p[1] / 8, p[0] / 8, p[2] % 8, p[1] % 8, p[0] % 8};
}

// Marching cubes from random signs, of which the share `inside` is inside. Vertices are where the
// dice fall.
class RandomSurface {
 public:
  RandomSurface(Dice& dice, const Place& cells, double inside) : dice_(dice), grid_{{}, 1, {}} {
    for (int axis = 0; axis < 3; ++axis) grid_.cells[axis] = cells[std::size_t(axis)];
    grid_.spacing =
        std::array{1.0, 0.1, 1.0 / 3, 1e-3, 0x1p-900, 0x1p900}[std::size_t(dice.whole(0, 5))];
    for (int axis = 0; axis < 3; ++axis) {
      grid_.origin[axis] = grid_.spacing * dice.real(-1, 1) * (dice.one_in(3) ? 1e6 : 10);
    }
    make(inside);
  }

  const GridSpec& grid() const { return grid_; }
  // The triangles of each cell, in order, as numbers of vertices; and where the cell is.
  std::vector<std::vector<Triangle>> cells;
  std::vector<Place> places;
  std::map<std::pair<Place, int>, std::uint32_t> number;  // of the vertex on an edge
  Buffer<Vec3d> positions;

  IndexedMesh mesh() const {
    IndexedMesh mesh;
    mesh.positions = positions;
    for (const auto& cell : cells) {
      for (const Triangle& t : cell) mesh.triangles.push_back(t);
    }
    return mesh;
  }

 private:
  void make(double inside) {
    std::map<Place, bool> signs;
    each([&](const Place& p) { signs[p] = is_real(p) && dice_.real(0, 1) < inside; });
    each([&](const Place& p) {
      for (int axis = 0; axis < 3; ++axis) {
        Place end = p;
        ++end[std::size_t(axis)];
        if (!signs.contains(end) || signs[p] == signs[end]) continue;
        number[{p, axis}] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(on_edge(p, axis));
      }
    });
    each([&](const Place& p) {
      std::uint32_t inside_corners = 0;
      for (std::uint32_t c = 0; c < 8; ++c) {
        const Place corner{p[0] + (c & 1), p[1] + (c >> 1 & 1), p[2] + (c >> 2)};
        if (!signs.contains(corner)) return;
        inside_corners |= std::uint32_t{signs[corner]} << c;
      }
      std::vector<Triangle> triangles(case_table().count(inside_corners));
      for (std::size_t h = 0; h < 3 * triangles.size(); ++h) {
        const CellEdge e = cell_edge(case_table().edges[inside_corners][h]);
        triangles[h / 3][h % 3] = number.at({{p[0] + e.x, p[1] + e.y, p[2] + e.z}, e.axis});
      }
      if (triangles.empty()) return;
      cells.push_back(triangles);
      places.push_back(p);
    });
  }
  bool is_real(const Place& p) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (is_virtual(grid_, axis, p[std::size_t(axis)])) return false;
    }
    return true;
  }
  template <class Visit>
  void each(const Visit& visit) const {
    std::vector<Place> all;
    for (std::int64_t z = 0; z <= grid_.cells.z + 2; ++z) {
      for (std::int64_t y = 0; y <= grid_.cells.y + 2; ++y) {
        for (std::int64_t x = 0; x <= grid_.cells.x + 2; ++x) all.push_back({x, y, z});
      }
    }
    std::ranges::sort(all, {}, in_order);
    std::ranges::for_each(all, visit);
  }
  // Often where others are, or as near an end as a double can be.
  Vec3d on_edge(const Place& p, int axis) const {
    Vec3d at;
    for (int i = 0; i < 3; ++i) at[i] = lattice_coordinate(grid_, i, p[std::size_t(i)]);
    const double low = at[axis], high = lattice_coordinate(grid_, axis, p[std::size_t(axis)] + 1);
    const int kind = dice_.whole(0, 9);
    const double t = kind < 5 ? 0.25 * dice_.whole(1, 3) : dice_.real(0, 1);
    at[axis] = kind == 9   ? std::nextafter(low, high)
               : kind == 8 ? std::nextafter(high, low)
                           : std::clamp(low + t * (high - low), std::nextafter(low, high),
                                        std::nextafter(high, low));
    return at;
  }

  Dice& dice_;
  GridSpec grid_;
};

TrianglePairs in_rising_order(TrianglePairs pairs) {
  std::ranges::sort(pairs);
  return pairs;
}

// Whether the cells decide; then the pairs with and without the grid are the same.
bool same_with_grid(const IndexedMesh& mesh, const GridSpec& grid) {
  const auto found = pairs_within_cells(mesh, grid, nullptr);
  if (!found) return false;
  const TrianglePairs plain = intersecting_pairs(mesh);
  EXPECT_EQ(in_rising_order(*found), plain);
  EXPECT_EQ(intersecting_pairs(mesh, nullptr, MeshEdges::unknown, grid), plain);
  EXPECT_EQ(self_intersections(mesh, nullptr, MeshEdges::unknown, grid), plain.size());
  return true;
}

TEST(CellPairs, AreThoseOfTheSearchWithoutAGrid) {
  for (unsigned seed = 1; seed <= 90; ++seed) {
    Dice dice(seed);
    RandomSurface surface(dice, {dice.whole(1, 9), dice.whole(1, 8), dice.whole(1, 3)},
                          std::array{0.5, 0.1, 0.9}[seed % 3]);
    if (surface.cells.empty()) continue;
    ASSERT_TRUE(same_with_grid(surface.mesh(), surface.grid())) << "seed " << seed;
  }
}

// What an extractor makes lies in its cells: all fields, sets of balls unlike proteins.
TEST(CellPairs, AreThoseOfExtractedMeshes) {
  std::set<FieldKind> seen;
  for (std::uint32_t index = 0; index < 25; ++index) {
    const testing::ExtractSet set = testing::extract_set(20, index);
    const ExtractResult made = make_cpu_extractor()->extract(set.spheres, set.options);
    if (made.mesh.triangles.empty()) continue;
    ASSERT_TRUE(same_with_grid(made.mesh, made.grid)) << set.name;
    seen.insert(set.options.field.kind);
  }
  EXPECT_EQ(seen.size(), 4u);
}

// Crossings planted within cells and between them: triangles between any three vertices of a cell,
// or some of its own left out. Then sides may cross in the face between two cells.
TEST(CellPairs, OfPlantedTrianglesAreThoseOfTheSearchWithoutAGrid) {
  std::size_t decided = 0, left = 0, pairs = 0;
  for (unsigned seed = 1; seed <= 1200; ++seed) {
    Dice dice(seed);
    RandomSurface surface(dice, {dice.whole(1, 3), dice.whole(1, 3), dice.whole(1, 3)}, 0.5);
    if (surface.cells.empty()) continue;
    for (int k = dice.whole(1, 6); k > 0; --k) {
      auto& cell =
          surface.cells[std::size_t(dice.whole(0, static_cast<int>(surface.cells.size()) - 1))];
      std::set<std::uint32_t> of_cell;
      for (const Triangle& t : cell) of_cell.insert(t.begin(), t.end());
      const std::vector<std::uint32_t> all(of_cell.begin(), of_cell.end());
      const auto any = [&] {
        return all[std::size_t(dice.whole(0, static_cast<int>(all.size()) - 1))];
      };
      Triangle& t = cell[std::size_t(dice.whole(0, static_cast<int>(cell.size()) - 1))];
      const Triangle planted{any(), any(), any()};
      if (dice.one_in(4) && cell.size() > 1) {
        cell.pop_back();
      } else if (dice.one_in(2) && cell.size() < 5) {
        cell.push_back(planted);
      } else {
        t = planted;
      }
    }
    const IndexedMesh mesh = surface.mesh();
    const bool in_cells = same_with_grid(mesh, surface.grid());
    ++(in_cells ? decided : left);
    if (in_cells) pairs += intersecting_pairs(mesh).size();
  }
  EXPECT_GT(decided, 50u);
  EXPECT_GT(left, 500u);
  EXPECT_GT(pairs, 20u);
}

const GridSpec kUnitGrid{{-1, -1, -1}, 1, {8, 8, 8}};  // lattice plane i is i - 2

// One cell and the next one along x, each with a triangle that has a side in the face x = 1
// between them. The sides cross, but each triangle fulfils what is asked of it alone.
TEST(CellPairs, SidesOfTwoTrianglesMayCrossInAFace) {
  const IndexedMesh mesh = testing::make_mesh(
      {{0.5, 0, 0}, {1, 0.5, 0}, {1, 0, 0.5}, {1, 1, 0.5}, {2, 1, 0.5}, {1, 0.5, 1}},
      {{2, 3, 0}, {1, 5, 4}});
  EXPECT_FALSE(same_with_grid(mesh, kUnitGrid));
  EXPECT_EQ(intersecting_pairs(mesh, nullptr, MeshEdges::unknown, kUnitGrid),
            (TrianglePairs{{0, 1}}));
}

// The same in the middle of surfaces, where each vertex has its four cells: a triangle planted on
// either side of a face with a vertex on each of its edges.
TEST(CellPairs, SidesPlantedInAFaceMayCross) {
  std::size_t planted = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Dice dice(seed);
    RandomSurface surface(dice, {3, 3, 3}, 0.5);
    for (std::size_t a = 0; a < surface.cells.size(); ++a) {
      const int axis = dice.whole(0, 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
      Place p = surface.places[a];
      ++p[std::size_t(axis)];
      const auto b = std::size_t(std::ranges::find(surface.places, p) - surface.places.begin());
      if (b == surface.cells.size()) continue;
      Place beside_u = p, beside_v = p;
      ++beside_u[std::size_t(u)];
      ++beside_v[std::size_t(v)];
      const std::array<std::pair<Place, int>, 4> edges{
          {{p, u}, {beside_v, u}, {p, v}, {beside_u, v}}};
      if (!std::ranges::all_of(edges, [&](auto& e) { return surface.number.contains(e); }))
        continue;
      const auto vertex = [&](std::size_t e) { return surface.number.at(edges[e]); };
      RandomSurface changed = surface;
      const auto plant = [&](std::size_t cell, std::size_t e) {
        for (const Triangle& t : surface.cells[cell]) {
          for (const std::uint32_t third : t) {
            if (surface.positions[third][axis] == surface.positions[vertex(0)][axis]) continue;
            changed.cells[cell].push_back({vertex(e), vertex(e + 1), third});
            return changed.cells[cell].size() <= 5;
          }
        }
        return false;
      };
      if (!plant(a, 0) || !plant(b, 2)) continue;
      ASSERT_FALSE(same_with_grid(changed.mesh(), surface.grid())) << "seed " << seed;
      ++planted;
    }
  }
  EXPECT_GT(planted, 20u);
}

// A surface, and one thing wrong with it at a time.
TEST(CellPairs, NothingElsePassesForTheMeshOfAGrid) {
  Dice dice(5);
  RandomSurface surface(dice, {8, 2, 3}, 0.5);
  const IndexedMesh mesh = surface.mesh();
  const GridSpec grid = surface.grid();
  ASSERT_TRUE(same_with_grid(mesh, grid));
  const auto passes = [&](auto change) {
    IndexedMesh changed = mesh;
    change(changed);
    return same_with_grid(changed, grid);
  };
  const auto none = std::numeric_limits<double>::quiet_NaN();
  const auto moved = [&](int axis, auto move) {
    return passes([&](IndexedMesh& m) {
      double& x = m.positions[m.positions.size() / 2][axis];
      x = move(x);
    });
  };
  for (int axis = 0; axis < 3; ++axis) {
    const auto up = [](double x) { return std::nextafter(x, 1e300); };
    // The vertex stays on its edge if it moves along it.
    const std::size_t middle = mesh.positions.size() / 2;
    const Vec3d& p = mesh.positions[middle];
    const double place = (p[axis] - grid.origin[axis]) / grid.spacing;
    const bool along = std::abs(place - std::round(place)) > 1e-6;
    EXPECT_EQ(moved(axis, up), along) << axis;
    EXPECT_FALSE(moved(axis, [&](double x) { return x + 2 * grid.spacing; })) << axis;
    EXPECT_FALSE(moved(axis, [&](double) { return 1e308; })) << axis;
    EXPECT_FALSE(pairs_within_cells(
        [&] {
          IndexedMesh m = mesh;
          m.positions[middle][axis] = none;
          return m;
        }(),
        grid, nullptr));
  }
  // A vertex at a node of the lattice.
  EXPECT_FALSE(passes([&](IndexedMesh& m) {
    for (int axis = 0; axis < 3; ++axis) m.positions[7][axis] = lattice_coordinate(grid, axis, 4);
  }));
  // Two vertices on one edge, one of them unused.
  EXPECT_FALSE(
      passes([](IndexedMesh& m) { m.positions.push_back(m.positions[m.positions.size() - 1]); }));
  EXPECT_FALSE(passes([](IndexedMesh& m) { std::swap(m.positions[3], m.positions[4]); }));
  // Triangles missing, in another order, of other cells, with equal vertices, too many.
  EXPECT_FALSE(passes([](IndexedMesh& m) { m.triangles.resize(m.triangles.size() - 9); }));
  EXPECT_FALSE(passes([](IndexedMesh& m) { std::ranges::reverse(m.triangles); }));
  EXPECT_FALSE(
      passes([](IndexedMesh& m) { std::ranges::rotate(m.triangles, m.triangles.begin() + 1); }));
  EXPECT_FALSE(passes([](IndexedMesh& m) { m.triangles[0][1] = m.triangles[90][0]; }));
  EXPECT_FALSE(passes([](IndexedMesh& m) { m.triangles[0][1] = m.triangles[0][0]; }));
  EXPECT_FALSE(passes([](IndexedMesh& m) {
    for (std::size_t t = 50; t < 58; ++t) m.triangles[t] = m.triangles[50];
  }));
}

// A corner of a triangle moves to the vertex of an edge one or two cells further, while other
// triangles of its cell keep the vertex that it had.
TEST(CellPairs, TrianglesThatReachBeyondTheirCellAreFound) {
  Dice dice(8);
  RandomSurface surface(dice, {4, 4, 4}, 0.5);
  const IndexedMesh mesh = surface.mesh();
  std::size_t moved = 0;
  for (const auto& [edge, vertex] : surface.number) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const int step : {-2, -1, 1, 2}) {
        auto [place, along] = edge;
        place[std::size_t(axis)] += step;
        const auto to = surface.number.find({place, along});
        if (to == surface.number.end() || (axis != along && std::abs(step) < 2)) continue;
        for (std::size_t t = dice.whole(0, 9) + 1u; t + 1 < mesh.triangles.size(); t += 10) {
          const auto has = [&](std::size_t s) {
            return std::ranges::count(mesh.triangles[s], vertex) == 1;
          };
          if (!has(t) || !(has(t - 1) || has(t + 1))) continue;
          IndexedMesh changed = mesh;
          std::ranges::replace(changed.triangles[t], vertex, to->second);
          ASSERT_FALSE(pairs_within_cells(changed, surface.grid(), nullptr));
          ++moved;
        }
      }
    }
  }
  EXPECT_GT(moved, 100u);
}

// A vertex that goes to a plane whose index has no room in 20 bits, but would look like its edge.
TEST(CellPairs, VerticesFarBeyondTheGridAreFound) {
  Dice dice(9);
  RandomSurface surface(dice, {4, 4, 4}, 0.9);
  for (int axis = 0; axis < 3; ++axis) {
    std::size_t moved = 0;
    for (const auto& [edge, vertex] : surface.number) {
      if (edge.second != axis || edge.first[std::size_t(axis)] != 0) continue;
      IndexedMesh mesh = surface.mesh();
      double& x = mesh.positions[vertex][axis];
      for (const std::int64_t plane : {std::int64_t{1} << 20, -(std::int64_t{1} << 20)}) {
        x = lattice_coordinate(surface.grid(), axis, plane);
        ASSERT_FALSE(pairs_within_cells(mesh, surface.grid(), nullptr)) << axis;
      }
      ++moved;
    }
    EXPECT_GT(moved, 0u);
    // All of it lies below the first plane, or partly.
    for (const int cells : {1, 2, 9}) {
      GridSpec grid = surface.grid();
      grid.origin[axis] += cells * grid.spacing;
      EXPECT_FALSE(pairs_within_cells(surface.mesh(), grid, nullptr)) << cells;
    }
  }
}

// A plane every half unit where doubles are one apart: half of the vertices lie on planes that two
// indices have.
TEST(CellPairs, PlanesThatAreOneHideNothing) {
  Dice dice(10);
  RandomSurface surface(dice, {6, 6, 6}, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double spacing : {0.5, 1.0, 2.0}) {
      GridSpec grid{{0, 0, 0}, spacing, surface.grid().cells};
      grid.origin[axis] = 0x1p52;
      IndexedMesh mesh = surface.mesh();
      for (Vec3d& p : mesh.positions) {
        for (int i = 0; i < 3; ++i) {
          const double place = (p[i] - surface.grid().origin[i]) / surface.grid().spacing;
          p[i] = grid.origin[i] + place * spacing;
        }
      }
      same_with_grid(mesh, grid);
    }
  }
}

TEST(CellPairs, NeedAGridWithPlanes) {
  Dice dice(6);
  RandomSurface surface(dice, {4, 4, 4}, 0.5);
  const IndexedMesh mesh = surface.mesh();
  const double none = std::numeric_limits<double>::quiet_NaN(),
               infinite = std::numeric_limits<double>::infinity();
  for (const double spacing : {0.0, -1.0, none, infinite, 5e-324, 1e-12, 1e308}) {
    GridSpec grid = surface.grid();
    grid.spacing = spacing;
    EXPECT_FALSE(pairs_within_cells(mesh, grid, nullptr)) << spacing;
  }
  for (const double origin : {none, infinite, 1e300}) {
    GridSpec grid = surface.grid();
    grid.origin.y = origin;
    EXPECT_FALSE(pairs_within_cells(mesh, grid, nullptr)) << origin;
  }
  // The lattice has no end.
  for (const std::int64_t cells : {std::int64_t{-1}, std::int64_t{0}, kMaxCellsPerAxis + 1,
                                   std::numeric_limits<std::int64_t>::max()}) {
    GridSpec grid = surface.grid();
    grid.cells.z = cells;
    EXPECT_TRUE(same_with_grid(mesh, grid)) << cells;
  }
  EXPECT_FALSE(pairs_within_cells({}, surface.grid(), nullptr));
}

}  // namespace
}  // namespace vdwmesh
