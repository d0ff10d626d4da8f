// survey_part(): the topology of a triangle soup, vertex by vertex, without an array of its edges.
// A corner is one vertex of one triangle. The corners at a vertex tell everything about its edges
// and about how the triangles lie around it.
//
//  1. Triangles are grouped by ranges of vertices (mesh/connect/groups_by_range.hpp). All other
//  steps work
//     on one range at a time, whose corners stay in the cache of a core.
//  2. A counting sort groups the corners of the range by vertex.
//  3. A walk around each vertex shows whether its triangles form one closed fan. If so, each of its
//     edges has two half-edges in opposite directions. Otherwise its edges are found by sorting and
//     judged one by one.
//
// Every edge is counted at its smaller vertex (MeshPart::is_smaller()).
#include "analysis/survey/vertex_survey.hpp"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/lanes/multiversion.hpp"
#include "mesh/connect/groups_by_range.hpp"
#include "surface/triangle_check.hpp"

namespace vdwmesh {
namespace {

// A corner, as its vertex v sees it: the triangle is v, next, previous, in this order or turned. So
// a half-edge runs from v to `next`, and one from `previous` to v.
struct FanCorner {
  std::uint32_t previous, next;
};

using FoundEdge = std::array<std::uint32_t, 2>;  // the vertices at its ends, ascending

// An end of a half-edge at a vertex: the vertex at its other end, and whether it comes from there.
struct EdgeEnd {
  std::uint32_t other;
  bool incoming;
};

// Whether the corners of vertex v are one closed fan: each half-edge from v to the next vertex of a
// corner runs back along the one from the previous vertex of another corner, and a walk from corner
// to corner in this way comes to all of them before it returns. Every edge at v then has two
// half-edges in opposite directions. Changes the order of the corners.
//
// Up to kFewCorners the corners are sorted into the order of the walk. A vertex that is `next` of
// two corners would be noticed in one of two ways: both stand behind the corner that looks for it,
// then two are found; or the first corner of all is one of them, then the walk returns too early.
// And each vertex that is `previous` of a corner is `next` of another, so every vertex is both
// once.
bool is_closed_fan_of_few(std::span<FanCorner> corners) {
  const std::uint32_t first = corners[0].next;
  for (std::size_t i = 0; i + 1 < corners.size(); ++i) {
    const std::uint32_t wanted = corners[i].previous;
    if (wanted == first) return false;
    std::size_t found = 0, following = 0;
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      const bool is_following = corners[j].next == wanted;
      found += is_following;
      following = is_following ? j : following;
    }
    if (found != 1) return false;
    std::swap(corners[i + 1], corners[following]);
  }
  return corners.back().previous == first;
}

// The same for any number: the corners are sorted by `next`, which is a different vertex for each,
// and the walk looks the following corner up. If it is back at its first corner after as many steps
// as there are corners, and not before, it has passed all of them.
bool is_closed_fan_of_many(std::span<FanCorner> corners) {
  std::ranges::sort(corners, {}, &FanCorner::next);
  if (std::ranges::adjacent_find(corners, {}, &FanCorner::next) != corners.end()) return false;
  std::size_t at = 0;
  for (std::size_t step = 1; step <= corners.size(); ++step) {
    const std::uint32_t wanted = corners[at].previous;
    const auto following = std::ranges::lower_bound(corners, wanted, {}, &FanCorner::next);
    if (following == corners.end() || following->next != wanted) return false;
    at = static_cast<std::size_t>(following - corners.begin());
    if (at == 0) return step == corners.size();
  }
  return false;
}

bool is_closed_fan(std::uint32_t v, std::span<FanCorner> corners) {
  constexpr std::size_t kFewCorners = 32;  // above, the square of the number costs more than a sort
  for (const auto& [previous, next] : corners)
    if (previous == v || next == v || previous == next) return false;
  return corners.size() <= kFewCorners ? is_closed_fan_of_few(corners)
                                       : is_closed_fan_of_many(corners);
}

// Writes the lengths of edges.
VDWMESH_MULTIVERSION void fill_lengths(const IndexedMesh& mesh, std::span<const FoundEdge> edges,
                                       double* lengths) {
  for (std::size_t e = 0; e < edges.size(); ++e)
    lengths[e] = norm(mesh.positions[edges[e][1]] - mesh.positions[edges[e][0]]);
}

// Surveys one range of vertices after another. Each thread has one.
class RangeSurveyor {
 public:
  RangeSurveyor(const MeshPart& part, const WhileSurveying& also) : part_(&part), also_(also) {}

  // Surveys the own vertices among [first, end). `triangles` are all triangles at these vertices.
  void survey(std::size_t first, std::size_t end, std::span<const std::uint32_t> triangles) {
    group_corners(first, end, triangles);
    edges_.clear();
    for (std::size_t v = first; v < std::min(end, part_->vertices); ++v) {
      const std::size_t begin = v == first ? 0 : end_of_[v - first - 1];
      survey_vertex(static_cast<std::uint32_t>(v),
                    std::span(corners_).subspan(begin, end_of_[v - first] - begin));
    }
    found_.edges += edges_.size();
    if (also_.edge_lengths == nullptr) return;
    lengths_.resize(edges_.size());
    fill_lengths(part_->mesh, edges_, lengths_.data());
    also_.edge_lengths->add(lengths_);
  }

