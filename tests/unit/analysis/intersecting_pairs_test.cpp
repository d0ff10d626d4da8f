// The search for intersecting triangles against a test of all pairs: by CGAL's exact predicates,
// and for a part of the meshes in rational arithmetic. On meshes that no molecule has: needles,
// overlaps in one plane, triangles that touch, doubled and flat ones, coordinates beyond what
// products can hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "analysis/crossings/facet_tree.hpp"
#include "analysis/mesh_measures.hpp"
#include "cgal_pairs.hpp"
#include "reference/crossing_pairs.hpp"
#include "support/dice.hpp"
#include "support/test_meshes.hpp"
#include "surface/star_fans.hpp"

namespace vdwmesh {
namespace {

using testing::CgalPairs;
using testing::Dice;
TrianglePairs pairs_by_rationals(const IndexedMesh& mesh) {
  std::vector<std::array<double, 3>> positions;
  for (const Vec3d& p : mesh.positions) positions.push_back({p.x, p.y, p.z});
  return testing::crossing_pairs(positions, {mesh.triangles.begin(), mesh.triangles.end()});
}

// Where the vertices of a mesh lie.
struct Family {
  std::string name;
  Vec3d (*vertex)(Dice&);
};
std::ostream& operator<<(std::ostream& out, const Family& family) { return out << family.name; }

template <class Coordinate>
Vec3d by_axis(const Coordinate& coordinate) {
  const double x = coordinate(), y = coordinate(), z = coordinate();
  return {x, y, z};
}
Vec3d on_lattice(Dice& dice, int side) {
  return by_axis([&] { return double(dice.whole(0, side)); });
}
double ulps_beside(Dice& dice, double x) {
  for (int k = dice.whole(0, 2); k > 0; --k) x = std::nextafter(x, dice.one_in(2) ? 1e308 : -1e308);
  return x;
}
double of_any_size(Dice& dice, int least, int most) {
  return std::ldexp(dice.real(-1, 1), dice.whole(least, most));
}

// Points of a lattice give overlaps in one plane, triangles that touch, and flat ones.
const Family kFamilies[] = {
    {"anywhere", [](Dice& d) { return by_axis([&] { return d.real(-1, 1); }); }},
    {"lattice", [](Dice& d) { return on_lattice(d, 2); }},
    {"plane",
     [](Dice& d) {
       return Vec3d{double(d.whole(0, 5)), double(d.whole(0, 5)), 3};
     }},
    {"oblique_plane",
     [](Dice& d) {
       const double x = d.real(0, 1), y = d.real(0, 1);
       return Vec3d{x, y, 0.3 * x - 0.7 * y + 0.1};
     }},
    {"needles",
     [](Dice& d) {
       return Vec3d{d.real(0, 1), 1e-9 * d.real(0, 1), 1e-12 * d.whole(0, 3)};
     }},
    {"one_line_almost",
     [](Dice& d) {
       const double x = d.whole(0, 8);
       return Vec3d{ulps_beside(d, x), ulps_beside(d, x / 3), ulps_beside(d, 2 * x / 3)};
     }},
    {"lines_through_the_origin",  // exactly, while differences are rounded
     [](Dice& d) {
       const Vec3d p{1.0 / 3, d.one_in(2) ? 1.0 / 7 : 0.3, 0.1};
       return std::ldexp(d.one_in(2) ? 1.0 : -1.0, d.whole(0, 6)) * p;
     }},
    {"ulps",
     [](Dice& d) {
       const Vec3d p = on_lattice(d, 2);
       return Vec3d{ulps_beside(d, p.x + 1), ulps_beside(d, p.y + 1), ulps_beside(d, p.z + 1)};
     }},
    {"far_off",
     [](Dice& d) {
       return Vec3d{1e15, -1e15, 1e9} + on_lattice(d, 2);
     }},
    {"huge",
     [](Dice& d) {
       return 8e307 * on_lattice(d, 2) - Vec3d{8e307, 8e307, 8e307};
     }},
    {"large", [](Dice& d) { return by_axis([&] { return 1e103 * d.real(-1, 1); }); }},
    {"small", [](Dice& d) { return by_axis([&] { return 1e-103 * d.real(-1, 1); }); }},
    {"tiny", [](Dice& d) { return 1e-200 * on_lattice(d, 2); }},
    {"subnormal", [](Dice& d) { return 5e-324 * on_lattice(d, 3); }},
    {"of_any_size", [](Dice& d) { return by_axis([&] { return of_any_size(d, -40, 40); }); }},
    {"of_all_exponents",
     [](Dice& d) { return by_axis([&] { return of_any_size(d, -1070, 1020); }); }},
};
constexpr unsigned kMeshesPerFamily = 20;  // 320 meshes in all

// Triangles of vertices chosen from a pool: so most share some, and some are doubled or have a
// vertex twice. Some vertices stand at one place.
IndexedMesh soup_of(const Family& family, Dice& dice) {
  IndexedMesh mesh;
  const int vertices = dice.whole(6, 40), triangles = dice.whole(10, 50);
  for (int v = 0; v < vertices; ++v) {
    const bool again = v > 0 && dice.one_in(8);
    mesh.positions.push_back(again ? mesh.positions[std::size_t(v) / 2] : family.vertex(dice));
  }
  const auto vertex = [&] { return static_cast<std::uint32_t>(dice.whole(0, vertices - 1)); };
  for (int t = 0; t < triangles; ++t) mesh.triangles.push_back({vertex(), vertex(), vertex()});
  mesh.triangles.push_back({mesh.triangles[0][1], mesh.triangles[0][2], mesh.triangles[0][0]});
  return mesh;
}

class IntersectingPairs : public ::testing::TestWithParam<Family> {};

TEST_P(IntersectingPairs, AreThoseOfCgalAndOfRationalArithmetic) {
  std::size_t found = 0;
  for (unsigned seed = 1; seed <= kMeshesPerFamily; ++seed) {
    Dice dice(seed);
    const IndexedMesh mesh = soup_of(GetParam(), dice);
    const TrianglePairs pairs = intersecting_pairs(mesh);
    ASSERT_EQ(pairs, CgalPairs(mesh).all()) << "seed " << seed;
    if (seed % 5 == 0) {
      ASSERT_EQ(pairs, pairs_by_rationals(mesh)) << "seed " << seed;
    }
    EXPECT_EQ(self_intersections(mesh), pairs.size());
    found += pairs.size();
  }
  EXPECT_GT(found, kMeshesPerFamily);
}

INSTANTIATE_TEST_SUITE_P(Families, IntersectingPairs, ::testing::ValuesIn(kFamilies),
                         [](const auto& info) { return info.param.name; });

// A crossing planted in a surface without any: a vertex pulled through the other side.
TEST(IntersectingPairsOfSurfaces, AreThosePlanted) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    Dice dice(seed);
    IndexedMesh mesh = testing::torus(24, 12);
    EXPECT_TRUE(intersecting_pairs(mesh).empty());
    for (int k = dice.whole(1, 4); k > 0; --k) {
      Vec3d& p = mesh.positions[static_cast<std::size_t>(dice.whole(0, 24 * 12 - 1))];
      p = -1.0 * p;
    }
    const TrianglePairs pairs = intersecting_pairs(mesh);
    EXPECT_FALSE(pairs.empty());
    EXPECT_EQ(pairs, CgalPairs(mesh).all());
  }
}

