// The crease-exact mesh of any balls.
#include <algorithm>

#include "arrangement/exact_mesher.hpp"
#include "fuzz/mesh_promises.hpp"
#include "fuzz/sphere_maker.hpp"

namespace vdwmesh::fuzz {
namespace {

constexpr int kMostSpheres = 12;
constexpr std::uint64_t kMemory = std::uint64_t{4} << 20;  // bytes, so that inputs stay small

double largest_radius(const SphereSet& spheres) {
  double largest = 0;
  for (const Sphere& s : spheres.spheres()) largest = std::max(largest, s.radius);
  return largest;
}

void check_labels(const IndexedMesh& mesh, std::size_t spheres) {
  require(mesh.triangle_spheres.size() == mesh.triangle_count(), "every triangle has its sphere");
  for (const SphereId id : mesh.triangle_spheres) require(id < spheres, "labels are spheres");
}

}  // namespace

void run_input(const std::uint8_t* data, std::size_t size) {
  ByteSource bytes(data, size);
  const double share = bytes.real(0.3, 1.2);
  const SphereSet spheres = make_spheres(bytes, kMostSpheres);
  ExactMeshOptions options;
  options.edge_length = share * largest_radius(spheres);
  options.memory_limit = kMemory;
  allow_refusal([&] {
    const IndexedMesh mesh = mesh_union(spheres, options).mesh;
    check_mesh(mesh, spheres.size());
    check_labels(mesh, spheres.size());
  });
}

}  // namespace vdwmesh::fuzz
