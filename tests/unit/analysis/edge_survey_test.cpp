// The survey of edges and vertices against maps and flood fills, on soups of every kind.
#include "analysis/survey/edge_survey.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "analysis/survey/vertex_survey.hpp"
#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// What the survey should find, from the definitions.
struct Expected {
  bool closed = true, manifold = true, oriented = true;
  std::size_t edges = 0, used_vertices = 0;
  std::vector<std::uint32_t> shell_of;
};

// Joined elements all get the smallest number among them, by repeated passes over the pairs.
std::vector<std::size_t> joined(std::size_t count,
                                const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
  std::vector<std::size_t> set(count);
  std::iota(set.begin(), set.end(), std::size_t{0});
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [a, b] : pairs) {
      const std::size_t least = std::min(set[a], set[b]);
      changed |= set[a] != least || set[b] != least;
      set[a] = set[b] = least;
    }
  }
  return set;
}

Expected expected_of(const Triangles& triangles) {
  struct Side {
    std::size_t triangle, at_smaller, at_larger;  // corners 3 t + k
    bool descending;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Side>> edges;
  std::set<std::uint32_t> used;
  Expected expected;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      const std::size_t from = 3 * t + k, to = 3 * t + (k + 1) % 3;
      used.insert(a);
      if (a == b) expected.manifold = false;
      if (a < b) edges[{a, b}].push_back({t, from, to, false});
      if (a > b) edges[{b, a}].push_back({t, to, from, true});
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> neighbours, corners;
  for (const auto& [ends, sides] : edges) {
    const auto down =
        std::count_if(sides.begin(), sides.end(), [](const Side& side) { return side.descending; });
    expected.closed &= sides.size() == 2;
    expected.manifold &= sides.size() <= 2;
    expected.oriented &= sides.size() == 1 || 2 * static_cast<std::size_t>(down) == sides.size();
    for (const Side& side : sides) neighbours.emplace_back(sides[0].triangle, side.triangle);
    if (sides.size() != 2) continue;
    corners.emplace_back(sides[0].at_smaller, sides[1].at_smaller);
    corners.emplace_back(sides[0].at_larger, sides[1].at_larger);
  }
  const std::vector<std::size_t> fan = joined(3 * triangles.size(), corners);
  expected.manifold &= std::set<std::size_t>(fan.begin(), fan.end()).size() == used.size();
  expected.edges = edges.size();
  expected.used_vertices = used.size();
  std::map<std::size_t, std::uint32_t> number;
  for (const std::size_t shell : joined(triangles.size(), neighbours))
    expected.shell_of.push_back(
        number.emplace(shell, static_cast<std::uint32_t>(number.size())).first->second);
  return expected;
}

std::uint32_t below(std::uint32_t end, std::mt19937& random) {
  return static_cast<std::uint32_t>(random() % end);
}

void expect_survey(const Triangles& triangles, std::size_t vertices) {
  IndexedMesh mesh;
  mesh.triangles.assign(triangles.begin(), triangles.end());
  mesh.positions.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) mesh.positions[v] = {static_cast<double>(v), 0, 0};
  const Expected expected = expected_of(triangles);
  for (const std::size_t threads : {1u, 3u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    BracketedValues lengths(bracket_of_everything());
    const EdgeSurvey found = survey_edges(mesh, &lengths);
    EXPECT_EQ(found.closed, expected.closed);
    EXPECT_EQ(found.manifold, expected.manifold);
    EXPECT_EQ(found.oriented, expected.oriented);
    EXPECT_EQ(found.edges, expected.edges);
    EXPECT_EQ(lengths.summary().count, expected.edges);
    EXPECT_EQ(found.used_vertices, expected.used_vertices);
    EXPECT_TRUE(std::ranges::equal(found.shell_of, expected.shell_of));
  }
}

TEST(EdgeSurvey, RandomSoups) {
  std::mt19937 random(3);
  for (int round = 0; round < 400; ++round) {
    const std::uint32_t vertices = 3 + below(12, random);
    Triangles triangles(below(24, random));
    for (auto& triangle : triangles)
      for (std::uint32_t& v : triangle) v = below(vertices, random);
    expect_survey(triangles, vertices + below(3, random));
  }
}

// Two pyramids, base to base, over a polygon: the vertex of each has `sides` triangles around it.
void add_bipyramid(Triangles& triangles, std::uint32_t first, std::uint32_t sides,
                   std::uint32_t top, std::uint32_t bottom) {
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = first + i, b = first + (i + 1) % sides;
    triangles.push_back({a, b, top});
    triangles.push_back({b, a, bottom});
  }
}