  const PartSurvey& found() const { return found_; }

 private:
  // Step 2. Afterwards end_of_[v - first] is the end of the corners of vertex v.
  void group_corners(std::size_t first, std::size_t end, std::span<const std::uint32_t> triangles) {
    const Buffer<Triangle>& all = part_->mesh.triangles;
    end_of_.assign(end - first, 0);
    for (const std::uint32_t t : triangles)
      for (const std::uint32_t v : all[t])
        if (v - first < end - first) ++end_of_[v - first];
    std::uint32_t corners = 0;
    for (std::uint32_t& e : end_of_) corners += std::exchange(e, corners);
    corners_.resize(corners);
    for (const std::uint32_t t : triangles) {
      const auto& [a, b, c] = all[t];
      add_corner(a - first, {c, b});
      add_corner(b - first, {a, c});
      add_corner(c - first, {b, a});
    }
  }
  void add_corner(std::size_t vertex, FanCorner corner) {
    if (vertex < end_of_.size()) corners_[end_of_[vertex]++] = corner;
  }

  // Step 3.
  void survey_vertex(std::uint32_t v, std::span<FanCorner> corners) {
    if (corners.empty()) return;
    ++found_.used_vertices;
    if (!is_closed_fan(v, corners)) {
      judge_edges(v, corners);
      return;
    }
    for (const FanCorner& corner : corners)
      if (part_->is_smaller(v, corner.next)) add_edge(v, corner.next);
  }

  void judge_edges(std::uint32_t v, std::span<const FanCorner> corners) {
    found_.manifold = false;
    ends_.clear();
    for (const auto& [previous, next] : corners) {
      if (part_->is_smaller(v, next)) ends_.push_back({next, false});
      if (part_->is_smaller(v, previous)) ends_.push_back({previous, true});
    }
    std::ranges::sort(ends_, {}, &EdgeEnd::other);
    for (auto first = ends_.begin(); first != ends_.end();) {
      const auto end = std::find_if(first, ends_.end(),
                                    [=](const EdgeEnd& e) { return e.other != first->other; });
      const auto sides = end - first, incoming = std::count_if(first, end, &incoming_of);
      found_.closed &= sides == 2;
      found_.at_most_two_sides &= sides <= 2;
      // An edge on the boundary, with one half-edge, is always oriented.
      found_.oriented &= sides == 1 || 2 * incoming == sides;
      add_edge(v, first->other);
      first = end;
    }
  }
  static bool incoming_of(const EdgeEnd& end) { return end.incoming; }

  void add_edge(std::uint32_t smaller, std::uint32_t larger) {
    edges_.push_back({smaller, larger});
    if (also_.connected != nullptr) also_.connected->join(smaller, larger);
  }

  const MeshPart* part_;
  WhileSurveying also_;
  PartSurvey found_{true, true, true, true, 0, 0};
  Buffer<std::uint32_t> end_of_;  // by vertex of the range
  Buffer<FanCorner> corners_;     // of the range, by vertex
  std::vector<EdgeEnd> ends_;     // of one vertex
  std::vector<FoundEdge> edges_;  // of the range
  Buffer<double> lengths_;        // of edges_
};

// The triangles at each range of vertices.
GroupsByRange<std::uint32_t> triangles_by_range(const IndexedMesh& mesh) {
  return {mesh.triangle_count(), mesh.vertex_count(), [&](std::size_t t, const auto& emit) {
            const auto& [a, b, c] = mesh.triangles[t];
            const std::size_t of_a = a / kVerticesPerRange, of_b = b / kVerticesPerRange,
                              of_c = c / kVerticesPerRange;
            const auto item = static_cast<std::uint32_t>(t);
            emit(item, of_a);
            if (of_b != of_a) emit(item, of_b);
            if (of_c != of_a && of_c != of_b) emit(item, of_c);
          }};
}

}  // namespace

PartSurvey survey_part(const MeshPart& part, const WhileSurveying& also) {
  const IndexedMesh& mesh = part.mesh;
  const TriangleCheck check = check_triangles(mesh.triangles, mesh.vertex_count());
  const GroupsByRange<std::uint32_t> groups = triangles_by_range(mesh);
  tbb::enumerable_thread_specific<RangeSurveyor> surveyors(part, also);
  tbb::parallel_for(std::size_t{0}, groups.ranges(), [&](std::size_t r) {
    const std::size_t first = r * kVerticesPerRange,
                      end = std::min(first + kVerticesPerRange, mesh.vertex_count());
    surveyors.local().survey(first, end, groups.of(r));
  });
  PartSurvey all{true, true, true, !check.repeated_index.has_value(), 0, 0};
  for (const RangeSurveyor& surveyor : surveyors) {
    const PartSurvey& found = surveyor.found();
    all.closed &= found.closed;
    all.manifold &= found.manifold;
    all.oriented &= found.oriented;
    all.at_most_two_sides &= found.at_most_two_sides;
    all.edges += found.edges;
    all.used_vertices += found.used_vertices;
  }
  all.manifold &= all.closed && all.oriented && all.at_most_two_sides;
  return all;
}

}  // namespace vdwmesh
