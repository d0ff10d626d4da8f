// CGAL's triangulation, and the definition of a constrained Delaunay triangulation, edge by edge.
#include "reference/planar_delaunay.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace vdwmesh::reference {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Vertex = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using Face = CGAL::Constrained_triangulation_face_base_2<Kernel>;
using Planar =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel,
                                               CGAL::Triangulation_data_structure_2<Vertex, Face>,
                                               CGAL::No_constraint_intersection_tag>;

Point point(const FlatPoint& p) { return {p[0], p[1]}; }

// The vertex opposite to every directed edge of the triangles.
using Opposite = std::map<FlatSegment, std::uint32_t>;

std::string index_edges(const std::vector<FlatTriangle>& triangles, Opposite& opposite) {
  for (const FlatTriangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!opposite.emplace(FlatSegment{t[(k + 1) % 3], t[(k + 2) % 3]}, t[k]).second) {
        return "two triangles on one side of an edge";
      }
    }
  }
  return {};
}

std::string edge_fault(const std::vector<FlatPoint>& points, const std::set<FlatSegment>& fixed,
                       const Opposite& opposite) {
  for (const auto& [edge, apex] : opposite) {
    const auto [a, b] = edge;
    const auto other = opposite.find({b, a});
    if (other == opposite.end() ||
        fixed.contains(std::minmax({a, b}) == std::pair(a, b) ? edge : FlatSegment{b, a})) {
      continue;
    }
    if (in_circle(points[a], points[b], points[apex], points[other->second]) > 0) {
      return "an edge is not Delaunay";
    }
  }
  return {};
}

}  // namespace

std::vector<FlatTriangle> sorted(std::vector<FlatTriangle> triangles) {
  for (FlatTriangle& t : triangles) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

std::vector<FlatTriangle> constrained_delaunay(const std::vector<FlatPoint>& points,
                                               const std::vector<FlatSegment>& segments) {
  Planar planar;
  std::vector<Planar::Vertex_handle> handles;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    handles.push_back(planar.insert(point(points[i])));
    handles.back()->info() = i;
  }
  for (const auto& [a, b] : segments) planar.insert_constraint(handles[a], handles[b]);
  std::vector<FlatTriangle> triangles;
  for (const auto face : planar.finite_face_handles()) {
    triangles.push_back(
        {face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()});
  }
  return sorted(std::move(triangles));
}

int orientation(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c) {
  return CGAL::orientation(point(a), point(b), point(c));
}

int in_circle(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c, const FlatPoint& d) {
  return CGAL::side_of_oriented_circle(point(a), point(b), point(c), point(d));
}

bool meet(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c, const FlatPoint& d) {
  return CGAL::do_intersect(Kernel::Segment_2(point(a), point(b)),
                            Kernel::Segment_2(point(c), point(d)));
}

std::string fault(const std::vector<FlatPoint>& points, const std::vector<FlatSegment>& segments,
                  const std::vector<FlatTriangle>& triangles) {
  for (const FlatTriangle& t : triangles) {
    if (orientation(points[t[0]], points[t[1]], points[t[2]]) <= 0) return "an inverted triangle";
  }
  // Counter-clockwise triangles that match along their edges, use all points and are as many as any
  // triangulation of the hull has, cover it once.
  if (triangles.size() != constrained_delaunay(points, {}).size())
    return "too many or few triangles";
  std::set<std::uint32_t> used;
  for (const FlatTriangle& t : triangles) used.insert(t.begin(), t.end());
  if (used.size() != points.size()) return "a point is no vertex";
  Opposite opposite;
  if (const std::string wrong = index_edges(triangles, opposite); !wrong.empty()) return wrong;
  std::set<FlatSegment> fixed;
  for (const auto& [a, b] : segments) {
    fixed.insert({std::min(a, b), std::max(a, b)});
    if (!opposite.contains({a, b}) && !opposite.contains({b, a})) return "a segment is no edge";
  }
  return edge_fault(points, fixed, opposite);
}

}  // namespace vdwmesh::reference
