// Generates the case table at compile time. For each of the 256 cases:
// 1. On every face of the cell, each maximal run of inside corners, going around the face, is cut
//    off from the others by one segment between two cell edges.
// 2. The segments of the six faces chain into closed loops: the boundary of the surface in the
//    cell.
// 3. Each loop is triangulated by a backtracking search that draws no diagonal in a cell face.
// 4. Each half-edge of the triangles gets its opposite: another half-edge of the cell, or a slot in
//    the face across which the neighbouring cell has it.
// The segments that step 1 draws on a face depend on the signs of this face's corners only, and the
// cell across the face has the same corners there. So both cells draw the same segments on it, and
// the mesh is closed for every combination of cases.
#include "extract/bricks/case_table.hpp"

#include <algorithm>
#include <array>

namespace vdwmesh {
namespace {

constexpr int kCellEdges = 12;
constexpr int kNone = -1;

constexpr int corner_at(int x, int y, int z) { return x | y << 1 | z << 2; }

// The cell edge between two adjacent corners, numbered as case_table.hpp says. The corners differ
// in one bit, which is the axis; the lower corner has this bit clear.
constexpr int edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : ((a ^ b) == 2 ? 1 : 2);
  const int low = a & b;
  const int x = low & 1, y = low >> 1 & 1, z = low >> 2;
  if (axis == 0) return y | z << 1;
  if (axis == 1) return 4 + (x | z << 1);
  return 8 + (x | y << 1);
}

// Corners of each face, counter-clockwise seen from outside the cell. Faces are numbered as in
// case_table.hpp: 2 * axis + side.
constexpr std::array<std::array<int, 4>, 6> kFaces = {{
    {corner_at(0, 0, 0), corner_at(0, 0, 1), corner_at(0, 1, 1), corner_at(0, 1, 0)},
    {corner_at(1, 0, 0), corner_at(1, 1, 0), corner_at(1, 1, 1), corner_at(1, 0, 1)},
    {corner_at(0, 0, 0), corner_at(1, 0, 0), corner_at(1, 0, 1), corner_at(0, 0, 1)},
    {corner_at(0, 1, 0), corner_at(0, 1, 1), corner_at(1, 1, 1), corner_at(1, 1, 0)},
    {corner_at(0, 0, 0), corner_at(0, 1, 0), corner_at(1, 1, 0), corner_at(1, 0, 0)},
    {corner_at(0, 0, 1), corner_at(1, 0, 1), corner_at(1, 1, 1), corner_at(0, 1, 1)},
}};

// The cell edge from corner k of a face to the next corner around it; k is taken modulo 4.
constexpr int face_edge(const std::array<int, 4>& face, int k) {
  return edge_between(face[static_cast<std::size_t>(k & 3)],
                      face[static_cast<std::size_t>((k + 1) & 3)]);
}

// Whether some face of the cell has both cell edges.
constexpr bool share_face(int a, int b) {
  for (const auto& face : kFaces) {
    bool has_a = false, has_b = false;
    for (int k = 0; k < 4; ++k) {
      has_a |= face_edge(face, k) == a;
      has_b |= face_edge(face, k) == b;
    }
    if (has_a && has_b) return true;
  }
  return false;
}

using Successors = std::array<int, kCellEdges>;

// Steps 1 and 2: the successor of each cell edge along the boundary of the surface, or kNone if the
// edge is not crossed.
//
// Around a face, a run of inside corners k + 1 .. end begins after the crossed edge (k, k + 1) and
// ends before the crossed edge (end, end + 1). One segment leads from the second of these edges
// back to the first. Every cell edge lies in two faces, and walking around them counter-clockwise
// passes the edge in opposite directions. So a crossed edge ends a run on one of its faces and
// begins a run on the other. Thus every crossed edge has one successor and one predecessor, and the
// segments chain into closed loops.
//
// Seen from outside the surface the loops run clockwise.
constexpr Successors surface_segments(int inside) {
  Successors next{};
  next.fill(kNone);
  for (const auto& face : kFaces) {
    const auto is_inside = [&](int k) {
      return (inside >> face[static_cast<std::size_t>(k & 3)] & 1) != 0;
    };
    for (int k = 0; k < 4; ++k) {
      if (is_inside(k) || !is_inside(k + 1)) continue;
      int end = k + 1;
      while (is_inside(end + 1)) ++end;
      next[static_cast<std::size_t>(face_edge(face, end))] = face_edge(face, k);
    }
  }
  return next;
}

// A closed loop of crossed cell edges, the corners of a polygon.
struct CaseLoop {
  std::array<int, kCellEdges> edges{};
  int size = 0;
};

// Whether a triangle may have a side from loop corner i to loop corner j, i < j. Sides of the loop
// are always allowed; a diagonal of the loop is allowed if it does not lie in a face of the cell.
constexpr bool allowed(const CaseLoop& loop, int i, int j) {
  const bool side = j - i == 1 || j - i == loop.size - 1;
  return side || !share_face(loop.edges[static_cast<std::size_t>(i)],
                             loop.edges[static_cast<std::size_t>(j)]);
}

// The triangles of a case: edges[3 t + k] is the cell edge on which corner k of triangle t lies.
struct Triangles {
  std::array<std::uint8_t, std::size_t{3} * kMaxCaseTriangles> edges{};
  int count = 0;
};

// Step 3: appends a triangulation of the polygon with the loop corners i, i + 1, .., j to `out`. It
// tries every corner k between i and j as the third corner of the triangle at the side (i, j), and
// triangulates the two polygons that remain, i .. k and k .. j. Returns false, with `out`
// unchanged, if every choice needs a diagonal that is not allowed. The loop is clockwise and i < k
// < j, so the order (i, j, k) makes triangles that wind counter-clockwise seen from outside.
constexpr bool triangulate(const CaseLoop& loop, int i, int j, Triangles& out) {
  if (j - i < 2) return true;
  for (int k = i + 1; k < j; ++k) {
    if (!allowed(loop, i, k) || !allowed(loop, k, j)) continue;
    Triangles attempt = out;
    const std::array<int, 3> corners{i, j, k};
    for (std::size_t c = 0; c < 3; ++c) {
      attempt.edges[static_cast<std::size_t>(3 * attempt.count) + c] =
          static_cast<std::uint8_t>(loop.edges[static_cast<std::size_t>(corners[c])]);
    }
    ++attempt.count;
    if (!triangulate(loop, i, k, attempt) || !triangulate(loop, k, j, attempt)) continue;
    out = attempt;
    return true;
  }
  return false;
}

// All triangles of a case. The inner loop takes one loop of edges out of `next`. The throw proves
// at compile time that every case has a triangulation: a throw that ran would not compile.
constexpr Triangles triangles_of(int inside) {
  Successors next = surface_segments(inside);
  Triangles out;
  for (int first = 0; first < kCellEdges; ++first) {
    CaseLoop loop;
    for (int e = first; next[static_cast<std::size_t>(e)] != kNone;) {
      loop.edges[static_cast<std::size_t>(loop.size++)] = e;
      const int following = next[static_cast<std::size_t>(e)];
      next[static_cast<std::size_t>(e)] = kNone;
      e = following;
    }
    if (loop.size > 0 && !triangulate(loop, 0, loop.size - 1, out)) throw "no triangulation";
  }
  return out;
}

// Slot (0 .. 3) of a cell edge in a face, as case_table.hpp numbers slots, or kNone if the edge
// does not lie in the face.
constexpr int slot_in_face(int edge, int face) {
  const int axis = face / 2, side = face & 1;
  const CellEdge e = cell_edge(edge);
  const int offset[3] = {e.x, e.y, e.z};
  if (e.axis == axis || offset[axis] != side) return kNone;
  const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
  return e.axis == u ? offset[v] : 2 + offset[u];
}

// The half-edge that runs from cell edge `start` to cell edge `end`, or kNone.
constexpr int half_edge_between(const Triangles& t, int start, int end) {
  for (int h = 0; h < 3 * t.count; ++h) {
    const int following = h % 3 == 2 ? h - 2 : h + 1;
    if (t.edges[static_cast<std::size_t>(h)] == start &&
        t.edges[static_cast<std::size_t>(following)] == end) {
      return h;
    }
  }
  return kNone;
}

// Step 4: fills `across` and `face_half_edge` of a case. A half-edge without an opposite in the
// cell is a segment of step 1 and lies in exactly one face. Its opposite is in the cell across that
// face and runs backwards, so it starts at the slot where this half-edge ends.
constexpr void link_half_edges(const Triangles& t, std::size_t inside, CaseTable& table) {
  for (std::uint8_t& h : table.face_half_edge[inside]) h = kNoHalfEdge;
  for (int h = 0; h < 3 * t.count; ++h) {
    const int start = t.edges[static_cast<std::size_t>(h)];
    const int end = t.edges[static_cast<std::size_t>(h % 3 == 2 ? h - 2 : h + 1)];
    const int partner = half_edge_between(t, end, start);
    if (partner != kNone) {
      table.across[inside][h] = static_cast<std::uint8_t>(partner);
      continue;
    }
    for (int face = 0; face < 6; ++face) {
      const int from = slot_in_face(start, face), to = slot_in_face(end, face);
      if (from == kNone || to == kNone) continue;
      table.across[inside][h] = static_cast<std::uint8_t>(kFirstFaceCode + 4 * face + to);
      table.face_half_edge[inside][4 * face + from] = static_cast<std::uint8_t>(h);
    }
  }
}

constexpr CaseTable make_case_table() {
  CaseTable table{};
  for (std::size_t inside = 0; inside < 256; ++inside) {
    const Triangles t = triangles_of(static_cast<int>(inside));
    table.triangle_count[inside] = static_cast<std::uint8_t>(t.count);
    std::copy(t.edges.begin(), t.edges.end(), table.edges[inside]);
    link_half_edges(t, inside, table);
  }
  return table;
}

constexpr CaseTable kTable = make_case_table();

}  // namespace

const CaseTable& case_table() { return kTable; }

}  // namespace vdwmesh
