// Meshes of pockets: closed, on the spheres, and with the exact volumes and areas as their limit.
#include "pockets/pocket_meshes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "complex/dual_complex.hpp"
#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"
#include "pockets/rooms/close_room.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kWater = 1.4;  // Å

// Balls of this radius at the corners of a cube from the origin.
SphereSet balls_at_corners(double edge, double radius) {
  std::vector<Sphere> balls;
  for (int corner = 0; corner < 8; ++corner) {
    balls.push_back(
        {{edge * (corner & 1), edge * (corner >> 1 & 1), edge * (corner >> 2 & 1)}, radius});
  }
  return SphereSet(balls);
}

struct RoomFigures {
  double volume = 0, wall = 0;                  // Å³, Å²
  std::map<std::uint32_t, double> mouths = {};  // Å², by part
  std::size_t shells = 0;
  std::int64_t euler = 0;
};

RoomFigures figures_of(const PocketMesh& room) {
  RoomFigures out;
  const IndexedMesh& mesh = room.mesh;
  DisjointSets sets(mesh.vertex_count());
  const Vec3d origin = mesh.positions.empty() ? Vec3d{} : mesh.positions[0];
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto& [i, j, k] = mesh.triangles[t];
    const Vec3d a = mesh.positions[i] - origin, b = mesh.positions[j] - origin,
                c = mesh.positions[k] - origin;
    out.volume += dot(a, cross(b, c)) / 6;
    (room.parts[t] == 0 ? out.wall : out.mouths[room.parts[t]]) += norm(cross(b - a, c - a)) / 2;
    sets.join(i, j), sets.join(j, k);
  }
  out.shells = sets.count();
  out.euler = static_cast<std::int64_t>(mesh.vertex_count()) -
              static_cast<std::int64_t>(mesh.triangle_count()) / 2;
  return out;
}

// Each half-edge is there once, and so is its opposite. Triangles of the wall have their vertices
// on their spheres; those of mouths have planes in which the centres of three spheres lie.
void expect_closed_on(const SphereSet& spheres, const Pocket& pocket, const PocketMesh& room) {
  const IndexedMesh& mesh = room.mesh;
  ASSERT_GT(mesh.triangle_count(), 0u);
  ASSERT_EQ(room.parts.size(), mesh.triangle_count());
  std::set<std::pair<std::uint32_t, std::uint32_t>> halves;
  double farthest = 0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const SphereId s = mesh.triangle_spheres[t];
    ASSERT_EQ(s == kNoSphere, room.parts[t] > 0);
    ASSERT_LE(room.parts[t], pocket.mouths.size());
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k], next = mesh.triangles[t][(k + 1) % 3];
      EXPECT_TRUE(halves.insert({v, next}).second);
      if (s != kNoSphere) {
        farthest = std::max(
            farthest, std::abs(norm(mesh.positions[v] - spheres[s].center) - spheres[s].radius));
        continue;
      }
      double height = HUGE_VAL;  // over the nearest plane of the mouth
      for (const auto& [a, b, c] : pocket.mouths[room.parts[t] - 1].triangles) {
        const Vec3d origin = spheres[a].center;
        const Vec3d normal = cross(spheres[b].center - origin, spheres[c].center - origin);
        height = std::min(height, std::abs(dot(normal, mesh.positions[v] - origin)) / norm(normal));
      }
      farthest = std::max(farthest, height);
    }
  }
  for (const auto& [from, to] : halves) EXPECT_TRUE(halves.contains({to, from}));
  EXPECT_LT(farthest, 1e-9);
}

// Halving the edges divides errors by four, once they are shorter than the rims of small mouths ask
// for anyway.
TEST(PocketMeshes, FiguresOfACubeConvergeWithTheSquareOfTheEdges) {
  const SphereSet spheres = balls_at_corners(4.6, 2.9);
  const auto found = pockets(spheres).pockets;
  ASSERT_EQ(found.size(), 1u);
  std::vector<std::array<double, 3>> errors;
  for (const double edge : {0.2, 0.1, 0.05, 0.025}) {
    const auto meshes = pocket_meshes(spheres, found, {.edge_length = edge});
    ASSERT_EQ(meshes.size(), 1u);
    const RoomFigures f = figures_of(meshes[0]);
    EXPECT_EQ(f.euler, 2);
    EXPECT_EQ(f.shells, 1u);
    ASSERT_EQ(f.mouths.size(), 6u);
    double open = 0;
    for (const auto& [part, area] : f.mouths) open += area;
    // Closed forms: see CubeHasAMouthInEachFace.
    errors.push_back({std::abs(f.volume - 13.4973640512004), std::abs(f.wall - 40.0867222598057),
                      std::abs(open - 3.11939748230760)});
  }
  for (std::size_t i = 1; i < errors.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double order = std::log2(errors[i - 1][k] / errors[i][k]);
      EXPECT_GT(order, 1.7) << "figure " << k << " at step " << i;
    }
  }
}

