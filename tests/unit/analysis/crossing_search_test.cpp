// The searches for crossing triangles against the same tests on all pairs, on inputs unlike meshes
// of molecules; and the tests themselves against CGAL's exact predicates.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "analysis/mesh_measures.hpp"
#include "core/errors.hpp"
#include "refine/crossings/bad_moves.hpp"
#include "refine/crossings/crossing_formulas.hpp"
#include "refine/crossings/patch_grid.hpp"
#include "refine/crossings/preparation.hpp"
#include "refine/subdivision_formulas.hpp"
#include "spheres/box.hpp"
#include "support/dice.hpp"

namespace vdwmesh {
namespace {

using testing::Dice;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corners = std::array<Vec3d, 3>;

Vec3d place(Dice& dice, double half) {
  return {dice.real(-half, half), dice.real(-half, half), dice.real(-half, half)};
}

// How triangles of a soup lie: where their centres are, and how large they are.
enum class Soup { crowd, gas, lattice, one_huge, pairs_far_apart, in_one_plane, at_one_place };
constexpr Soup kSoups[] = {
    Soup::crowd,           Soup::gas,          Soup::lattice,     Soup::one_huge,
    Soup::pairs_far_apart, Soup::in_one_plane, Soup::at_one_place};

std::array<Vec3d, 3> triangle_of(Soup soup, int t, Dice& dice) {
  const auto about = [&](const Vec3d& centre, double size) {
    return Corners{centre + place(dice, size), centre + place(dice, size),
                   centre + place(dice, size)};
  };
  switch (soup) {
    case Soup::crowd:
      return about(place(dice, 2), 1);
    case Soup::gas:
      return about(place(dice, 8), dice.real(0.01, 2));
    case Soup::lattice: {
      const Vec3d site{double(t % 4), double(t / 4 % 4), double(t / 16 % 4)};
      return about(site, 0.8);
    }
    case Soup::one_huge:
      return t == 0 ? Corners{{{-1e4, -1e4, 0.1}, {1e4, -1e4, -0.2}, {0, 1e4, 0.1}}}
                    : about(place(dice, 3), 0.3);
    case Soup::pairs_far_apart:
      return about({1e7 * (t / 2 % 7), -1e7 * (t / 2 % 3), 0}, 1);
    case Soup::in_one_plane: {
      Corners flat = about(place(dice, 2), 1);
      for (Vec3d& p : flat) p.z = t % 3 == 0 ? p.z : 0;
      return flat;
    }
    case Soup::at_one_place:
      return about({5, 5, 5}, t % 2 == 0 ? 1e-9 : 1);
  }
  return {};
}

// Whether some triangles have a vertex or two of the one before.
enum class Sharing { none, some };

IndexedMesh soup_of(Soup soup, int triangles, Dice& dice, Sharing sharing = Sharing::some) {
  IndexedMesh mesh;
  for (int t = 0; t < triangles; ++t) {
    const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
    for (const Vec3d& p : triangle_of(soup, t, dice)) mesh.positions.push_back(p);
    Triangle v{first, first + 1, first + 2};
    const int shared =
        sharing == Sharing::none || soup == Soup::pairs_far_apart || t == 0 ? 0 : dice.whole(0, 2);
    for (int k = 0; k < shared; ++k) {
      v[static_cast<std::size_t>(k)] =
          mesh.triangles[static_cast<std::size_t>(t) - 1][static_cast<std::size_t>(k)];
    }
    mesh.triangles.push_back(v);
  }
  return mesh;
}

Corners corners_of(const IndexedMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  return {mesh.positions[a], mesh.positions[b], mesh.positions[c]};
}

Kernel::Point_3 point(const Vec3d& p) { return {p.x, p.y, p.z}; }
Kernel::Triangle_3 triangle(const Corners& c) { return {point(c[0]), point(c[1]), point(c[2])}; }

std::size_t shared_vertices(const Triangle& a, const Triangle& b) {
  return static_cast<std::size_t>(std::count_if(
      a.begin(), a.end(), [&](std::uint32_t v) { return std::ranges::count(b, v) > 0; }));
}

// Triangles without a vertex in common: do_intersect of all pairs.
std::uint64_t crossings_of_all_pairs(const IndexedMesh& mesh) {
  std::uint64_t pairs = 0;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (shared_vertices(mesh.triangles[i], mesh.triangles[j]) > 0) continue;
      pairs += CGAL::do_intersect(triangle(corners_of(mesh, i)), triangle(corners_of(mesh, j)));
    }
  return pairs;
}

IndexedMesh unshared(const IndexedMesh& mesh) {
  IndexedMesh result;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto first = static_cast<std::uint32_t>(result.vertex_count());
    for (const Vec3d& p : corners_of(mesh, t)) result.positions.push_back(p);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

class CrossingSearch : public ::testing::TestWithParam<Soup> {};

TEST_P(CrossingSearch, SelfIntersectionsAreThoseOfAllPairs) {
  Dice dice(1);
  std::uint64_t found = 0;
  for (int round = 0; round < 10; ++round) {
    const IndexedMesh mesh = unshared(soup_of(GetParam(), 60, dice));
    const std::uint64_t pairs = crossings_of_all_pairs(mesh);
    EXPECT_EQ(self_intersections(mesh), pairs);
    found += pairs;
  }
  EXPECT_GT(found, 0u);
}

bool is_level(const Corners& c) { return c[0].z == c[1].z && c[1].z == c[2].z; }

// Triangles that neither touch nor share a vertex cross where CGAL says that they have a point in
// common. Random ones never touch.
TEST_P(CrossingSearch, TheFormulaAgreesWithCgal) {
  Dice dice(2);
  const IndexedMesh mesh = soup_of(GetParam(), 100, dice, Sharing::none);
  const std::array<SphereId, 3> none{kNoSphere, kNoSphere, kNoSphere};
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Corners a = corners_of(mesh, i), b = corners_of(mesh, j);
      if (is_level(a) && is_level(b)) continue;  // in one plane there is no crossing
      const bool cross = boxes_overlap(a.data(), b.data()) &&
                         triangles_cross(a.data(), mesh.triangles[i].data(), none.data(), b.data(),
                                         mesh.triangles[j].data(), none.data());
      ASSERT_EQ(cross, CGAL::do_intersect(triangle(a), triangle(b))) << i << ' ' << j;
    }
}

// A soup before and after its vertices moved, each of an atom.
struct Moved {
  IndexedMesh given, mesh;
  SphereSet spheres;
  Buffer<MoveState> move_states;
};

Moved moved_soup(Soup soup, Dice& dice) {
  Moved m;
  m.given = soup_of(soup, 60, dice);
  m.spheres = SphereSet({{{0, 0, 0}, 1}, {{0.5, 0, 0}, 1}, {{0, 1, 0.5}, 1}});
  m.mesh = m.given;
  const double step = soup == Soup::one_huge ? 3 : 1;
  for (std::size_t v = 0; v < m.mesh.vertex_count(); ++v) {
    const bool moves = !dice.one_in(4);
    if (moves)
      m.mesh.positions[v] =
          m.mesh.positions[v] + place(dice, dice.one_in(5) ? 4 * step : 0.3 * step);
    m.move_states.push_back(moves ? MoveState::moved : MoveState::stayed);
    const auto atom = static_cast<SphereId>(v / 3 % 3);
    m.mesh.vertex_spheres.atoms.push_back(dice.one_in(6) ? kNoSphere : atom);
  }
  return m;
}

using Marks = std::set<std::uint32_t>;

// One pass over all triangles and all pairs of them.
Marks bad_vertices(const Moved& m, const std::vector<bool>& away) {
  Marks bad;
  const auto mark = [&](const Triangle& t) {
    for (const std::uint32_t v : t)
      if (away[v]) bad.insert(v);
  };
  const auto atoms = [&](const Triangle& t) {
    const auto& all = m.mesh.vertex_spheres.atoms;
    return std::array<SphereId, 3>{all[t[0]], all[t[1]], all[t[2]]};
  };
  const Sphere* spheres = m.spheres.spheres().data();
  const auto is_away = [&](std::uint32_t v) { return away[v]; };
  for (std::size_t i = 0; i < m.mesh.triangle_count(); ++i) {
    const Triangle& t = m.mesh.triangles[i];
    const Corners now = corners_of(m.mesh, i), before = corners_of(m.given, i);
    if (facing(spheres, now.data(), atoms(t).data()) == Facing::against_one_atom &&
        facing(spheres, before.data(), atoms(t).data()) == Facing::outward) {
      mark(t);
    }
    for (std::size_t j = 0; j < i; ++j) {
      const Triangle& u = m.mesh.triangles[j];
      const Corners other = corners_of(m.mesh, j);
      if (std::ranges::none_of(t, is_away) && std::ranges::none_of(u, is_away)) continue;
      if (boxes_overlap(now.data(), other.data()) &&
          triangles_cross(now.data(), t.data(), atoms(t).data(), other.data(), u.data(),
                          atoms(u).data())) {
        mark(t);
        mark(u);
      }
    }
  }
  return bad;
}

struct Restored {
  Moved soup;
  int passes = 0;
};

Restored restore_by_all_pairs(Moved m) {
  std::vector<bool> away(m.move_states.size());
  for (std::size_t v = 0; v < away.size(); ++v) away[v] = m.move_states[v] == MoveState::moved;
  for (int passes = 0;; ++passes) {
    const Marks bad = bad_vertices(m, away);
    if (bad.empty()) return {std::move(m), passes};
    for (const std::uint32_t v : bad) {
      m.mesh.positions[v] = m.given.positions[v];
      away[v] = false;
    }
  }
}

// Moves that cross or turn are taken back, until none does: with the grid of cells, of which later
// passes look at few, as with all pairs in every pass.
TEST_P(CrossingSearch, BadMovesAreThoseOfAllPairs) {
  Dice dice(3);
  int longest = 0;
  for (int round = 0; round < 20; ++round) {
    Moved m = moved_soup(GetParam(), dice);
    const Restored expected = restore_by_all_pairs(m);
    longest = std::max(longest, expected.passes);
    const Given level{m.given.positions, m.mesh};
    take_back_bad_moves(m.spheres, level, m.move_states, {},
                        [&](std::size_t v) { m.mesh.positions[v] = m.given.positions[v]; });
    ASSERT_EQ(m.mesh.positions, expected.soup.mesh.positions) << "round " << round;
  }
  EXPECT_GT(longest, GetParam() == Soup::pairs_far_apart ? 0 : 1) << "one pass shows nothing";
}

bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.lower[axis] > b.upper[axis] || b.lower[axis] > a.upper[axis]) return false;
  return true;
}