// Enough triangles for a tree of three levels. Their sizes differ by factors of 10^6, and vertices
// far away leave all others in one cell of the first order.
TEST(IntersectingPairsOfUnevenMeshes, AreThoseOfCgal) {
  for (const double far : {0.0, 1e9, 1e300}) {
    Dice dice(7);
    IndexedMesh mesh;
    for (std::uint32_t t = 0; t < 1500; ++t) {
      const double size = t % 50 == 0 ? 10 : t % 3 == 0 ? 1e-5 : 0.3;
      const Vec3d middle = by_axis([&] { return dice.real(-3, 3); });
      for (int k = 0; k < 3; ++k) {
        mesh.positions.push_back(middle + by_axis([&] { return dice.real(-size, size); }));
      }
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    for (Vec3d& p : {std::ref(mesh.positions[0]), std::ref(mesh.positions[1000])}) p.x += far;
    const TrianglePairs pairs = intersecting_pairs(mesh);
    EXPECT_EQ(pairs, CgalPairs(mesh).all()) << far;
    EXPECT_GT(pairs.size(), 100u) << "too few to show anything";
  }
}

// Every four consecutive triangles of a torus are near each other, and share a leaf of the tree; in
// a shuffled mesh they do not. Some triangles are flat, some vertices are pulled through the other
// side, and the triangles do not fill the last leaf.
TEST(IntersectingPairsOfNeighbours, DoNotDependOnTheOrderOfTriangles) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Dice dice(seed);
    IndexedMesh mesh = testing::torus(24, 12);
    const auto any_triangle = [&] {
      return static_cast<std::size_t>(dice.whole(0, static_cast<int>(mesh.triangles.size()) - 1));
    };
    mesh.triangles.resize(mesh.triangles.size() - seed % 4);
    for (int k = 0; k < 5; ++k) {
      Triangle& t = mesh.triangles[any_triangle()];
      t[2] = t[1];
      Vec3d& p = mesh.positions[static_cast<std::size_t>(dice.whole(0, 24 * 12 - 1))];
      p = -1.0 * p;
    }
    const TrianglePairs pairs = intersecting_pairs(mesh);
    EXPECT_EQ(pairs, CgalPairs(mesh).all());
    EXPECT_GT(pairs.size(), 20u) << "too few to show anything";

    std::vector<std::uint32_t> place(mesh.triangles.size());  // by place: the triangle put there
    std::iota(place.begin(), place.end(), 0u);
    for (std::size_t i = place.size(); i-- > 1;) {
      std::swap(place[i], place[static_cast<std::size_t>(dice.whole(0, static_cast<int>(i)))]);
    }
    IndexedMesh shuffled = mesh;
    for (std::size_t i = 0; i < place.size(); ++i) {
      shuffled.triangles[i] = mesh.triangles[place[i]];
    }
    TrianglePairs again;
    for (const auto& [i, j] : intersecting_pairs(shuffled)) {
      again.push_back(std::minmax(place[i], place[j]));
    }
    std::ranges::sort(again);
    EXPECT_EQ(again, pairs);
  }
}

