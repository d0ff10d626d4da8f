// Splits vertices at creases. A copy of a vertex belongs to one sphere or patch, here called a
// piece; a hash map from the pair (vertex, piece) to the index of the copy makes sure that each
// copy is made once. Copies are numbered in the order in which the triangles first use them, so the
// result depends on the input alone.
#include "render/crease_split.hpp"

#include <fmt/format.h>

#include <cmath>
#include <unordered_map>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// Throws InvalidInput unless every triangle names a sphere of the set.
void check(const IndexedMesh& mesh, const SphereSet& spheres) {
  if (mesh.triangle_spheres.size() != mesh.triangle_count()) {
    throw InvalidInput("the mesh does not say which sphere its triangles lie on");
  }
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.triangle_spheres[t] >= spheres.size()) {
      throw InvalidInput(fmt::format("triangle {} lies on sphere {}, but there are {}", t,
                                     mesh.triangle_spheres[t], spheres.size()));
    }
  }
}

// The unit normal of the sphere at a point on it.
Vec3f outward(const Sphere& sphere, const Vec3d& point) {
  const Vec3d radius = point - sphere.center;
  return cast<float>((1 / norm(radius)) * radius);
}

// Whether a patch passes through a point, by more than the rounding of a float. A triangle of a
// mesh that does not follow the curves may have vertices beyond its patch.
bool is_on(const SurfacePatch& patch, const Vec3d& p) {
  return std::abs(norm(footing(patch, p).to_center) - patch.radius) < 1e-6;
}

// The triangles with a copy of each corner for its piece; piece_of(t) is that of a triangle, and
// add_copy(v, piece) appends one of vertex v to `split`.
template <class PieceOf, class AddCopy>
void split_triangles(const IndexedMesh& mesh, IndexedMesh& split, const PieceOf& piece_of,
                     const AddCopy& add_copy) {
  split.triangles.resize(mesh.triangle_count());
  std::unordered_map<std::uint64_t, std::uint32_t> places;  // key: vertex << 32 | piece
  places.reserve(mesh.vertex_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const std::uint32_t piece = piece_of(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      if (split.vertex_count() == kMaxVertices) {
        throw LimitExceeded(fmt::format("a picture of more than {} vertices", kMaxVertices));
      }
      const auto next = static_cast<std::uint32_t>(split.vertex_count());
      const auto [place, added] = places.try_emplace(std::uint64_t{v} << 32 | piece, next);
      split.triangles[t][k] = place->second;
      if (added) add_copy(v, piece);
    }
  }
}

}  // namespace

IndexedMesh split_at_creases(const IndexedMesh& mesh, const SphereSet& spheres) {
  check(mesh, spheres);
  IndexedMesh split;
  split.triangle_spheres = mesh.triangle_spheres;
  split_triangles(
      mesh, split, [&](std::size_t t) { return mesh.triangle_spheres[t]; },
      [&](std::uint32_t v, SphereId sphere) {
        split.positions.push_back(mesh.positions.at(v));
        split.normals.push_back(outward(spheres[sphere], mesh.positions[v]));
        split.vertex_spheres.push_back(on_sphere(sphere));
      });
  return split;
}

IndexedMesh split_at_patches(const PatchedMesh& patched) {
  check_patches(patched);
  const IndexedMesh& mesh = patched.mesh;
  const bool follows_curves = patched.vertex_patch.empty();
  IndexedMesh split;
  split_triangles(
      mesh, split, [&](std::size_t t) { return patched.triangle_patch[t]; },
      [&](std::uint32_t v, std::uint32_t patch) {
        const Vec3d& p = mesh.positions.at(v);
        const bool has_normal = follows_curves || is_on(patched.patches[patch], p);
        const Vec3f normal =
            has_normal ? cast<float>(patch_normal(patched.patches[patch], p)) : Vec3f{0, 0, 0};
        split.positions.push_back(p);
        split.normals.push_back(squared_norm(normal) > 0 ? normal : mesh.normals.at(v));
        split.vertex_spheres.push_back(on_sphere(mesh.vertex_spheres.atoms.at(v)));
      });
  return split;
}

}  // namespace vdwmesh
