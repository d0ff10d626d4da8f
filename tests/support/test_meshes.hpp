// Meshes whose measures and topology are known from mathematics, served by property.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh::testing {

inline IndexedMesh make_mesh(const std::vector<Vec3d>& positions,
                             const std::vector<Triangle>& triangles) {
  IndexedMesh mesh;
  mesh.positions.assign(positions.begin(), positions.end());
  mesh.triangles.assign(triangles.begin(), triangles.end());
  return mesh;
}

inline IndexedMesh translated(IndexedMesh mesh, const Vec3d& shift) {
  for (Vec3d& p : mesh.positions) p = p + shift;
  return mesh;
}

inline IndexedMesh scaled(IndexedMesh mesh, double factor) {
  for (Vec3d& p : mesh.positions) p = factor * p;
  return mesh;
}

// Inside out.
inline IndexedMesh reversed(IndexedMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  mesh.opposite.clear();
  return mesh;
}

inline IndexedMesh together(const IndexedMesh& a, const IndexedMesh& b) {
  IndexedMesh mesh = a;
  mesh.opposite.clear();
  mesh.positions.insert(mesh.positions.end(), b.positions.begin(), b.positions.end());
  const auto shift = static_cast<std::uint32_t>(a.vertex_count());
  for (const auto& [i, j, k] : b.triangles)
    mesh.triangles.push_back({i + shift, j + shift, k + shift});
  return mesh;
}

inline IndexedMesh empty_mesh() { return {}; }

