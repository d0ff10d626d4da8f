#include "analysis/edge_survey.hpp"

#include <algorithm>
#include <vector>

#include "core/disjoint_sets.hpp"
#include "mesh/edge_buckets.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint32_t next_in_triangle(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }

// Corner 3t + k is that of vertex k of triangle t.
std::uint32_t corner_at_smaller(EdgeEntry e) {
  return e.descending() ? next_in_triangle(e.half_edge()) : e.half_edge();
}
std::uint32_t corner_at_larger(EdgeEntry e) {
  return e.descending() ? e.half_edge() : next_in_triangle(e.half_edge());
}

class Surveyor {
 public:
  explicit Surveyor(const IndexedMesh& mesh)
      : buckets_(mesh.triangles, mesh.vertex_count()),
        triangles_(mesh.triangle_count()),
        corners_(3 * mesh.triangle_count()) {}

  EdgeSurvey run(const IndexedMesh& mesh) {
    result_.closed = result_.oriented = true;
    result_.manifold = !buckets_.repeated_index();
    result_.edges = 0;
    for (std::size_t v = 0; v < buckets_.vertex_count(); ++v)
      for_each_edge(buckets_.at(v), [&](std::span<const EdgeEntry> edge) { take(edge); });
    result_.used_vertices = count_used(mesh);
    // Every corner of a vertex must be reached from every other across the edges between them.
    result_.manifold = result_.manifold && corners_.count() == result_.used_vertices;
    result_.shells = std::move(triangles_).number_sets(result_.shell_of);
    return std::move(result_);
  }

 private:
  void take(std::span<const EdgeEntry> edge) {
    ++result_.edges;
    const auto down =
        std::count_if(edge.begin(), edge.end(), [](EdgeEntry entry) { return entry.descending(); });
    result_.closed &= edge.size() == 2;
    result_.manifold &= edge.size() <= 2;
    result_.oriented &= edge.size() == 1 || 2 * static_cast<std::size_t>(down) == edge.size();
    for (const EdgeEntry entry : edge.subspan(1))
      triangles_.join(edge[0].half_edge() / 3, entry.half_edge() / 3);
    if (edge.size() != 2) return;
    corners_.join(corner_at_smaller(edge[0]), corner_at_smaller(edge[1]));
    corners_.join(corner_at_larger(edge[0]), corner_at_larger(edge[1]));
  }

  static std::uint64_t count_used(const IndexedMesh& mesh) {
    std::vector<bool> used(mesh.vertex_count());
    for (const Triangle& triangle : mesh.triangles)
      for (const std::uint32_t v : triangle) used[v] = true;
    return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true));
  }

  EdgeBuckets buckets_;
  DisjointSets triangles_, corners_;
  EdgeSurvey result_{};
};

}  // namespace

EdgeSurvey survey_edges(const IndexedMesh& mesh) { return Surveyor(mesh).run(mesh); }

}  // namespace vdwmesh
