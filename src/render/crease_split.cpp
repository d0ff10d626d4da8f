// Splits vertices at creases. A copy of a vertex belongs to one sphere; a hash map from the pair
// (vertex, sphere) to the index of the copy makes sure that each copy is made once. Copies are
// numbered in the order in which the triangles first use them, so the result depends on the input
// alone.
#include "render/crease_split.hpp"

#include <fmt/format.h>

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

}  // namespace

IndexedMesh split_at_creases(const IndexedMesh& mesh, const SphereSet& spheres) {
  check(mesh, spheres);
  IndexedMesh split;
  split.triangle_spheres = mesh.triangle_spheres;
  split.triangles.resize(mesh.triangle_count());
  std::unordered_map<std::uint64_t, std::uint32_t> places;  // key: vertex << 32 | sphere
  places.reserve(mesh.vertex_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const SphereId sphere = mesh.triangle_spheres[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[t][k];
      if (split.vertex_count() == kMaxVertices) {
        throw LimitExceeded(fmt::format("a picture of more than {} vertices", kMaxVertices));
      }
      const auto next = static_cast<std::uint32_t>(split.vertex_count());
      const auto [place, added] = places.try_emplace(std::uint64_t{v} << 32 | sphere, next);
      split.triangles[t][k] = place->second;
      // The copy of v for this sphere exists already.
      if (!added) continue;
      split.positions.push_back(mesh.positions.at(v));
      split.normals.push_back(outward(spheres[sphere], mesh.positions[v]));
      split.vertex_spheres.push_back(on_sphere(sphere));
    }
  }
  return split;
}

}  // namespace vdwmesh