// Wherever their vertices are, before or after.
void expect_together_where_bounds_overlap(const Moved& m, const PatchGrid& grid) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> together;
  for (std::size_t cell = 0; cell < grid.cell_count(); ++cell)
    for (const std::uint32_t a : grid.patches_in(cell))
      for (const std::uint32_t b : grid.patches_in(cell)) together.insert({a, b});
  const auto bounds = [&](std::size_t t) {
    Box box = empty_box();
    for (const std::uint32_t v : m.mesh.triangles[t])
      for (const Vec3d& p : {m.given.positions[v], m.mesh.positions[v]})
        for (int axis = 0; axis < 3; ++axis) {
          box.lower[axis] = std::min(box.lower[axis], p[axis]);
          box.upper[axis] = std::max(box.upper[axis], p[axis]);
        }
    return box;
  };
  for (std::uint32_t a = 0; a < m.mesh.triangle_count(); ++a)
    for (std::uint32_t b = 0; b <= a; ++b) {
      if (!overlap(bounds(a), bounds(b))) continue;
      ASSERT_TRUE(together.contains({a, b})) << a << ' ' << b;
    }
}

TEST_P(CrossingSearch, TrianglesWhoseBoundsOverlapShareACell) {
  Dice dice(4);
  const Moved m = moved_soup(GetParam(), dice);
  const Given level{m.given.positions, m.mesh};
  const PatchGrid grid(level);
  EXPECT_LE(grid.cell_count(), std::max<std::size_t>(64, 2 * m.mesh.triangle_count()));
  expect_together_where_bounds_overlap(m, grid);
}

