// Topology of a triangle soup from its edges: closed, manifold, oriented, and its shells (pieces
// whose triangles are connected across edges). EdgeBuckets group the half-edges of each edge; a
// half-edge is descending if it runs from the larger vertex index to the smaller one.
//
//  1. Every edge is examined by itself: the number of its half-edges and their directions. If it
//     has two half-edges, they are recorded as opposite to each other.
//  2. If every edge has two half-edges in opposite directions, the triangles around each vertex
//     form one or more closed fans. Walks around the vertices show whether each has only one fan.
//  3. If every vertex has one fan, the mesh is a closed 2-manifold. Triangles that share a vertex
//     are then connected across edges, so the connected sets of vertices are the shells. Parallel
//     union-find over the vertices finds them.
//  4. In all other cases union-find over triangles and over corners, on one thread, answers the
//     same questions (join_across_edges()).
//
// A corner is one vertex of one triangle. Corner 3t + k is at vertex k of triangle t, where
// half-edge 3t + k begins.
#include "analysis/edge_survey.hpp"

#include <algorithm>
#include <atomic>
#include <functional>

#include "core/blocks.hpp"
#include "core/disjoint_sets.hpp"
#include "core/large_pages.hpp"

namespace vdwmesh {
namespace {

// Two corners of the triangle of a half-edge: the corner at that end of the edge which has the
// smaller vertex index, and the corner at the other end.
std::uint32_t corner_at_smaller(EdgeEntry e) {
  return e.descending() ? next_in_triangle(e.half_edge()) : e.half_edge();
}
std::uint32_t corner_at_larger(EdgeEntry e) {
  return e.descending() ? e.half_edge() : next_in_triangle(e.half_edge());
}

// Properties of a set of edges that follow from each edge by itself. `manifold` says only that no
// edge has more than two half-edges.
struct EdgeCounts {
  bool closed = true, manifold = true, oriented = true;
  std::uint64_t edges = 0;

  // Adds one edge, given by its half-edges. An edge is oriented if as many half-edges run in one
  // direction as in the other; an edge on the boundary, with one half-edge, is always oriented.
  void add_edge(std::span<const EdgeEntry> edge) {
    ++edges;
    const auto down =
        std::count_if(edge.begin(), edge.end(), [](EdgeEntry entry) { return entry.descending(); });
    closed &= edge.size() == 2;
    manifold &= edge.size() <= 2;
    oriented &= edge.size() == 1 || 2 * static_cast<std::size_t>(down) == edge.size();
  }
  // Combines the properties of two sets of edges, for reduce_all() with std::plus.
  EdgeCounts operator+(const EdgeCounts& other) const {
    return {closed && other.closed, manifold && other.manifold, oriented && other.oriented,
            edges + other.edges};
  }
};

constexpr std::uint32_t kNoIndex = 0xffffffffu;  // no corner, or no shell yet

// Returns an array of `count` copies of a value, written by all cores.
Buffer<std::uint32_t> filled(std::size_t count, std::uint32_t value) {
  Buffer<std::uint32_t> array;
  resize_untouched(array, count);
  for_all(count, [&](std::size_t i) { array[i] = value; });
  return array;
}

// Carries out the steps at the head of this file. `result_` is filled step by step; until the end
// of join_across_edges(), result_.manifold says only what the edges and repeated indices allow.
class Surveyor {
 public:
  Surveyor(const MeshPart& part, const EdgeBuckets& buckets)
      : part_(part), mesh_(part.mesh), buckets_(buckets) {}

  PartSurvey run_on_part() {
    const bool sound = survey_locally();
    return {result_.closed, sound, result_.oriented, result_.edges, result_.used_vertices};
  }

  // For a whole mesh.
  EdgeSurvey run() {
    if (survey_locally()) {
      number_shells_by_vertices();
    } else {
      join_across_edges();
    }
    return std::move(result_);
  }

 private:
  bool is_own(std::size_t vertex) const {
    return vertex - part_.first_vertex < part_.end_vertex - part_.first_vertex;
  }

  // Steps 1 and 2. Examines every own edge and vertex by itself. Returns true if every edge has
  // two half-edges in opposite directions and the triangles around every vertex form one fan. The
  // mesh is then a closed manifold, and result_ lacks only its shells.
  bool survey_locally() {
    Buffer<std::uint32_t> opposite;
    resize_untouched(opposite, 3 * mesh_.triangle_count());
    const EdgeCounts counts = count_edges(opposite);
    result_.closed = counts.closed;
    result_.oriented = counts.oriented;
    result_.edges = counts.edges;
    result_.manifold = counts.manifold && !buckets_.repeated_index();
    const Buffer<std::uint32_t> corner = a_corner_of_each_vertex();
    result_.used_vertices = sum_all(
        corner.size(), [&](std::size_t v, std::uint64_t& used) { used += corner[v] != kNoIndex; });
    const bool every_edge_has_two_sides = result_.closed && result_.oriented && result_.manifold;
    return every_edge_has_two_sides && has_one_fan_everywhere(corner, opposite);
  }

  // Examines the own edges. Writes opposite[h] for the half-edges of edges that have exactly two,
  // of edges that are not own as well; the other elements remain uninitialised.
  EdgeCounts count_edges(Buffer<std::uint32_t>& opposite) const {
    const auto count = [&](std::size_t v, EdgeCounts& counts) {
      for_each_edge(buckets_.at(v), [&](std::span<const EdgeEntry> edge) {
        if (is_own(v)) counts.add_edge(edge);
        if (edge.size() != 2) return;
        opposite[edge[0].half_edge()] = edge[1].half_edge();
        opposite[edge[1].half_edge()] = edge[0].half_edge();
      });
    };
    return reduce_all(buckets_.vertex_count(), EdgeCounts{}, count, std::plus<>());
  }

