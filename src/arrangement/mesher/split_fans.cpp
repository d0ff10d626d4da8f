// Splits non-manifold vertices. The corners of triangles at a vertex are called its wedges. Two
// wedges that share an edge at the vertex belong to one fan, so the fans are the sets of a
// union-find over the wedges. union_mesher.cpp calls this if corners of the boundary were joined:
// there, surfaces may meet in a point only.
#include "arrangement/mesher/split_fans.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/disjoint_sets.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// The corner of a triangle at one vertex of the mesh.
struct Wedge {
  // The vertex is corner `corner` of the triangle, 0 to 2. `next` and `previous` are the other two
  // vertices of the triangle.
  std::uint32_t triangle, corner, next, previous;
};

// The fans of a vertex, as sets of indices of its wedges. Wedges that share an edge are joined.
// They are found by sorting all edges at the vertex by their other ends: equal edges become
// neighbours.
DisjointSets fans_of(const std::vector<Wedge>& wedges) {
  // Entries (other end of an edge, wedge).
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ends;
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
std::vector<SphereId> spheres_of(const std::vector<Wedge>& wedges, DisjointSets& fans,
                                 std::uint32_t fan, const IndexedMesh& mesh) {
  std::vector<SphereId> spheres;
  for (std::uint32_t w = 0; w < wedges.size(); ++w) {
    if (fans.find(w) == fan) spheres.push_back(mesh.triangle_spheres[wedges[w].triangle]);
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

void split_fans(std::size_t count, IndexedMesh& mesh) {
  // The wedges at each vertex.
  std::vector<std::vector<Wedge>> wedges(count);
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& v = mesh.triangles[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (v[k] < count) wedges[v[k]].push_back({t, k, v[(k + 1) % 3], v[(k + 2) % 3]});
    }
  }
  for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
    DisjointSets fans = fans_of(wedges[vertex]);
    // name[w] is the mesh vertex of the fan whose first wedge is w. Union-find represents a set by
    // its smallest member, so the loop meets the representative of a fan before its other wedges.
    // The first fan keeps the vertex.
    std::vector<std::uint32_t> name(wedges[vertex].size(), vertex);
    for (std::uint32_t w = 0; w < wedges[vertex].size(); ++w) {
      const std::uint32_t fan = fans.find(w);
      if (fan == w) {
        if (w > 0) name[w] = copy_of(vertex, mesh);
        mesh.vertex_spheres.set(name[w], relabelled(mesh.vertex_spheres[name[w]],
                                                    spheres_of(wedges[vertex], fans, fan, mesh)));
      }
      mesh.triangles[wedges[vertex][w].triangle][wedges[vertex][w].corner] = name[fan];
    }
  }
}

}  // namespace vdwmesh