// Numbers of triangles around a vertex on both sides of the one where the walk changes. Then a
// triangle is turned over, left out, doubled, or the vertices of two bipyramids are one.
TEST(EdgeSurvey, FansOfManyTriangles) {
  for (const std::uint32_t sides : {3u, 4u, 31u, 32u, 33u, 100u}) {
    SCOPED_TRACE(sides);
    Triangles whole;
    add_bipyramid(whole, 2, sides, 0, 1);
    expect_survey(whole, sides + 2);
    EXPECT_TRUE(expected_of(whole).closed && expected_of(whole).manifold);
    Triangles turned = whole, open = whole, doubled = whole, touching = whole;
    std::swap(turned[5][0], turned[5][1]);
    open.erase(open.begin() + 4);
    doubled.push_back(doubled[3]);
    add_bipyramid(touching, sides + 2, sides, 0, 2 * sides + 2);
    EXPECT_FALSE(expected_of(touching).manifold);
    for (const Triangles& soup : {turned, open, doubled, touching})
      expect_survey(soup, 2 * sides + 3);
  }
}

// Closed manifolds with a random order of vertices, one to five edges of which are then pinched:
// the walk around a vertex finds another triangle than the right one, or itself.
TEST(EdgeSurvey, VerticesJoined) {
  std::mt19937 random(4);
  for (int round = 0; round < 200; ++round) {
    Triangles triangles;
    for (std::uint32_t i = 0; i < 3; ++i) add_bipyramid(triangles, 8 * i + 2, 6, 8 * i, 8 * i + 1);
    std::vector<std::uint32_t> name(24);
    std::iota(name.begin(), name.end(), 0u);
    std::shuffle(name.begin(), name.end(), random);
    for (std::uint32_t joins = below(6, random); joins > 0; --joins)
      name[below(24, random)] = name[below(24, random)];
    for (auto& triangle : triangles)
      for (std::uint32_t& v : triangle) v = name[v];
    std::shuffle(triangles.begin(), triangles.end(), random);
    expect_survey(triangles, 24);
  }
}

// Each triangle of a soup divided into four, with one new vertex in the middle of each edge, which
// is numbered behind all others.
Triangles divided(const Triangles& soup, std::uint32_t vertices) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
  Triangles fine;
  for (const auto& [a, b, c] : soup) {
    const auto between = [&](std::uint32_t u, std::uint32_t v) {
      const auto next = static_cast<std::uint32_t>(vertices + middle.size());
      return middle.emplace(std::minmax(u, v), next).first->second;
    };
    const std::uint32_t ab = between(a, b), bc = between(b, c), ca = between(c, a);
    fine.insert(fine.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return fine;
}

// Closed manifolds that were divided once and twice, and such of which something is not as it
// should be: vertices of the coarse mesh joined or a triangle of it turned, a midpoint that is
// another one or a corner in one patch or everywhere, and patches or their triangles in another
// order.
TEST(EdgeSurvey, DividedMeshes) {
  constexpr std::uint32_t kShells = 10, kVertices = 8 * kShells;
  std::mt19937 random(6);
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    Triangles coarse;
    for (std::uint32_t i = 0; i < kShells; ++i)
      add_bipyramid(coarse, 8 * i + 2, 6, 8 * i, 8 * i + 1);
    std::vector<std::uint32_t> name(kVertices);
    std::iota(name.begin(), name.end(), 0u);
    std::shuffle(name.begin(), name.end(), random);
    const int kind = round % 10;
    if (kind == 1) name[below(kVertices, random)] = name[below(kVertices, random)];
    for (auto& triangle : coarse)
      for (std::uint32_t& v : triangle) v = name[v];
    std::shuffle(coarse.begin(), coarse.end(), random);
    if (kind == 2) std::swap(coarse[100][0], coarse[100][1]);
    if (kind == 3) coarse.resize(coarse.size() - 2);
    Triangles fine = divided(coarse, kVertices);
    std::uint32_t vertices = kVertices + 3 * static_cast<std::uint32_t>(coarse.size());
    const auto replace = [&](std::size_t first, std::size_t end, std::uint32_t old,
                             std::uint32_t by) {
      for (std::size_t t = first; t < end; ++t) std::ranges::replace(fine[t], old, by);
    };
    const std::size_t patch = 4 * (70 + below(40, random));
    const std::uint32_t midpoint = fine[patch + 3][0], other = fine[patch + 3][1];
    const std::uint32_t far = fine[4 * below(60, random) + 3][below(3, random)];
    if (kind == 4) replace(patch, patch + 4, midpoint, vertices - 1);
    if (kind == 5) replace(0, fine.size(), midpoint, far);
    if (kind == 6) replace(patch, patch + 4, midpoint, below(kVertices, random));
    if (kind == 7) replace(0, fine.size(), midpoint, other);
    if (kind == 8) std::swap(fine[patch], fine[patch + 5]);
    if (kind == 9) {
      fine = divided(fine, vertices);
      vertices *= 4;
    }
    expect_survey(fine, vertices);
  }
}

