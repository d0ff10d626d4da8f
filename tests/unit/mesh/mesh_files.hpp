// Meshes for tests of mesh files, and what comes back of them.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <random>

#include "mesh/mesh_io.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh::testing {

inline constexpr MeshFormat kFormats[] = {MeshFormat::ply, MeshFormat::obj, MeshFormat::off,
                                          MeshFormat::stl, MeshFormat::glb};

// A mesh with coordinates that use every bit, normals and labels.
inline IndexedMesh labelled_mesh(double size = 50) {
  IndexedMesh mesh = scaled(icosphere(3), size / 3);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> shake(-0.01, 0.01);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    Vec3d& p = mesh.positions[v];
    p = p + Vec3d{shake(random), shake(random), shake(random)};
    mesh.normals.push_back(cast<float>((1 / norm(p)) * p));
    mesh.vertex_spheres.push_back({v, v % 3 == 0 ? kNoSphere : v / 2, kNoSphere});
  }
  return mesh;
}

inline MeshFile round_trip(const IndexedMesh& mesh, MeshFormat format) {
  return decode_mesh(encode_mesh(to_surface_mesh(mesh), format).bytes, format);
}

inline bool same_bits(const Vec3d& a, const Vec3d& b) {
  for (int k = 0; k < 3; ++k)
    if (std::bit_cast<std::uint64_t>(a[k]) != std::bit_cast<std::uint64_t>(b[k])) return false;
  return true;
}

inline void expect_same_bits(const IndexedMesh& a, const IndexedMesh& b) {
  ASSERT_EQ(a.vertex_count(), b.vertex_count());
  for (std::size_t v = 0; v < a.vertex_count(); ++v)
    EXPECT_TRUE(same_bits(a.positions[v], b.positions[v])) << "vertex " << v;
}

}  // namespace vdwmesh::testing