class PocketMeshesOf : public ::testing::TestWithParam<const char*> {};

// Flat triangles of length h on balls of radius R from r on leave h² / 8 r of a wall's height and
// less of it in the mean; curved sides leave as much beside a mouth's rim. That of the table is
// the exact figure.
TEST_P(PocketMeshesOf, EveryPocketIsClosedAndHasTheFiguresOfTheTable) {
  const SphereSet spheres =
      read_xyzr(shared_path("reference/" + std::string(GetParam()) + ".xyzr"), kWater);
  const auto found = pockets(spheres).pockets;
  const double edge = 0.25;
  const auto meshes = pocket_meshes(spheres, found, {.edge_length = edge});
  ASSERT_EQ(meshes.size(), found.size());
  for (std::size_t p = 0; p < found.size(); ++p) {
    SCOPED_TRACE("pocket " + std::to_string(p + 1));
    expect_closed_on(spheres, found[p], meshes[p]);
    const RoomFigures f = figures_of(meshes[p]);
    EXPECT_EQ(f.mouths.size(), found[p].mouths.size());
    EXPECT_EQ(f.euler % 2, 0);
    const double sagitta = edge * edge / 8 / 2.5;  // the smallest grown radius is 2.5 Å
    EXPECT_NEAR(f.volume, found[p].volume, sagitta * found[p].area);
    EXPECT_NEAR(f.wall, found[p].area, 0.03 * found[p].area);
    for (const auto& [part, area] : f.mouths) {
      const Mouth& mouth = found[p].mouths[part - 1];
      EXPECT_NEAR(area, mouth.area, sagitta * mouth.rim);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(, PocketMeshesOf,
                         ::testing::Values("1CRN", "1UBQ", "4PTI", "4HHB", "1EJG", "133D"),
                         [](const auto& tested) { return std::string(tested.param); });

using Simplex = std::vector<SphereId>;  // ascending

Simplex simplex_of(std::initializer_list<SphereId> ids) {
  Simplex s(ids);
  std::ranges::sort(s);
  return s;
}

std::set<Simplex> simplices_in(const PowerTriangulation& t, const DualComplex& complex) {
  std::set<Simplex> found;
  for (std::uint32_t v = 0; v < t.balls.size(); ++v) {
    if (complex.in_complex[v]) found.insert({t.ids[v]});
  }
  for (const DualEdge& e : complex.edges)
    found.insert(simplex_of({t.ids[e.vertices[0]], t.ids[e.vertices[1]]}));
  for (const DualTriangle& f : complex.triangles)
    found.insert(simplex_of({t.ids[f.vertices[0]], t.ids[f.vertices[1]], t.ids[f.vertices[2]]}));
  return found;
}

// A void is, up to homotopy, its open tetrahedra with those of their faces that are not in the dual
// complex (Edelsbrunner 1995). The Euler characteristic of a solid is that of its simplices with
// the sign turned, as of every open manifold of three dimensions, and its boundary has twice that.
std::int64_t euler_of_boundary(const Pocket& pocket, const std::set<Simplex>& complex) {
  std::set<Simplex> open;
  for (const auto& [a, b, c, d] : pocket.cells) {
    open.insert(simplex_of({a, b, c, d}));
    for (const Simplex& face : {simplex_of({a, b, c}),
                                simplex_of({a, b, d}),
                                simplex_of({a, c, d}),
                                simplex_of({b, c, d}),
                                simplex_of({a, b}),
                                simplex_of({a, c}),
                                simplex_of({a, d}),
                                simplex_of({b, c}),
                                simplex_of({b, d}),
                                simplex_of({c, d}),
                                {a},
                                {b},
                                {c},
                                {d}}) {
      if (!complex.contains(face)) open.insert(face);
    }
  }
  std::int64_t euler = 0;
  for (const Simplex& s : open) euler += s.size() % 2 == 0 ? 1 : -1;
  return 2 * euler;
}

TEST(PocketMeshes, VoidsHaveTheTopologyOfTheComplex) {
  std::size_t without_handles = 0, others = 0;
  for (const std::string set : {"1UBQ", "4PTI", "4HHB"}) {
    const SphereSet spheres = read_xyzr(shared_path("reference/" + set + ".xyzr"), kWater);
    const auto found = pockets(spheres).pockets;
    const auto meshes = pocket_meshes(spheres, found);
    const PowerTriangulation t = triangulate(spheres);
    const std::set<Simplex> complex = simplices_in(t, dual_complex(t));
    for (std::size_t p = 0; p < found.size(); ++p) {
      if (found[p].kind != PocketKind::enclosed) continue;
      const std::int64_t expected = euler_of_boundary(found[p], complex);
      EXPECT_EQ(figures_of(meshes[p]).euler, expected) << set << " " << p + 1;
      ++(expected == 2 ? without_handles : others);
    }
  }
  EXPECT_GT(without_handles, 70u);
  EXPECT_GT(others, 0u);
}

// Random balls with radii from 1 to 2 Å; the sets have pockets of all kinds and sizes.
TEST(PocketMeshes, PocketsOfRandomBallsAreClosed) {
  std::mt19937_64 random(20261201);
  std::uniform_real_distribution<double> place(0, 9), radius(1, 2);
  std::size_t meshed = 0;
  for (int set = 0; set < 15; ++set) {
    std::vector<Sphere> balls;
    for (int i = 0; i < 60; ++i)
      balls.push_back({{place(random), place(random), place(random)}, radius(random)});
    const SphereSet spheres(balls);
    const auto found = pockets(spheres).pockets;
    const auto meshes = pocket_meshes(spheres, found, {.edge_length = 0.3});
    for (std::size_t p = 0; p < found.size(); ++p) {
      SCOPED_TRACE("set " + std::to_string(set) + ", pocket " + std::to_string(p + 1));
      expect_closed_on(spheres, found[p], meshes[p]);
      if (meshes[p].mesh.triangles.empty()) continue;
      EXPECT_NEAR(figures_of(meshes[p]).volume, found[p].volume, 0.3 * 0.3 / 8 * found[p].area);
      ++meshed;
    }
  }
  EXPECT_GT(meshed, 40u);
}

// Two tetrahedra on both sides of an edge that they share: the room is within each of them, so the
// edge is there twice.
TEST(PocketMeshes, RoomsThatTouchInAnEdgeAreParted) {
  const SphereSet spheres(std::vector<Sphere>{{{0, 0, 0}, 1}});
  WallMesh walls(spheres, IndexedMesh{});
  for (const Vec3d& p : {Vec3d{0, 0, 0}, Vec3d{0, 0, 1}, Vec3d{1, 1, 0.5}, Vec3d{1, -1, 0.5},
                         Vec3d{-1, 1, 0.5}, Vec3d{-1, -1, 0.5}})
    walls.add_vertex(p, on_sphere(0));
  std::vector<RoomTriangle> triangles;
  for (const auto& [a, b, c, d] : {std::array{0u, 1u, 2u, 3u}, std::array{0u, 1u, 5u, 4u}}) {
    for (const Triangle& t :
         {Triangle{a, b, c}, Triangle{a, d, b}, Triangle{a, c, d}, Triangle{b, d, c}})
      triangles.push_back({t, 0, 0});
  }
  const auto room = close_room(walls, triangles);
  ASSERT_TRUE(room.has_value());
  const RoomFigures f = figures_of(*room);
  EXPECT_NEAR(f.volume, 2.0 / 3, 1e-12);
  EXPECT_EQ(f.shells, 2u);
  EXPECT_EQ(f.euler, 4);
  triangles.pop_back();
  EXPECT_FALSE(close_room(walls, triangles).has_value());
}

TEST(PocketMeshes, RefusesEdgesWithoutLength) {
  const SphereSet spheres = balls_at_corners(4.6, 2.9);
  const auto found = pockets(spheres).pockets;
  for (const double edge : {0.0, -1.0, HUGE_VAL, std::nan("")})
    EXPECT_THROW(pocket_meshes(spheres, found, {.edge_length = edge}), InvalidInput);
}

}  // namespace
}  // namespace vdwmesh::testing