// Two triangles with the same corners are a closed shell, but once they are divided they have the
// edges between their midpoints in common, which then have four sides.
TEST(EdgeSurvey, DividedPillows) {
  const Triangles pillow{{0, 1, 2}, {0, 2, 1}};
  Triangles beside = pillow;
  add_bipyramid(beside, 5, 6, 3, 4);
  for (const Triangles& coarse : {pillow, beside}) {
    Triangles fine = divided(coarse, 11);
    std::uint32_t vertices = 11 + 3 * static_cast<std::uint32_t>(coarse.size());
    for (int level = 1; level <= 2; ++level) {
      SCOPED_TRACE(level);
      EXPECT_FALSE(expected_of(fine).manifold);
      expect_survey(fine, vertices);
      fine = divided(fine, vertices);
      vertices *= 4;
    }
  }
}

// More vertices than a range has, in order and shuffled, so that triangles are in one, two and
// three ranges.
TEST(EdgeSurvey, ManyVertices) {
  constexpr std::uint32_t kSide = 150;
  const auto vertex = [](std::uint32_t i, std::uint32_t j) {
    return (i % kSide) * kSide + j % kSide;
  };
  std::vector<std::uint32_t> name(kSide * kSide);
  std::iota(name.begin(), name.end(), 0u);
  std::mt19937 random(5);
  for (const bool shuffled : {false, true}) {
    if (shuffled) std::shuffle(name.begin(), name.end(), random);
    IndexedMesh torus;
    torus.positions.resize(name.size());
    for (std::uint32_t i = 0; i < kSide; ++i) {
      for (std::uint32_t j = 0; j < kSide; ++j) {
        const std::uint32_t a = name[vertex(i, j)], b = name[vertex(i + 1, j)],
                            c = name[vertex(i + 1, j + 1)], d = name[vertex(i, j + 1)];
        torus.triangles.push_back({a, b, c});
        torus.triangles.push_back({a, c, d});
      }
    }
    const EdgeSurvey found = survey_edges(torus);
    EXPECT_TRUE(found.closed && found.manifold && found.oriented);
    EXPECT_EQ(found.edges, 3 * kSide * kSide);
    EXPECT_EQ(found.used_vertices, kSide * kSide);
    EXPECT_EQ(found.shells, 1u);
  }
}

// More triangles than a block has, in runs of one shell and shuffled.
TEST(EdgeSurvey, ShellsOfManyBlocksAreNumberedByTheirFirstTriangles) {
  std::mt19937 random(6);
  Triangles triangles;
  std::uint32_t vertices = 0;
  while (triangles.size() <= 2 * kIndicesPerBlock) {
    const std::uint32_t sides = 3 + below(60, random);
    add_bipyramid(triangles, vertices + 2, sides, vertices, vertices + 1);
    vertices += sides + 2;
  }
  std::vector<std::uint32_t> name(vertices);
  std::iota(name.begin(), name.end(), 0u);
  std::shuffle(name.begin(), name.end(), random);
  for (auto& triangle : triangles)
    for (std::uint32_t& v : triangle) v = name[v];
  expect_survey(triangles, vertices);
  std::shuffle(triangles.begin(), triangles.end(), random);
  expect_survey(triangles, vertices);
}

}  // namespace
}  // namespace vdwmesh
