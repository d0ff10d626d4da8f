// One pass of the search for bad moves; the loop over the passes is in the header.
//
// Turned triangles are found patch by patch, by the sign of a triple product (facing()). Crossing
// triangles are found in a uniform grid: two triangles that cross share a cell, so every pair in a
// cell is tested, boxes first. A pair that shares several cells is tested in each of them; marking
// a vertex twice does no harm. After the first pass only patches and cells around the vertices that
// were put back are checked.
#include "refine/bad_moves.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <vector>

#include "refine/crossing_formulas.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {

// A triangle of a cell, copied once for all the pairs that it takes part in.
template <class Level>
struct BadMoves<Level>::Corners {
  std::array<std::uint32_t, 3> vertex;
  std::array<Vec3d, 3> position;
  std::array<SphereId, 3> atom;
  std::array<double, 6> box;  // lower corner, then the upper corner negated: all six are minima
  bool has_moved;             // whether a vertex is away from where it started
};

template <class Level>
bool BadMoves<Level>::mark() {
  if (pass_ > 0 && grid_) find_dirty_cells();
  const auto judge_patch = [&](std::size_t patch, std::uint64_t& bad) {
    const Vertices v = level_.vertices(patch);
    if (pass_ == 0 || has_taken_back(v)) bad += mark_turned(v);
  };
  const auto judge_cell = [&](std::size_t cell, std::uint64_t& bad) {
    if (cell % kBlock == 0) advance(monitor_, 0);
    if (dirty_[cell]) bad += mark_crossed(cell);
  };
  const std::uint64_t bad =
      sum_all(level_.patches(), judge_patch) + sum_all(dirty_.size(), judge_cell);
  ++pass_;
  return bad > 0;
}

// Marks the cells that the triangles with a vertex just put back stand in. bounds_of() covers such
// a triangle before and after any of its moves, so every new crossing is in a marked cell.
template <class Level>
void BadMoves<Level>::find_dirty_cells() {
  for_all(dirty_.size(), [&](std::size_t cell) { dirty_[cell] = 0; });
  for_all(level_.patches(), [&](std::size_t patch) {
    const Vertices v = level_.vertices(patch);
    if (!has_taken_back(v)) return;
    for (int child = 0; child < Level::kTriangles; ++child) {
      grid_->visit_cells(bounds_of(level_, v, child), [&](std::size_t cell) {
        std::atomic_ref(dirty_[cell]).store(1, std::memory_order_relaxed);
      });
    }
  });
}

template <class Level>
bool BadMoves<Level>::has_taken_back(const Vertices& v) {
  return std::any_of(v.begin(), v.end(), [&](std::uint32_t i) {
    return state_of(level_, move_states_, i) == MoveState::just_undone;
  });
}

template <class Level>
void BadMoves<Level>::mark_vertices(const std::array<std::uint32_t, 3>& vertices) {
  for (const std::uint32_t v : vertices) vdwmesh::mark(level_, move_states_, v);
}

// Marks the vertices of the patch's triangles that face against their one atom and faced outward
// before. Returns whether there is such a triangle. Triangles of several atoms are left alone.
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

// The opposite of boxes_overlap(), for boxes that are already computed. It has no branches, because
// their outcome would be close to random and badly predicted.
inline bool are_apart(const std::array<double, 6>& a, const std::array<double, 6>& b) {
  int apart = 0;
  for (std::size_t i = 0; i < 3; ++i) apart |= (a[i] > -b[i + 3]) | (b[i] > -a[i + 3]);
  return apart != 0;
}

// Marks the vertices of all pairs of triangles in the cell that cross, if a vertex of the pair has
// moved: a crossing between unmoved triangles is the given mesh's own. Returns whether any cross.
template <class Level>
bool BadMoves<Level>::mark_crossed(std::size_t cell) {
  // Kept from cell to cell, so that each thread allocates only a few times.
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
