// edge_lengths(): sets what features want, and lets it spread over the mesh's edges by Dijkstra's
// algorithm.
#include "remesh/size_field.hpp"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "remesh/cell_lists.hpp"
#include "spheres/box.hpp"

namespace vdwmesh::remesh {
namespace {

constexpr double kSlope = 0.7;  // by how much wanted lengths grow, for each Å of the way
// Around a waist stand some 2 π / kWaist vertices. More would double the triangles of a molecule.
constexpr double kWaist = 6;
constexpr double kLeastShare = 0.05;  // of the edge length: no feature asks for less
constexpr double kCornerGap = 1.1;    // corners ask for this share of the gap between them

// Thin saddles that are no spindles are necks of the surface: their vertices get shorter edges.
void size_waists(const PatchedMesh& surface, const DynamicMesh& mesh, std::vector<double>& sizes) {
  for (HalfEdge h = 0; h < 3 * mesh.triangle_count(); ++h) {
    const SurfacePatch& patch = surface.patches[surface.triangle_patch[h / 3]];
    if (patch.kind != PatchKind::saddle || patch.ring_radius <= patch.radius) continue;
    double& size = sizes[mesh.from(h)];
    size = std::min(size, kWaist * footing(patch, surface.mesh.positions[mesh.from(h)]).girth);
  }
}

void size_corners(const PatchedMesh& surface, const FeatureGraph& features, double edge_length,
                  std::vector<double>& sizes) {
  const Buffer<Vec3d>& positions = surface.mesh.positions;
  std::vector<std::uint32_t> corners;
  Box box = empty_box();
  for (std::uint32_t v = 0; v < features.hold.size(); ++v) {
    if (features.hold[v] != VertexHold::corner) continue;
    corners.push_back(v);
    include(box, positions[v]);
  }
  if (corners.empty()) return;
  CellLists lists(box, edge_length);
  lists.fill([&](const auto& add) {
    for (const std::uint32_t v : corners) add(lists.cell_of(positions[v]), v);
  });
  for (const std::uint32_t v : corners) {
    const Vec3d reach{edge_length, edge_length, edge_length};
    lists.visit_cells({positions[v] - reach, positions[v] + reach},
                      [&](std::size_t cell, const Box&) {
                        for (const std::uint32_t other : lists.at(cell)) {
                          const double gap = norm(positions[other] - positions[v]);
                          if (gap >= kJoining * edge_length)
                            sizes[v] = std::min(sizes[v], kCornerGap * gap);
                        }
                      });
  }
}

void spread(const PatchedMesh& surface, const DynamicMesh& mesh, double edge_length,
            std::vector<double>& sizes) {
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::uint32_t v = 0; v < sizes.size(); ++v) {
    if (sizes[v] < edge_length) queue.emplace(sizes[v], v);
  }
  while (!queue.empty()) {
    const auto [size, v] = queue.top();
    queue.pop();
    if (size > sizes[v]) continue;
    mesh.visit_spokes(v, [&, v = v, size = size](HalfEdge h) {
      const std::uint32_t w = mesh.to(h);
      const double way = norm(surface.mesh.positions[w] - surface.mesh.positions[v]);
      const double offered = size + kSlope * way;
      if (!(offered < sizes[w])) return;
      sizes[w] = offered;
      queue.emplace(offered, w);
    });
  }
}

}  // namespace

std::vector<double> edge_lengths(const PatchedMesh& surface, const DynamicMesh& mesh,
                                 const FeatureGraph& features, double edge_length) {
  std::vector<double> sizes(mesh.vertex_count(), edge_length);
  size_waists(surface, mesh, sizes);
  size_corners(surface, features, edge_length, sizes);
  for (double& size : sizes) size = std::max(size, kLeastShare * edge_length);
  spread(surface, mesh, edge_length, sizes);
  return sizes;
}

}  // namespace vdwmesh::remesh