  // Returns one corner of each own vertex, kNoIndex for all others. The last thread that
  // stores a corner decides which one it is; no result depends on the choice.
  Buffer<std::uint32_t> a_corner_of_each_vertex() const {
    Buffer<std::uint32_t> corner = filled(mesh_.vertex_count(), kNoIndex);
    for_all(mesh_.triangle_count(), [&](std::size_t t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        if (!is_own(mesh_.triangles[t][k])) continue;
        std::atomic_ref(corner[mesh_.triangles[t][k]])
            .store(3 * static_cast<std::uint32_t>(t) + k, std::memory_order_relaxed);
      }
    });
    return corner;
  }

  // Returns whether the triangles around every vertex form one fan. Precondition: every edge has
  // two half-edges in opposite directions. A walk goes from corner h, where half-edge h begins, to
  // corner opposite[previous half-edge of h], at the same vertex in the next triangle. This step
  // permutes the corners of a vertex, so every walk returns to its first corner. The walks from one
  // corner per vertex pass each corner at most once. If their lengths add up to the number of all
  // corners, they pass every corner, and each vertex has one fan.
  bool has_one_fan_everywhere(const Buffer<std::uint32_t>& corner,
                              const Buffer<std::uint32_t>& opposite) const {
    const auto circulate = [&](std::size_t v, std::uint64_t& corners) {
      if (corner[v] == kNoIndex) return;
      std::uint32_t at = corner[v];
      do {
        ++corners;
        at = opposite[previous_in_triangle(at)];
      } while (at != corner[v]);
    };
    const std::uint64_t met = sum_all(corner.size(), circulate);
    if (corner.size() == part_.end_vertex - part_.first_vertex) {
      return met == 3 * static_cast<std::uint64_t>(mesh_.triangle_count());
    }
    const auto own_corners = [&](std::size_t t, std::uint64_t& corners) {
      for (const std::uint32_t v : mesh_.triangles[t]) corners += is_own(v);
    };
    return met == sum_all(mesh_.triangle_count(), own_corners);
  }

  // Step 3. Finds the shells by union-find over vertices. Precondition: each vertex has one fan, so
  // all its triangles are in one shell. A closed manifold has about half as many vertices as
  // triangles, so this is less work than union-find over triangles. Each edge joins its ends once,
  // by its half-edge that is not descending. DisjointSets keeps the smallest element of a set as
  // its representative, so shell_of[t] first becomes the smallest vertex of the shell;
  // number_shells() replaces it.
  void number_shells_by_vertices() {
    DisjointSets vertices(mesh_.vertex_count());
    for_all(buckets_.vertex_count(), [&](std::size_t v) {
      for (const EdgeEntry entry : buckets_.at(v))
        if (!entry.descending()) vertices.join(static_cast<std::uint32_t>(v), entry.larger());
    });
    resize_untouched(result_.shell_of, mesh_.triangle_count());
    for_all(mesh_.triangle_count(),
            [&](std::size_t t) { result_.shell_of[t] = vertices.find(mesh_.triangles[t][0]); });
    number_shells();
  }

  // Replaces the vertices in shell_of by numbers from 0, in the order of the shells' first
  // triangles. `last` skips the table for triangles of the same shell as the triangle before them.
  void number_shells() {
    Buffer<std::uint32_t> number = filled(mesh_.vertex_count(), kNoIndex);
    result_.shells = 0;
    std::uint32_t last = kNoIndex;
    for (const std::uint32_t vertex : result_.shell_of) {
      if (vertex == last) continue;
      last = vertex;
      if (number[vertex] == kNoIndex) number[vertex] = result_.shells++;
    }
    for_all(mesh_.triangle_count(),
            [&](std::size_t t) { result_.shell_of[t] = number[result_.shell_of[t]]; });
  }

  // Step 4. Finds shells and the manifold property of any soup. Triangles are joined across all
  // edges. If an edge has two triangles, their two corners at each end of the edge are joined. The
  // triangles around a vertex then form one fan if all corners of the vertex are in one set. So the
  // mesh is manifold if there are as many sets of corners as used vertices, no edge has more than
  // two triangles and no triangle has a repeated index; result_.manifold has the last two already.
  void join_across_edges() {
    DisjointSets triangles(mesh_.triangle_count()), corners(3 * mesh_.triangle_count());
    const auto join = [&](std::span<const EdgeEntry> edge) {
      for (const EdgeEntry entry : edge.subspan(1))
        triangles.join(edge[0].half_edge() / 3, entry.half_edge() / 3);
      if (edge.size() != 2) return;
      corners.join(corner_at_smaller(edge[0]), corner_at_smaller(edge[1]));
      corners.join(corner_at_larger(edge[0]), corner_at_larger(edge[1]));
    };
    for (std::size_t v = 0; v < buckets_.vertex_count(); ++v) for_each_edge(buckets_.at(v), join);
    result_.manifold = result_.manifold && corners.count() == result_.used_vertices;
    result_.shells = std::move(triangles).number_sets(result_.shell_of);
  }

  const MeshPart part_;
  const IndexedMesh& mesh_;
  const EdgeBuckets& buckets_;
  EdgeSurvey result_{};
};

}  // namespace

EdgeSurvey survey_edges(const IndexedMesh& mesh, const EdgeBuckets& buckets) {
  return Surveyor(whole(mesh), buckets).run();
}

PartSurvey survey_part(const MeshPart& part, const EdgeBuckets& buckets) {
  return Surveyor(part, buckets).run_on_part();
}

}  // namespace vdwmesh
