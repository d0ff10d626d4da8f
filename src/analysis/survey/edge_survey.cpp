// Topology of a triangle soup from its edges: closed, manifold, oriented, and its shells (pieces
// whose triangles are connected across edges).
//
//  1. survey_part() judges the edges and the vertices one by one, and joins the ends of each edge
//     in a union-find over vertices.
//  2. If the triangles around every vertex form one closed fan, the mesh is a closed 2-manifold.
//     Triangles that share a vertex are then connected across edges, so the connected sets of
//     vertices are the shells. A closed manifold has about half as many vertices as triangles, so
//     this is less work than union-find over triangles.
//  3. In all other cases union-find over triangles and over corners, on one thread, answers the
//     same questions (join_across_edges()).
//
// A corner is one vertex of one triangle. Corner 3t + k is at vertex k of triangle t, where
// half-edge 3t + k begins.
#include "analysis/survey/edge_survey.hpp"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include "analysis/survey/vertex_survey.hpp"
#include "core/blocks.hpp"
#include "core/disjoint_sets.hpp"
#include "core/fixed_blocks.hpp"
#include "core/large_pages.hpp"
#include "mesh/connect/edge_buckets.hpp"

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

constexpr std::uint32_t kNoVertex = 0xffffffffu, kNoTriangle = 0xffffffffu;

// Lowers a number that several threads lower to the least that one of them has.
void lower_to(std::uint32_t& number, std::uint32_t value) {
  const std::atomic_ref place(number);
  std::uint32_t old = place.load(std::memory_order_relaxed);
  while (value < old && !place.compare_exchange_weak(old, value, std::memory_order_relaxed)) {
  }
}

// Step 2. The shells of a closed manifold, whose connected vertices are `connected`. DisjointSets
// keeps the smallest element of a set as its representative, so shell_of[t] first becomes the
// smallest vertex of the shell. It is then replaced by a number, in the order of the shells' first
// triangles. These are among the triangles of another shell than the one before; the least of them
// is written at the smallest vertex of its shell.
void number_shells(const IndexedMesh& mesh, DisjointSets connected, EdgeSurvey& survey) {
  const std::size_t triangles = mesh.triangle_count();
  // By vertex. Only the elements of vertices that stand for a set are ever touched.
  Buffer<std::uint32_t> first_of(mesh.vertex_count());
  for_all(mesh.vertex_count(), [&](std::size_t v) {
    if (connected.find(static_cast<std::uint32_t>(v)) == v) first_of[v] = kNoTriangle;
  });
  resize_untouched(survey.shell_of, triangles);
  for_each_block(triangles, kIndicesPerBlock, [&](std::size_t, std::size_t first, std::size_t end) {
    std::uint32_t last = kNoVertex;
    for (std::size_t t = first; t < end; ++t) {
      const std::uint32_t vertex = connected.find(mesh.triangles[t][0]);
      if (vertex != last) lower_to(first_of[vertex], static_cast<std::uint32_t>(t));
      survey.shell_of[t] = last = vertex;
    }
  });
  // The representatives of all sets with a triangle, in the order of their first triangles.
  auto shells = collect<std::uint32_t>(mesh.vertex_count(), [&](std::size_t v, auto& found) {
    const auto vertex = static_cast<std::uint32_t>(v);
    if (connected.find(vertex) == vertex && first_of[v] != kNoTriangle) found.push_back(vertex);
  });
  std::ranges::sort(shells, {}, [&](std::uint32_t v) { return first_of[v]; });
  survey.shells = static_cast<std::uint32_t>(shells.size());
  Buffer<std::uint32_t>& number = first_of;
  for (std::uint32_t i = 0; i < survey.shells; ++i) number[shells[i]] = i;
  for_all(triangles, [&](std::size_t t) { survey.shell_of[t] = number[survey.shell_of[t]]; });
}

// Step 3. Finds shells and the manifold property of any soup. Triangles are joined across all
// edges. If an edge has two triangles, their two corners at each end of the edge are joined. The
// triangles around a vertex then form one fan if all corners of the vertex are in one set. So the
// mesh is manifold if there are as many sets of corners as used vertices, no edge has more than
// two triangles and no triangle has a repeated index.
void join_across_edges(const IndexedMesh& mesh, bool at_most_two_sides, EdgeSurvey& survey) {
  const EdgeBuckets buckets(mesh.triangles, mesh.vertex_count());
  DisjointSets triangles(mesh.triangle_count()), corners(3 * mesh.triangle_count());
  const auto join = [&](std::span<const EdgeEntry> edge) {
    for (const EdgeEntry entry : edge.subspan(1))
      triangles.join(edge[0].half_edge() / 3, entry.half_edge() / 3);
    if (edge.size() != 2) return;
    corners.join(corner_at_smaller(edge[0]), corner_at_smaller(edge[1]));
    corners.join(corner_at_larger(edge[0]), corner_at_larger(edge[1]));
  };
  for (std::size_t v = 0; v < buckets.vertex_count(); ++v) for_each_edge(buckets.at(v), join);
  survey.manifold = at_most_two_sides && corners.count() == survey.used_vertices;
  survey.shells = std::move(triangles).number_sets(survey.shell_of);
}

}  // namespace

EdgeSurvey survey_edges(const IndexedMesh& mesh, BracketedValues* edge_lengths) {
  DisjointSets connected(mesh.vertex_count());
  const PartSurvey part = survey_part(whole(mesh), {edge_lengths, &connected});
  EdgeSurvey survey{part.closed, part.manifold, part.oriented, part.edges, part.used_vertices, 0,
                    {}};
  if (part.manifold) {
    number_shells(mesh, std::move(connected), survey);
  } else {
    join_across_edges(mesh, part.at_most_two_sides, survey);
  }
  return survey;
}

}  // namespace vdwmesh
