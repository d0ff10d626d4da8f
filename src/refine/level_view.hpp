// Three views of a refinement level with one interface, so that the code which takes bad moves back
// is written once (refine/crossings/bad_moves.hpp, refine/crossings/patch_grid.hpp). A view owns
// nothing; it refers to the meshes and arrays of the level.
//
// A level handles some vertices of its mesh: it creates or projects them, and may put them back to
// where they started. The handled vertices stand at the end of the mesh's vertex arrays. The
// triangles are visited in groups that are called patches:
//   Given (level 0): every vertex is handled, and a patch is one triangle.
//   Midpoints (level 1 and above): the midpoints of the parent's edges are handled. A patch is a
//   parent triangle. It has six vertices, the corners of the parent triangle and the midpoints of
//   its edges, and consists of the four child triangles.
//   DividedMidpoints (level 2 and above): the same midpoints. The parent was made by a subdivision,
//   too, and a patch is a triangle of the parent's own parent, with 15 vertices and 16 triangles.
//   It has four parts, which are the patches of Midpoints. There are fewer patches to search than
//   parts, and what is true of all triangles of a patch need not be asked of each part.
// All views have these members:
//   kVertices, kTriangles  how many vertices and triangles a patch has
//   patches()              the number of patches
//   vertices(t)            the vertices of patch t, as indices into the arrays of `mesh`; the first
//                          three are its corners
//   Part, kParts           the view whose patches are the parts of patches, and how many parts a
//                          patch has: those of patch t are kParts t to kParts t + kParts - 1
//   triangle(child)        the corners of triangle `child` of a patch (0 <= child < kTriangles), as
//                          indices into vertices(t)
//   before(v, i)           the position of vertex v[i] before its move, with v = vertices(t)
//   kStartsBetweenCorners  whether before(v, i) always lies in the box of vertices that never move
//   mesh                   the mesh of the level; its positions are those after the moves
//   first_handled()        index of the first handled vertex in `mesh`
//   items()                length of a loop in which each handled vertex turns up once
//   handled_by_item(item)  the vertex that turns up at index `item` of this loop, counted from
//                          first_handled(); empty if none does
//   item_of(t, i)          the item at which vertices(t)[i] turns up. Precondition: it is handled
//   kKnowsPatches          whether there is patches_at(item): the two patches that have the vertex,
//   one
//                          patch twice if the edge lies inside it
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "refine/subdivision_formulas.hpp"
#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

// What has happened to a handled vertex. A pass is one search for bad moves (BadMoves::mark()).
//   stayed       The vertex is where it started, and the triangles around it need no check.
//   moved        The projection moved it.
//   to_undo      The projection moved it, and the current pass has found the move bad.
//   just_undone  It was put back after the previous pass. The next pass checks the triangles around
//                it once more; afterwards the vertex counts as `stayed`.
enum class MoveState : std::uint8_t { stayed, moved, to_undo, just_undone };

struct Given {
  static constexpr int kVertices = 3, kTriangles = 1;
  static constexpr bool kStartsBetweenCorners = false;
  using Part = Given;
  static constexpr std::size_t kParts = 1;
  const Buffer<Vec3d>& given;  // positions before projection
  const IndexedMesh& mesh;

  std::size_t patches() const { return mesh.triangle_count(); }
  static constexpr std::array<int, 3> triangle(int) { return {0, 1, 2}; }
  std::array<std::uint32_t, 3> vertices(std::size_t t) const { return mesh.triangles[t]; }
  Vec3d before(const std::array<std::uint32_t, 3>& v, std::size_t i) const { return given[v[i]]; }
  // All vertices are handled, so the loop over them has one item per vertex.
  std::size_t first_handled() const { return 0; }
  std::size_t items() const { return mesh.vertex_count(); }
  std::optional<std::size_t> handled_by_item(std::size_t item) const { return item; }
  std::size_t item_of(std::size_t t, std::size_t i) const { return mesh.triangles[t][i]; }
  static constexpr bool kKnowsPatches = false;
};