// A closed mesh of which every triangle is divided into four, midpoints behind all corners.
IndexedMesh divided(const IndexedMesh& mesh) {
  IndexedMesh fine;
  fine.positions = mesh.positions;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> numbers;
  const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
    const auto next = static_cast<std::uint32_t>(fine.positions.size());
    const auto [at, is_new] = numbers.insert({std::minmax(a, b), next});
    if (is_new) fine.positions.push_back(0.5 * (mesh.positions[a] + mesh.positions[b]));
    return at->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
    for (const Triangle& t : {Triangle{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}}) {
      fine.triangles.push_back(t);
    }
  }
  return fine;
}

// Closed oriented meshes: one or two tori, flat ones among them, that share a vertex or none.
IndexedMesh closed_mesh(Dice& dice) {
  IndexedMesh mesh = testing::torus(8, 6);
  if (dice.one_in(2)) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const IndexedMesh other = testing::torus(7, 5);
    for (const Vec3d& p : other.positions) {
      mesh.positions.push_back({p.z + dice.real(0.0, 1e-3), p.x + 1, p.y});
    }
    const bool joined = dice.one_in(2);
    for (Triangle t : other.triangles) {
      for (std::uint32_t& v : t) v = v == 0 && joined ? 0 : v + first;
      mesh.triangles.push_back(t);
    }
  }
  if (dice.one_in(4)) {
    for (Vec3d& p : mesh.positions) p.z = 0;
  }
  return mesh;
}