// Corner of the unit cube: volume 1/6, area 3/2 + sqrt(3)/2.
inline IndexedMesh tetrahedron() {
  return make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                   {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
}

// The unit cube: vertex 4z + 2y + x.
inline IndexedMesh cube() {
  std::vector<Vec3d> p;
  for (int i = 0; i < 8; ++i) p.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  return make_mesh(p, {{0, 2, 1},
                       {1, 2, 3},
                       {4, 5, 6},
                       {5, 7, 6},
                       {0, 1, 4},
                       {1, 5, 4},
                       {2, 6, 3},
                       {3, 6, 7},
                       {0, 4, 2},
                       {2, 4, 6},
                       {1, 3, 5},
                       {3, 7, 5}});
}

// Vertices at distance 1: volume 4/3, area 4 sqrt(3).
inline IndexedMesh octahedron() {
  return make_mesh(
      {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
}

// Edge 2: volume 5 (3 + sqrt(5)) / 12 · 8, area 5 sqrt(3) · 4.
inline IndexedMesh icosahedron() {
  const double g = std::numbers::phi;
  return make_mesh(
      {{-1, g, 0},
       {1, g, 0},
       {-1, -g, 0},
       {1, -g, 0},
       {0, -1, g},
       {0, 1, g},
       {0, -1, -g},
       {0, 1, -g},
       {g, 0, -1},
       {g, 0, 1},
       {-g, 0, -1},
       {-g, 0, 1}},
      {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
       {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
       {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}});
}

// The icosahedron's faces split in four `levels` times, all vertices on the unit sphere; area and
// volume go to 4π and 4π/3 with order 2 in the edge length. 20·4^levels triangles.
inline IndexedMesh icosphere(int levels) {
  IndexedMesh mesh = icosahedron();
  const auto to_sphere = [](const Vec3d& p) { return (1 / norm(p)) * p; };
  for (Vec3d& p : mesh.positions) p = to_sphere(p);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto next = static_cast<std::uint32_t>(mesh.vertex_count());
      const auto [it, added] = middles.try_emplace({std::min(a, b), std::max(a, b)}, next);
      if (added) mesh.positions.push_back(to_sphere(mesh.positions[a] + mesh.positions[b]));
      return it->second;
    };
    Buffer<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const Triangle& t :
           {Triangle{a, ab, ca}, Triangle{ab, b, bc}, Triangle{ca, bc, c}, Triangle{ab, bc, ca}})
        finer.push_back(t);
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

// Each triangle cut into four by the midpoints of its edges; vertices are not shared.
inline IndexedMesh quartered(const IndexedMesh& mesh) {
  IndexedMesh finer;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
    const auto first = static_cast<std::uint32_t>(finer.vertex_count());
    for (const Vec3d& p : {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)})
      finer.positions.push_back(p);
    for (const Triangle& t :
         {Triangle{0, 3, 5}, Triangle{3, 1, 4}, Triangle{5, 4, 2}, Triangle{3, 4, 5}})
      finer.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return finer;
}

// The unit sphere by `around` meridians and `along` circles of latitude, poles included: the
// triangles at the equator are some `along` times as large as those at the poles.
inline IndexedMesh latitudes(std::uint32_t around, std::uint32_t along) {
  IndexedMesh mesh = make_mesh({{0, 0, 1}, {0, 0, -1}}, {});
  const auto id = [=](std::uint32_t row, std::uint32_t k) { return 2 + row * around + k % around; };
  for (std::uint32_t row = 0; row < along; ++row)
    for (std::uint32_t k = 0; k < around; ++k) {
      const double a = std::numbers::pi * (row + 1) / (along + 1),
                   b = 2 * std::numbers::pi * k / around;
      mesh.positions.push_back({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  for (std::uint32_t k = 0; k < around; ++k) {
    mesh.triangles.push_back({0, id(0, k), id(0, k + 1)});
    mesh.triangles.push_back({1, id(along - 1, k + 1), id(along - 1, k)});
    for (std::uint32_t row = 0; row + 1 < along; ++row) {
      mesh.triangles.push_back({id(row, k), id(row + 1, k), id(row + 1, k + 1)});
      mesh.triangles.push_back({id(row, k), id(row + 1, k + 1), id(row, k + 1)});
    }
  }
  return mesh;
}

// A grid of u × v quads, closed in both directions; genus 1. Radii 3 and 1: area and volume go to
// 12π² and 6π² with order 2.
inline IndexedMesh torus(std::uint32_t u, std::uint32_t v) {
  IndexedMesh mesh;
  for (std::uint32_t i = 0; i < u; ++i)
    for (std::uint32_t j = 0; j < v; ++j) {
      const double a = 2 * std::numbers::pi * i / u, b = 2 * std::numbers::pi * j / v;
      const double r = 3 + std::cos(b);
      mesh.positions.push_back({r * std::cos(a), r * std::sin(a), std::sin(b)});
    }
  const auto id = [=](std::uint32_t i, std::uint32_t j) { return (i % u) * v + j % v; };
  for (std::uint32_t i = 0; i < u; ++i)
    for (std::uint32_t j = 0; j < v; ++j) {
      mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  return mesh;
}

// A square picture frame, 3 × 3 × 1 with a hole of 1 × 1: genus 1, volume 8, area 32.
inline IndexedMesh frame() {
  IndexedMesh mesh;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) mesh.positions.push_back({double(x), double(y), double(z)});
  const auto id = [](int x, int y, int z) {
    return static_cast<std::uint32_t>(16 * z + 4 * y + x);
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  const auto solid = [](int x, int y) {
    return x >= 0 && x < 3 && y >= 0 && y < 3 && !(x == 1 && y == 1);
  };
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 3; ++x) {
      if (!solid(x, y)) continue;
      quad(id(x, y, 1), id(x + 1, y, 1), id(x + 1, y + 1, 1), id(x, y + 1, 1));
      quad(id(x, y, 0), id(x, y + 1, 0), id(x + 1, y + 1, 0), id(x + 1, y, 0));
      if (!solid(x - 1, y)) quad(id(x, y, 0), id(x, y, 1), id(x, y + 1, 1), id(x, y + 1, 0));
      if (!solid(x + 1, y))
        quad(id(x + 1, y, 0), id(x + 1, y + 1, 0), id(x + 1, y + 1, 1), id(x + 1, y, 1));
      if (!solid(x, y - 1)) quad(id(x, y, 0), id(x + 1, y, 0), id(x + 1, y, 1), id(x, y, 1));
      if (!solid(x, y + 1))
        quad(id(x, y + 1, 0), id(x, y + 1, 1), id(x + 1, y + 1, 1), id(x + 1, y + 1, 0));
    }
  return mesh;
}

// A cube of edge 3 with a cubic void of edge 1: volume 26, area 60.
inline IndexedMesh hollow_cube() {
  return together(translated(scaled(cube(), 3), {-1, -1, -1}), reversed(cube()));
}

// n triangles around one vertex, n >= 3: a disc with boundary. Unit radius.
inline IndexedMesh disc(std::uint32_t n) {
  IndexedMesh mesh;
  mesh.positions.push_back({0, 0, 0});
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    mesh.positions.push_back({std::cos(a), std::sin(a), 0});
    mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  return mesh;
}

// A square with a square hole: two boundaries. Area 8.
inline IndexedMesh flat_ring() {
  IndexedMesh mesh = make_mesh(
      {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}}, {});
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t j = (i + 1) % 4;
    mesh.triangles.push_back({i, j, 4 + j});
    mesh.triangles.push_back({i, 4 + j, 4 + i});
  }
  return mesh;
}

// n quads in a band with half a twist, n >= 3: no orientation fits.
inline IndexedMesh mobius_strip(std::uint32_t n) {
  IndexedMesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    for (const double s : {-0.5, 0.5}) {
      const double r = 2 + s * std::cos(a / 2);
      mesh.positions.push_back({r * std::cos(a), r * std::sin(a), s * std::sin(a / 2)});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;  // where the band closes, its sides change places
    const std::uint32_t a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    mesh.triangles.push_back({a, c, d});
    mesh.triangles.push_back({a, d, b});
  }
  return mesh;
}

// Two tetrahedra with one vertex in common.
inline IndexedMesh tetrahedra_sharing_vertex() {
  IndexedMesh mesh = together(tetrahedron(), scaled(tetrahedron(), -1));
  for (std::size_t t = 4; t < 8; ++t) {
    for (std::uint32_t& v : mesh.triangles[t]) v = v == 4 ? 0 : v - 1;
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);  // mirrored at the origin
  }
  mesh.positions.erase(mesh.positions.begin() + 4);
  return mesh;
}

// Two tetrahedra with one edge in common, on four triangles.
inline IndexedMesh tetrahedra_sharing_edge() {
  return make_mesh(
      {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
      {{0, 3, 2}, {0, 2, 1}, {0, 1, 3}, {2, 3, 1}, {0, 5, 4}, {0, 4, 1}, {0, 1, 5}, {4, 5, 1}});
}

// What mathematics says of one of these meshes.
struct KnownMesh {
  std::string name;
  IndexedMesh mesh;
  bool closed, manifold, oriented;
  std::uint64_t shells;
  std::int64_t euler_characteristic;
  std::optional<std::int64_t> genus;
  std::uint64_t components = 0, voids = 0;  // of closed, oriented ones
  double area = 0, volume = 0;              // NaN where no closed form is given here
};

inline std::vector<KnownMesh> known_meshes() {
  const double nan = std::nan(""), r3 = std::sqrt(3.0), r5 = std::sqrt(5.0);

  const double corner = 1.5 + r3 / 2;
  return {
      {"tetrahedron", tetrahedron(), true, true, true, 1, 2, 0, 1, 0, corner, 1.0 / 6},
      {"cube", cube(), true, true, true, 1, 2, 0, 1, 0, 6, 1},
      {"inverted_cube", reversed(cube()), true, true, true, 1, 2, 0, 0, 1, 6, -1},
      {"octahedron", octahedron(), true, true, true, 1, 2, 0, 1, 0, 4 * r3, 4.0 / 3},
      {"icosahedron", icosahedron(), true, true, true, 1, 2, 0, 1, 0, 20 * r3, 10 * (3 + r5) / 3},
      {"icosphere", icosphere(3), true, true, true, 1, 2, 0, 1, 0, nan, nan},
      {"torus", torus(16, 8), true, true, true, 1, 0, 1, 1, 0, nan, nan},
      {"frame", frame(), true, true, true, 1, 0, 1, 1, 0, 32, 8},
      {"hollow_cube", hollow_cube(), true, true, true, 2, 4, 0, 1, 1, 60, 26},
      {"two_cubes", together(cube(), translated(cube(), {5, 0, 0})), true, true, true, 2, 4, 0, 2,
       0, 12, 2},
      {"disc", disc(4), false, true, true, 1, 1, {}, 0, 0, 2, 0},
      {"flat_ring", flat_ring(), false, true, true, 1, 0, {}, 0, 0, 8, 0},
      {"mobius_strip", mobius_strip(12), false, true, false, 1, 0, {}, 0, 0, nan, 0},
      {"sharing_vertex",
       tetrahedra_sharing_vertex(),
       true,
       false,
       true,
       2,
       3,
       {},
       2,
       0,
       2 * corner,
       1.0 / 3},
      {"sharing_edge",
       tetrahedra_sharing_edge(),
       false,
       false,
       true,
       1,
       3,
       {},
       0,
       0,
       2 * corner,
       0},
      {"empty", empty_mesh(), true, true, true, 0, 0, 0, 0, 0, 0, 0},
      {"single_triangle",
       make_mesh({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}}),
       false,
       true,
       true,
       1,
       1,
       {},
       0,
       0,
       0.5,
       0},
  };
}

// Those that a half-edge mesh can hold.
inline std::vector<KnownMesh> known_half_edge_meshes() {
  std::vector<KnownMesh> meshes = known_meshes();
  std::erase_if(meshes, [](const KnownMesh& m) { return !m.manifold || !m.oriented; });
  return meshes;
}

}  // namespace vdwmesh::testing
