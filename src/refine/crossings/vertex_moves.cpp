// What is known of all triangles of a mesh around the moves of its vertices: how many face inward,
// and the longest edge at each vertex. The loops run on all cores.
#include "refine/crossings/vertex_moves.hpp"

#include <atomic>
#include <bit>

#include "core/blocks.hpp"

namespace vdwmesh {

std::uint64_t count_turned(const Sphere* spheres, const IndexedMesh& mesh, std::size_t triangles) {
  const bool labelled = mesh.triangle_labels() == TriangleLabels::spheres;
  const auto count = [&](std::size_t t, std::uint64_t& n) {
    std::array<Vec3d, 3> p;
    std::array<SphereId, 3> atom;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = mesh.positions[mesh.triangles[t][k]];
      atom[k] =
          labelled ? mesh.triangle_spheres[t] : mesh.vertex_spheres.atoms[mesh.triangles[t][k]];
    }
    n += facing(spheres, p.data(), atom.data()) != Facing::outward;
  };
  return sum_all(triangles, count);
}

// Bits of doubles >= 0, read as integers, have the same order as the doubles. So an atomic maximum
// of integers finds the largest square, and it does not depend on the order of the threads.
Buffer<std::uint64_t> longest_edge_squares(const IndexedMesh& mesh) {
  Buffer<std::uint64_t> square(mesh.vertex_count());
  for_all(square.size(), [&](std::size_t v) { square[v] = 0; });
  const auto raise = [&](std::uint32_t v, std::uint64_t bits) {
    std::atomic_ref slot(square[v]);
    std::uint64_t old = slot.load(std::memory_order_relaxed);
    // A failed exchange reloads `old`, so the loop body is empty.
    while (old < bits && !slot.compare_exchange_weak(old, bits, std::memory_order_relaxed)) {
    }
  };
  for_all(mesh.triangle_count(), [&](std::size_t t) {
    const Triangle& v = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      const double s = squared_distance(mesh.positions[a], mesh.positions[b]);
      raise(a, std::bit_cast<std::uint64_t>(s));
      raise(b, std::bit_cast<std::uint64_t>(s));
    }
  });
  return square;
}

}  // namespace vdwmesh