struct Midpoints {
  static constexpr int kVertices = 6, kTriangles = 4;
  // Halves of sums are rounded, but not beyond the ends: doubling a coordinate is exact.
  static constexpr bool kStartsBetweenCorners = true;
  using Part = Midpoints;
  static constexpr std::size_t kParts = 1;
  const IndexedMesh& parent;          // closed, with `opposite`
  const Buffer<std::uint32_t>& edge;  // by half-edge of the parent: the number of its edge
  const IndexedMesh& mesh;            // its vertices: the parent's, then one midpoint per edge

  std::size_t patches() const { return parent.triangle_count(); }
  static constexpr std::array<int, 3> triangle(int child) {
    return {child_corner(child, 0), child_corner(child, 1), child_corner(child, 2)};
  }
  // The vertex of `mesh` that halves the parent's half-edge h.
  std::uint32_t midpoint_of(std::size_t h) const {
    return static_cast<std::uint32_t>(parent.vertex_count() + edge[h]);
  }
  // The corners of parent triangle t.
  const Triangle& corners(std::size_t t) const { return parent.triangles[t]; }
  // The corners of parent triangle t, then the midpoints of its half-edges 3t, 3t + 1, 3t + 2.
  std::array<std::uint32_t, 6> vertices(std::size_t t) const {
    const Triangle& v = parent.triangles[t];
    return {v[0], v[1], v[2], midpoint_of(3 * t), midpoint_of(3 * t + 1), midpoint_of(3 * t + 2)};
  }
  // Before its move a midpoint is the middle of its edge. Midpoint i of a patch halves the edge
  // from corner i - 3 to the next corner.
  Vec3d before(const std::array<std::uint32_t, 6>& v, std::size_t i) const {
    if (i < 3) return parent.positions[v[i]];
    return midpoint(parent.positions[v[i - 3]], parent.positions[v[i == 5 ? 0 : i - 2]]);
  }
  std::size_t first_handled() const { return parent.vertex_count(); }
  // The items are the parent's half-edges. The lower half-edge of an edge stands for its midpoint.
  std::size_t items() const { return parent.opposite.size(); }
  std::optional<std::size_t> handled_by_item(std::size_t h) const {
    if (parent.opposite[h] < h) return std::nullopt;
    return edge[h];
  }
  std::size_t lower_of(std::size_t h) const { return std::min<std::size_t>(h, parent.opposite[h]); }
  std::size_t item_of(std::size_t t, std::size_t i) const { return lower_of(3 * t + i - 3); }
  static constexpr bool kKnowsPatches = true;
  std::array<std::size_t, 2> patches_at(std::size_t h) const {
    return {h / 3, parent.opposite[h] / 3};
  }

  // The vertices of the parent from which and to which half-edge h runs.
  std::uint32_t start_of(std::size_t h) const { return parent.triangles[h / 3][h % 3]; }
  std::uint32_t end_of(std::size_t h) const { return parent.triangles[h / 3][(h + 1) % 3]; }
  // The position in the middle of half-edge h, from which the projection of its midpoint starts.
  Vec3d middle_of(std::size_t h) const {
    return midpoint(parent.positions[start_of(h)], parent.positions[end_of(h)]);
  }
  // The mean of the normals at the ends of half-edge h. The parent must have normals.
  Vec3f mean_normal(std::size_t h) const {
    return vdwmesh::mean_normal(parent.normals[start_of(h)], parent.normals[end_of(h)]);
  }
};

// The parent's triangles 4 t to 4 t + 3 are the children of patch t. Child k < 3 is (C_k, M_k,
// M_k-1), with the corners C_0, C_1, C_2 of the patch and the midpoints M_k of its edges C_k C_k+1;
// child 3 is (M_0, M_1, M_2). The vertices of a patch are three times three of each kind:
//   0 to 2    the corners C_k
//   3 to 5    the midpoints M_k
//   6 to 8    A_k, the midpoints of C_k M_k
//   9 to 11   B_k, the midpoints of M_k C_k+1
//   12 to 14  I_k, the midpoints of M_k M_k+1
struct DividedMidpoints : Midpoints {
  static constexpr int kVertices = 15, kTriangles = 16;
  static constexpr std::size_t kParts = 4;