// Crossings planted within patches, between neighbours and between patches far apart; patches
// without an area; sizes at the ends of what doubles can hold.
TEST(IntersectingPairsOfDividedMeshes, AreThoseOfTheSearchWithoutStars) {
  std::size_t found = 0, stars = 0, others = 0;
  for (unsigned seed = 1; seed <= 120; ++seed) {
    Dice dice(seed);
    const IndexedMesh coarse = closed_mesh(dice);
    IndexedMesh mesh = divided(coarse);
    const double wrinkle = std::array{0.0, 0.01, 0.1, 0.4}[seed % 4];
    for (Vec3d& p : mesh.positions) {
      p = p + by_axis([&] { return wrinkle * dice.real(-1, 1); });
    }
    for (int k = dice.whole(0, 6); k > 0; --k) {
      const auto v = static_cast<std::size_t>(dice.whole(0, int(mesh.positions.size()) - 1));
      const auto w = static_cast<std::size_t>(dice.whole(0, int(mesh.positions.size()) - 1));
      mesh.positions[v] = dice.one_in(2) ? mesh.positions[w] : -1.0 * mesh.positions[v];
    }
    const double size = std::array{1.0, 1e-130, 1e130, 1e-305, 1e305}[seed % 5];
    for (Vec3d& p : mesh.positions) p = size * p;
    ASSERT_TRUE(edges_of(topology(mesh)) == MeshEdges::paired);
    const StarFans fans = fans_of_divided(mesh);
    ASSERT_FALSE(fans.empty());
    for (std::uint32_t v = 0; v < coarse.positions.size(); ++v) {
      ++(fans.is_star(v) ? stars : others);
    }
    const TrianglePairs pairs = intersecting_pairs(mesh, nullptr, MeshEdges::paired);
    ASSERT_EQ(pairs, intersecting_pairs(mesh)) << "seed " << seed;
    found += pairs.size();
  }
  EXPECT_GT(found, 10000u);
  EXPECT_GT(stars, 500u);
  EXPECT_GT(others, 500u);
}

// Triangles around two poles above and below a pentagram, which runs around twice. From a pole all
// of them turn counter-clockwise, so only the number of turns tells.
TEST(IntersectingPairsOfDividedMeshes, AFanThatRunsAroundTwiceIsNoStar) {
  IndexedMesh mesh = testing::make_mesh({{0, 0, 0.1}, {0, 0, -0.1}}, {});
  for (int k = 0; k < 5; ++k) {
    const double turn = 4 * std::numbers::pi / 5 * k + 0.1;
    mesh.positions.push_back({std::cos(turn), std::sin(turn), 0});
  }
  for (std::uint32_t k = 0; k < 5; ++k) {
    const std::uint32_t a = 2 + k, b = 2 + (k + 1) % 5;
    mesh.triangles.push_back({0, a, b});
    mesh.triangles.push_back({1, b, a});
  }
  const IndexedMesh fine = divided(mesh);
  const StarFans fans = fans_of_divided(fine);
  ASSERT_FALSE(fans.empty());
  EXPECT_FALSE(fans.is_star(0));
  EXPECT_FALSE(fans.is_star(1));
  const TrianglePairs pairs = intersecting_pairs(fine, nullptr, MeshEdges::paired);
  EXPECT_EQ(pairs, CgalPairs(fine).all());
  EXPECT_GT(pairs.size(), 10u);
}

// What only looks like a divided mesh: a midpoint that serves two edges, a corner that is one.
TEST(IntersectingPairsOfDividedMeshes, OthersHaveNoStars) {
  const IndexedMesh fine = divided(testing::torus(8, 6));
  EXPECT_FALSE(fans_of_divided(fine).empty());
  IndexedMesh turned = fine;
  std::ranges::rotate(turned.triangles[9], turned.triangles[9].begin() + 1);
  EXPECT_TRUE(fans_of_divided(turned).empty());
  IndexedMesh joined = fine;
  const auto last = static_cast<std::uint32_t>(fine.positions.size() - 1);
  for (Triangle& t : joined.triangles) std::ranges::replace(t, last, last - 1);
  EXPECT_TRUE(fans_of_divided(joined).empty());
  // Patches with two equal corners: their two corners become one in all triangles.
  IndexedMesh pinched = fine;
  for (Triangle& t : pinched.triangles)
    std::ranges::replace(t, fine.triangles[1][0], fine.triangles[0][0]);
  EXPECT_TRUE(fans_of_divided(pinched).empty());
  IndexedMesh shifted = fine;
  std::ranges::rotate(shifted.triangles, shifted.triangles.begin() + 1);
  EXPECT_TRUE(fans_of_divided(shifted).empty());
  EXPECT_TRUE(fans_of_divided(testing::torus(8, 6)).empty());
  EXPECT_TRUE(fans_of_divided(testing::empty_mesh()).empty());
}

// Every pair of boxes that overlap is met once, whatever the order of the tree is.
TEST(FacetTreeOfPiles, VisitsAllNodesThatOverlap) {
  IndexedMesh mesh = testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {});
  mesh.triangles.assign(500, {0, 1, 2});
  EXPECT_EQ(self_intersections(mesh), 500u * 499u / 2);
  EXPECT_EQ(self_intersections(testing::empty_mesh()), 0u);
}

}  // namespace
}  // namespace vdwmesh
