// One pass of the search for bad moves. The projection moves a vertex from its start to the
// surface. The move is bad if it turns a triangle inside out or pushes it through another one. A
// pass only marks such vertices (MoveState::to_undo). take_back_bad_moves() in the header then puts
// them back (MoveState::just_undone) and starts the next pass, until a pass marks nothing.
//
// Turned triangles are found patch by patch with facing(), which compares a triangle's normal with
// the direction away from the atom. Crossing triangles are found in a uniform grid. Two triangles
// that cross share a cell, so every pair in a cell is tested, the bounding boxes first. A pair that
// shares several cells is tested in each of them, and marking a vertex twice does no harm. Passes
// after the first check only the patches and cells around the vertices that were just put back.
//
// Threads mark vertices while other threads read states, yet the result is always the same. Marking
// turns `moved` into `to_undo` and nothing else, and a pass asks two questions about a state: is it
// `just_undone`, and is it one of `moved` and `to_undo`? Neither answer changes by marking.
#include "refine/bad_moves.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <vector>

#include "refine/crossing_formulas.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {

// What the test of a pair needs to know about one triangle. It is gathered once per triangle and
// cell, for all pairs of the cell that the triangle belongs to.
template <class Level>
struct BadMoves<Level>::Corners {
  std::array<std::uint32_t, 3> vertex;
  std::array<Vec3d, 3> position;
  std::array<SphereId, 3> atom;
  // The lower corner of the bounding box, then the upper corner negated. All six are minima that
  // way, of coordinates or of negated coordinates, and start from infinity.
  std::array<double, 6> box;
  bool has_moved;  // whether the projection moved a vertex that has not been put back
};

template <class Level>
bool BadMoves<Level>::mark() {
  // In the first pass all cells are dirty; the constructor has set them. Without a grid there are
  // none.
  if (pass_ > 0 && grid_) find_dirty_cells();
  const auto judge_patch = [&](std::size_t patch, std::uint64_t& bad) {
    const Vertices v = level_.vertices(patch);
    if (pass_ == 0 || has_vertex_just_undone(v)) bad += mark_turned(v);
  };
  const auto judge_cell = [&](std::size_t cell, std::uint64_t& bad) {
    // No progress is reported: the call only throws Cancelled if the caller asked to stop.
    if (cell % kBlock == 0) advance(monitor_, 0);
    if (dirty_[cell]) bad += mark_crossed(cell);
  };
  const std::uint64_t bad =
      sum_all(level_.patches(), judge_patch) + sum_all(dirty_.size(), judge_cell);
  ++pass_;
  return bad > 0;
}

// Makes exactly those cells dirty that hold a triangle with a vertex just put back. Only such a
// triangle has changed since the previous pass, so at least one triangle of each new crossing is of
// this kind. bounds_of() is the box of the first and the last positions of its three corners,
// whichever of them went back, so the cells in which it may cross another triangle are dirty.
template <class Level>
void BadMoves<Level>::find_dirty_cells() {
  for_all(dirty_.size(), [&](std::size_t cell) { dirty_[cell] = 0; });
  for_all(level_.patches(), [&](std::size_t patch) {
    const Vertices v = level_.vertices(patch);
    if (!has_vertex_just_undone(v)) return;
    for (int child = 0; child < Level::kTriangles; ++child) {
      grid_->visit_cells(bounds_of(level_, v, child), [&](std::size_t cell) {
        std::atomic_ref(dirty_[cell]).store(1, std::memory_order_relaxed);
      });
    }
  });
}

// Whether a vertex of the patch was put back after the previous pass.
template <class Level>
bool BadMoves<Level>::has_vertex_just_undone(const Vertices& v) {
  return std::any_of(v.begin(), v.end(), [&](std::uint32_t i) {
    return state_of(level_, move_states_, i) == MoveState::just_undone;
  });
}

template <class Level>
void BadMoves<Level>::mark_vertices(const std::array<std::uint32_t, 3>& vertices) {
  for (const std::uint32_t v : vertices) vdwmesh::mark(level_, move_states_, v);
}

