// The constrained Delaunay triangulation of points in the plane by CGAL, and a check of any other
// triangulation against the definition, with exact predicates. Shares no code with src/.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace vdwmesh::reference {

using FlatPoint = std::array<double, 2>;
using FlatSegment = std::array<std::uint32_t, 2>;   // indices of points
using FlatTriangle = std::array<std::uint32_t, 3>;  // indices of points, counter-clockwise

// What CGAL makes of points, no two of them equal, and segments that meet in their ends only.
// Triangles cover the convex hull. Each begins with its lowest index, and they ascend.
std::vector<FlatTriangle> constrained_delaunay(const std::vector<FlatPoint>& points,
                                               const std::vector<FlatSegment>& segments);

// The same triangles in the same form, if their order is another one.
std::vector<FlatTriangle> sorted(std::vector<FlatTriangle> triangles);

// The signs of CGAL's exact orientation and in-circle tests.
int orientation(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c);
int in_circle(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c, const FlatPoint& d);

// Whether two closed segments have a point in common.
bool meet(const FlatPoint& a, const FlatPoint& b, const FlatPoint& c, const FlatPoint& d);

// What is wrong with a triangulation of the convex hull, in words; empty if nothing is. It must use
// every point, have all segments as edges, and no edge but these may have the opposite vertex of
// one of its triangles inside the circumcircle of the other.
std::string fault(const std::vector<FlatPoint>& points, const std::vector<FlatSegment>& segments,
                  const std::vector<FlatTriangle>& triangles);

}  // namespace vdwmesh::reference
