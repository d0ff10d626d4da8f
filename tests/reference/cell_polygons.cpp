#include "reference/cell_polygons.hpp"

#include <cassert>
#include <optional>

namespace vdwmesh::reference {
namespace {

using Loop = std::vector<int>;

int edge_between(int a, int b) {
  const auto& edges = cell_edges();
  for (int e = 0; e < 12; ++e) {
    if ((edges[e].a == a && edges[e].b == b) || (edges[e].a == b && edges[e].b == a)) return e;
  }
  assert(false);
  return -1;
}

// Corners of the face `side` of `axis`, counter-clockwise seen from outside the cell.
std::array<int, 4> face_corners(int axis, int side) {
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  if (side == 1) return {base, base | u, base | u | v, base | v};
  return {base, base | v, base | u | v, base | u};
}

bool on_face(int edge, int axis, int side) {
  const CellEdge e = cell_edges()[static_cast<std::size_t>(edge)];
  return (e.a >> axis & 1) == side && (e.b >> axis & 1) == side;
}

bool share_face(int e, int f) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      if (on_face(e, axis, side) && on_face(f, axis, side)) return true;
    }
  }
  return false;
}

// next[e] = the edge that the boundary polygon visits after e. Seen from outside the cell and
// walking a face counter-clockwise, every run of inside corners is entered over one edge and left
// over another; the polygon side goes from the edge of entering to that of leaving, with the inside
// on its right: seen along the surface's outward normal the polygon is counter-clockwise. Runs end
// at outside corners only, which separates inside corners across a diagonal.
std::array<int, 12> polygon_successors(unsigned inside) {
  std::array<int, 12> next;
  next.fill(-1);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const std::array<int, 4> c = face_corners(axis, side);
      const auto in = [&](int i) { return (inside >> c[i & 3] & 1u) != 0; };
      for (int i = 0; i < 4; ++i) {
        if (in(i) || !in(i + 1)) continue;
        int last = i + 1;
        while (in(last + 1)) ++last;
        const int entered = edge_between(c[i], c[(i + 1) & 3]);
        const int left = edge_between(c[last & 3], c[(last + 1) & 3]);
        next[static_cast<std::size_t>(entered)] = left;
      }
    }
  }
  return next;
}

std::vector<Loop> loops(unsigned inside) {
  std::array<int, 12> next = polygon_successors(inside);
  std::vector<Loop> result;
  for (int start = 0; start < 12; ++start) {
    if (next[static_cast<std::size_t>(start)] < 0) continue;
    Loop loop;
    for (int e = start; next[static_cast<std::size_t>(e)] >= 0;) {
      loop.push_back(e);
      const int following = next[static_cast<std::size_t>(e)];
      next[static_cast<std::size_t>(e)] = -1;
      e = following;
    }
    result.push_back(loop);
  }
  return result;
}

using Triangles = std::vector<std::array<int, 3>>;

// Triangles of the part first..last of the loop, whose closing side is already allowed.
std::optional<Triangles> triangulate(const Loop& loop, std::size_t first, std::size_t last) {
  if (last - first < 2) return Triangles{};
  for (std::size_t apex = first + 1; apex < last; ++apex) {
    const bool low_ok = apex == first + 1 || !share_face(loop[first], loop[apex]);
    const bool high_ok = last == apex + 1 || !share_face(loop[apex], loop[last]);
    if (!low_ok || !high_ok) continue;
    const auto low = triangulate(loop, first, apex), high = triangulate(loop, apex, last);
    if (!low || !high) continue;
    Triangles result{{loop[first], loop[apex], loop[last]}};
    result.insert(result.end(), low->begin(), low->end());
    result.insert(result.end(), high->begin(), high->end());
    return result;
  }
  return std::nullopt;
}

Triangles triangles_of(unsigned inside) {
  Triangles result;
  for (const Loop& loop : loops(inside)) {
    const auto part = triangulate(loop, 0, loop.size() - 1);
    assert(part);
    result.insert(result.end(), part->begin(), part->end());
  }
  return result;
}

}  // namespace

const std::array<CellEdge, 12>& cell_edges() {
  static const std::array<CellEdge, 12> edges = [] {
    std::array<CellEdge, 12> all{};
    std::size_t n = 0;
    for (int a = 0; a < 8; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        if ((a >> axis & 1) == 0) all[n++] = {a, a | 1 << axis};
      }
    }
    return all;
  }();
  return edges;
}

const std::vector<std::array<int, 3>>& cell_triangles(unsigned inside) {
  static const auto table = [] {
    std::array<Triangles, 256> all;
    for (unsigned flag = 0; flag < 256; ++flag) all[flag] = triangles_of(flag);
    return all;
  }();
  return table[inside];
}

}  // namespace vdwmesh::reference
