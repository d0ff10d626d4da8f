// The corners of triangles at a vertex are called its wedges. Two wedges that share an edge at the
// vertex belong to one fan, so the fans are the sets of a union-find over the wedges.
#include "creases/share/split_fans.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// The fans of a vertex, as sets of indices of its wedges. Wedges that share an edge are joined.
// They are found by sorting all edges at the vertex by their other ends: equal edges become
// neighbours.
DisjointSets sets_of(std::span<const Wedge> wedges) {
  // Entries (other end of an edge, wedge).
  std::vector<std::pair<std::uint64_t, std::uint32_t>> ends;
  for (std::uint32_t w = 0; w < wedges.size(); ++w) {
    ends.push_back({wedges[w].next, w});
    ends.push_back({wedges[w].previous, w});
  }
  std::sort(ends.begin(), ends.end());
  DisjointSets sets(wedges.size());
  for (std::size_t i = 1; i < ends.size(); ++i) {
    if (ends[i].first == ends[i - 1].first) sets.join(ends[i].second, ends[i - 1].second);
  }
  return sets;
}

// Appends a copy of a vertex and returns its number.
std::uint32_t copy_of(std::uint32_t vertex, IndexedMesh& mesh) {
  const std::size_t copy = mesh.vertex_count();
  if (copy >= kMaxVertices) throw LimitExceeded("the mesh has more than 2^32 vertices");
  mesh.positions.push_back(Vec3d(mesh.positions[vertex]));
  mesh.normals.push_back(Vec3f(mesh.normals[vertex]));
  mesh.vertex_spheres.push_back(mesh.vertex_spheres[vertex]);
  return static_cast<std::uint32_t>(copy);
}

// The spheres of a fan's triangles, ascending. Empty if there are more than three, because a label
// holds three at most. `fan` is the representative of the set in `fans`.
std::vector<SphereId> spheres_of(std::span<const Wedge> wedges, DisjointSets& fans,
                                 std::uint32_t fan) {
  std::vector<SphereId> spheres;
  for (std::uint32_t w = 0; w < wedges.size(); ++w) {
    if (fans.find(w) == fan) spheres.push_back(wedges[w].sphere);
  }
  std::sort(spheres.begin(), spheres.end());
  spheres.erase(std::unique(spheres.begin(), spheres.end()), spheres.end());
  if (spheres.size() > 3) spheres.clear();
  return spheres;
}

// The label for the vertex of a fan, given its present label and the result of spheres_of().
// Usually the label stays as it is. At a joined corner it may lack a sphere of the fan; then the
// label becomes the spheres of the fan, if they fit.
VertexSpheres relabelled(const VertexSpheres& label, const std::vector<SphereId>& spheres) {
  if (spheres.empty() || std::includes(label.begin(), label.end(), spheres.begin(), spheres.end()))
    return label;
  VertexSpheres result{kNoSphere, kNoSphere, kNoSphere};
  std::copy(spheres.begin(), spheres.end(), result.begin());
  return result;
}

}  // namespace

// Union-find represents a set by its smallest member, so the loop meets the representative of a fan
// before its other wedges.
Fans fans_of(std::span<const Wedge> wedges, const VertexSpheres& label) {
  Fans fans;
  DisjointSets sets = sets_of(wedges);
  fans.of_wedge.resize(wedges.size());
  for (std::uint32_t w = 0; w < wedges.size(); ++w) {
    const std::uint32_t first = sets.find(w);
    if (first == w) {
      fans.of_wedge[w] = static_cast<std::uint32_t>(fans.labels.size());
      const VertexSpheres& before = fans.labels.empty() ? label : fans.labels.front();
      fans.labels.push_back(relabelled(before, spheres_of(wedges, sets, w)));
    }
    fans.of_wedge[w] = fans.of_wedge[first];
  }
  return fans;
}

void split_fans(std::size_t count, IndexedMesh& mesh) {
  std::vector<std::vector<Wedge>> wedges(count);  // at each vertex
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& v = mesh.triangles[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (v[k] >= count) continue;
      wedges[v[k]].push_back({t, k, mesh.triangle_spheres[t], v[(k + 1) % 3], v[(k + 2) % 3]});
    }
  }
  for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
    const Fans fans = fans_of(wedges[vertex], mesh.vertex_spheres[vertex]);
    std::vector<std::uint32_t> vertex_of{vertex};  // by fan
    for (std::size_t fan = 1; fan < fans.labels.size(); ++fan) {
      vertex_of.push_back(copy_of(vertex, mesh));
    }
    for (std::size_t fan = 0; fan < fans.labels.size(); ++fan) {
      mesh.vertex_spheres.set(vertex_of[fan], fans.labels[fan]);
    }
    for (std::size_t w = 0; w < wedges[vertex].size(); ++w) {
      const Wedge& wedge = wedges[vertex][w];
      mesh.triangles[wedge.triangle][wedge.corner] = vertex_of[fans.of_wedge[w]];
    }
  }
}

}  // namespace vdwmesh