// Looks in a patch for turned triangles and marks their vertices. Returns whether there is one. A
// triangle is turned if its corners have one atom, it faces against that atom's outward normal, and
// it faced outward before the moves. A triangle of several atoms has no outward normal of its own:
// facing() measures it against the mean of the atoms' normals, which near a crease is no proof of a
// bad move. Such triangles are only counted, in ProjectionStats::turned.
template <class Level>
bool BadMoves<Level>::mark_turned(const Vertices& v) {
  bool any = false;
  for (int child = 0; child < Level::kTriangles; ++child) {
    std::array<Vec3d, 3> now, before;
    std::array<SphereId, 3> atom;
    std::array<std::uint32_t, 3> vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(Level::triangle(child)[k]);
      vertex[k] = v[i];
      now[k] = level_.mesh.positions[v[i]];
      before[k] = level_.before(v, i);
      atom[k] = level_.mesh.vertex_spheres.atoms[v[i]];
    }
    if (facing(spheres_, now.data(), atom.data()) != Facing::against_one_atom) continue;
    if (facing(spheres_, before.data(), atom.data()) != Facing::outward) continue;
    mark_vertices(vertex);
    any = true;
  }
  return any;
}

// Gathers a triangle. `triangle` is its index in the mesh after the moves.
template <class Level>
typename BadMoves<Level>::Corners BadMoves<Level>::corners(std::uint32_t triangle) {
  Corners c;
  c.vertex = level_.mesh.triangles[triangle];
  c.box.fill(std::numeric_limits<double>::infinity());
  c.has_moved = false;
  for (std::size_t k = 0; k < 3; ++k) {
    c.position[k] = level_.mesh.positions[c.vertex[k]];
    c.atom[k] = level_.mesh.vertex_spheres.atoms[c.vertex[k]];
    for (int axis = 0; axis < 3; ++axis) {
      const auto low = static_cast<std::size_t>(axis);
      c.box[low] = std::min(c.box[low], c.position[k][axis]);
      c.box[low + 3] = std::min(c.box[low + 3], -c.position[k][axis]);
    }
    c.has_moved = c.has_moved || is_away(state_of(level_, move_states_, c.vertex[k]));
  }
  return c;
}

// Whether two boxes have no point in common; boxes_overlap() says the opposite of two triangles. On
// axis i, box a ends at -a[i + 3]. There are no branches, because their outcome would be close to
// random and badly predicted.
inline bool are_apart(const std::array<double, 6>& a, const std::array<double, 6>& b) {
  int apart = 0;
  for (std::size_t i = 0; i < 3; ++i) apart |= (a[i] > -b[i + 3]) | (b[i] > -a[i + 3]);
  return apart != 0;
}

// Tests all pairs of triangles in a cell and marks the vertices of those that cross. Returns
// whether there is such a pair. A pair without a moved vertex is not tested: if its triangles
// cross, they did so before the moves, and there is nothing to take back. triangles_cross() asks
// for the atoms because it leaves triangles of one atom around a common vertex to mark_turned().
template <class Level>
bool BadMoves<Level>::mark_crossed(std::size_t cell) {
  // The triangles of this cell. Each thread keeps the vector from cell to cell, so that it
  // allocates only a few times.
  static thread_local std::vector<Corners> here;
  here.clear();
  for (const std::uint32_t t : grid_->triangles_in(cell)) here.push_back(corners(t));
  bool any = false;
  for (std::size_t i = 1; i < here.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Corners &a = here[i], &b = here[j];
      if (!(a.has_moved || b.has_moved) || are_apart(a.box, b.box)) continue;
      if (!triangles_cross(a.position.data(), a.vertex.data(), a.atom.data(), b.position.data(),
                           b.vertex.data(), b.atom.data())) {
        continue;
      }
      mark_vertices(a.vertex);
      mark_vertices(b.vertex);
      any = true;
    }
  }
  return any;
}

template class BadMoves<Given>;
template class BadMoves<Midpoints>;

}  // namespace vdwmesh
