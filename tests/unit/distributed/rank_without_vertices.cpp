// A program for three ranks, which test_ranks.py starts. The second one has triangles of an
// octahedron, but none of its vertices, as a run of bricks may have where the surface only touches
// it. A subdivision without a projection gives it midpoints of its own, and each has the mean of
// the normals of its edge's ends: on an octahedron around the origin, whose normals are its
// positions, the direction of the midpoint.
#include <cmath>
#include <cstdio>
#include <vector>

#include "distributed/ranks.hpp"
#include "distributed/together/refine_together.hpp"

namespace {

using namespace vdwmesh;

// Exit codes, so that the test says what went wrong.
constexpr int kNoMidpoints = 10, kNoNormals = 11, kWrongNormal = 12;

// Vertices 0, 1, 2 are at +x, +y, +z, and 3, 4, 5 opposite to them. Triangle t is in the octant
// whose signs are the bits of t: of each axis it has one end, in an order that faces outwards.
Vec3d position_of(std::uint32_t v) {
  Vec3d p{};
  p[static_cast<int>(v % 3)] = v < 3 ? 1 : -1;
  return p;
}
std::array<std::uint32_t, 3> corners_of(std::uint32_t t) {
  const std::uint32_t x = (t & 1) * 3, y = 1 + (t >> 1 & 1) * 3, z = 2 + (t >> 2 & 1) * 3;
  const bool is_mirrored = ((t ^ t >> 1 ^ t >> 2) & 1) != 0;
  return is_mirrored ? std::array{x, z, y} : std::array{x, y, z};
}

// Ranks 0 and 2 own three vertices each; all have two or three triangles.
SurfacePiece piece_of(std::uint32_t rank) {
  const std::uint32_t first_vertex = rank == 0 ? 0 : 3, vertices = rank == 1 ? 0 : 3,
                      first_triangle = 3 * rank, triangles = rank == 2 ? 2 : 3;
  SurfacePiece piece;
  piece.whole = {6, 8};
  piece.first_triangle = first_triangle;
  piece.numbers = VertexNumbers(rank);
  piece.numbers.append(std::vector<std::uint64_t>{3, 0, 3});
  for (std::uint32_t v = first_vertex; v < first_vertex + vertices; ++v) {
    const Vec3d p = position_of(v);
    piece.mesh.positions.push_back(p);
    piece.mesh.normals.push_back(
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    piece.mesh.vertex_spheres.push_back(on_sphere(0));
  }
  for (std::uint32_t v = 0; v < 6; ++v) {
    if (v < first_vertex || v >= first_vertex + vertices) piece.elsewhere.push_back(v);
  }
  for (std::uint32_t t = first_triangle; t < first_triangle + triangles; ++t) {
    Triangle& corners = piece.mesh.triangles.emplace_back(corners_of(t));
    for (std::uint32_t& v : corners) {
      const bool is_own = v >= first_vertex && v < first_vertex + vertices;
      // Of those elsewhere, the lower ones come before the own ones in the whole mesh.
      const std::uint32_t others_before = v < first_vertex ? v : v - vertices;
      v = is_own ? v - first_vertex : vertices + others_before;
    }
  }
  return piece;
}

int subdivide(const Ranks& ranks) {
  const SphereSet spheres({{{0, 0, 0}, 1}});
  SurfacePiece piece = piece_of(static_cast<std::uint32_t>(ranks.number()));
  RefineOptions options;
  options.subdivisions = 1;
  options.projection = Projection::none;
  refine_together(ranks, spheres, options, piece);
  const IndexedMesh& mesh = piece.mesh;
  if (ranks.number() == 1 && mesh.vertex_count() == 0) return kNoMidpoints;
  if (mesh.normals.size() != mesh.vertex_count()) return kNoNormals;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3d& p = mesh.positions[v];
    const Vec3f& n = mesh.normals[v];
    const Vec3d off = Vec3d{n.x, n.y, n.z} - (1 / norm(p)) * p;
    if (!(norm(off) < 1e-6)) return kWrongNormal;  // normals are floats
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const Ranks ranks(argc, argv);
  const int status = subdivide(ranks);
  if (status != 0) ranks.abort(status);
  return 0;
}