std::uint64_t entries_of(const PatchGrid& grid) {
  std::uint64_t entries = 0;
  for (std::size_t cell = 0; cell < grid.cell_count(); ++cell)
    entries += grid.patches_in(cell).size();
  return entries;
}

TEST_P(CrossingSearch, CellsGrowWhereThereIsNoRoomForTheirEntries) {
  Dice dice(5);
  const Moved m = moved_soup(GetParam(), dice);
  const Given level{m.given.positions, m.mesh};
  for (const std::uint64_t most : {m.mesh.triangle_count(), 2 * m.mesh.triangle_count()}) {
    const PatchGrid grid(level, most);
    EXPECT_LE(entries_of(grid), most);
    expect_together_where_bounds_overlap(m, grid);
  }
}

// A box wider than a double can tell.
TEST(PatchGridOfHugeMeshes, Ends) {
  Moved m;
  for (const double x : {-1.7e308, -1e300, 0.0, 1.0, 1e300, 1.7e308}) {
    const auto first = static_cast<std::uint32_t>(m.mesh.vertex_count());
    for (const Vec3d& p : {Vec3d{x, -x, 0}, Vec3d{x, 1 - x, 0}, Vec3d{x, -x, 1}})
      m.mesh.positions.push_back(p);
    m.mesh.triangles.push_back({first, first + 1, first + 2});
  }
  m.given = m.mesh;
  const PatchGrid grid(Given{m.given.positions, m.mesh});
  EXPECT_EQ(entries_of(grid), 6u);
  expect_together_where_bounds_overlap(m, grid);
}

// Before anything is done: 1.2 G triangles become 4.8 G, more than 32 bits count.
TEST(RefinementLimits, CrossingsAreLookedForAmongSoManyTriangles) {
  RefineOptions options;
  options.subdivisions = 1;
  options.projection = Projection::vdw;
  const std::uint64_t triangles = 1'200'000'000;
  EXPECT_THROW(
      check_refinement_size(1, triangles / 2 + 2, triangles, options, TriangleLabels::none),
      LimitExceeded);
  options.crossings = Crossings::allow;
  EXPECT_NO_THROW(
      check_refinement_size(1, triangles / 2 + 2, triangles, options, TriangleLabels::none));
}

INSTANTIATE_TEST_SUITE_P(Soups, CrossingSearch, ::testing::ValuesIn(kSoups));

}  // namespace
}  // namespace vdwmesh