  std::size_t patches() const { return parent.triangle_count() / kParts; }
  // The vertices of a part, as indices into those of the patch.
  static constexpr std::array<int, 6> vertices_of_part(int part) {
    if (part == 3) return {3, 4, 5, 12, 13, 14};
    const int before = (part + 2) % 3;
    return {part, 3 + part, 3 + before, 6 + part, 12 + before, 9 + before};
  }
  static constexpr std::array<int, 3> triangle(int child) {
    const std::array<int, 6> vertex = vertices_of_part(child / 4);
    std::array<int, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = vertex[static_cast<std::size_t>(child_corner(child % 4, static_cast<int>(k)))];
    }
    return corner;
  }
  // The number of vertices that may be corners: those of the parent's parent, which come first in
  // the parent. Precondition: the parent's parent is closed. It then has three edges for two
  // triangles, and the parent has a midpoint on each.
  std::size_t corner_vertices() const { return parent.vertex_count() - 3 * patches() / 2; }
  Triangle corners(std::size_t t) const {
    const Triangle* const child = &parent.triangles[4 * t];
    return {child[0][0], child[1][0], child[2][0]};
  }
  std::array<std::uint32_t, 15> vertices(std::size_t t) const {
    const Triangle* const child = &parent.triangles[4 * t];
    std::array<std::uint32_t, 15> v;
    for (std::size_t k = 0; k < 3; ++k) {
      v[k] = child[k][0];
      v[3 + k] = child[3][k];
      for (const std::size_t i : {6 + k, 9 + k, 12 + k}) v[i] = midpoint_of(half_edge(t, i));
    }
    return v;
  }
  // The half-edge of the parent that vertex i >= 6 of patch t halves.
  static constexpr std::size_t half_edge(std::size_t t, std::size_t i) {
    const std::size_t k = i % 3;
    return 12 * t + (i < 9 ? 3 * k : i < 12 ? 3 * ((k + 1) % 3) + 2 : 9 + k);
  }
  std::size_t item_of(std::size_t t, std::size_t i) const { return lower_of(half_edge(t, i)); }
  std::array<std::size_t, 2> patches_at(std::size_t h) const {
    return {h / 12, parent.opposite[h] / 12};
  }
  Vec3d before(const std::array<std::uint32_t, 15>& v, std::size_t i) const {
    if (i < 6) return parent.positions[v[i]];
    const std::size_t k = i % 3, next = (k + 1) % 3;
    const std::size_t from = i < 9 ? k : 3 + k, to = i < 9 ? 3 + k : i < 12 ? next : 3 + next;
    return midpoint(parent.positions[v[from]], parent.positions[v[to]]);
  }
};

// The state of mesh vertex v; `stayed` if the level does not handle v. The load is atomic because
// other threads may be marking the same vertex.
template <class Level>
MoveState state_of(const Level& level, Buffer<MoveState>& move_states, std::uint32_t v) {
  if (v < level.first_handled()) return MoveState::stayed;
  return std::atomic_ref(move_states[v - level.first_handled()]).load(std::memory_order_relaxed);
}

// Marks the move of mesh vertex v as bad, and returns whether that is new: whether v has moved, and
// no call has marked it before. Of threads that mark one vertex at the same time, one is told so.
template <class Level>
bool mark(const Level& level, Buffer<MoveState>& move_states, std::uint32_t v) {
  if (state_of(level, move_states, v) != MoveState::moved) return false;
  return std::atomic_ref(move_states[v - level.first_handled()])
             .exchange(MoveState::to_undo, std::memory_order_relaxed) == MoveState::moved;
}

// Whether a vertex in this state is away from where it started. The answer is the same before and
// after the current pass marks the vertex, so it does not matter which thread comes first.
inline bool is_away(MoveState state) {
  return state == MoveState::moved || state == MoveState::to_undo;
}

}  // namespace vdwmesh
