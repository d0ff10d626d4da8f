// make_children(): local numbers of the vertices of the children. First come the own vertices of
// the parent, then the own midpoints, then the vertices of other ranks: those that the parent has,
// and behind them the midpoints, because the numbers in `elsewhere` must ascend.
#include "distributed/together/children_together.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {

void make_children(const NumberedEdges& edges, std::span<const std::uint64_t> counts,
                   SurfacePiece& piece) {
  const std::size_t parents = piece.numbers.own();
  const std::uint64_t whole = piece.numbers.whole();
  piece.numbers.append(counts);
  const std::size_t own = piece.numbers.own(), others = piece.elsewhere.size();
  if (own + others + edges.elsewhere.size() > kMaxVertices) {
    throw LimitExceeded("a rank has more than 2^32 vertices to refine: more ranks would do");
  }
  const auto vertex = [=](std::uint32_t corner) {
    return static_cast<std::uint32_t>(corner < parents ? corner : corner + (own - parents));
  };
  const auto middle = [=](std::uint32_t edge) {
    return static_cast<std::uint32_t>(edge < own - parents ? parents + edge
                                                           : parents + others + edge);
  };
  IndexedMesh& mesh = piece.mesh;
  const Buffer<Triangle> parent = std::exchange(mesh.triangles, {});
  const Buffer<SphereId> spheres = std::exchange(mesh.triangle_spheres, {});
  mesh.triangles.resize(4 * parent.size());
  mesh.triangle_spheres.resize(4 * spheres.size());
  for_all(parent.size(), [&](std::size_t t) {
    std::array<std::uint32_t, 6> patch;
    for (std::size_t k = 0; k < 3; ++k) {
      patch[k] = vertex(parent[t][k]);
      patch[k + 3] = middle(edges.edge[3 * t + k]);
    }
    for (int child = 0; child < 4; ++child) {
      Triangle& corners = mesh.triangles[4 * t + static_cast<std::size_t>(child)];
      for (int k = 0; k < 3; ++k) {
        corners[static_cast<std::size_t>(k)] =
            patch[static_cast<std::size_t>(child_corner(child, k))];
      }
    }
    if (!spheres.empty()) std::fill_n(&mesh.triangle_spheres[4 * t], 4, spheres[t]);
  });
  for (const std::uint64_t edge : edges.elsewhere) piece.elsewhere.push_back(whole + edge);
  piece.first_triangle *= 4;
  piece.whole = {piece.numbers.whole(), 4 * piece.whole.triangles};
}

}  // namespace vdwmesh
