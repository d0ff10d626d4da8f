// One pass of the search for bad moves. The projection moves a vertex from its start to the
// surface. The move is bad if it turns a triangle inside out or pushes it through another one. A
// pass only marks such vertices (MoveState::to_undo). take_back_bad_moves() in the header then puts
// them back (MoveState::just_undone) and starts the next pass, until a pass marks nothing.
//
// A patch is a group of triangles that share vertices: one given triangle, or a parent triangle's
// four children (refine/level_view.hpp). Turned triangles are found patch by patch (is_turned()).
// Crossing triangles are found in a uniform grid in which patches are listed. Two patches with
// triangles that cross share a cell. Of the cells that two patches share, they are tested in the
// one with the lowest numbers along all axes, so that each pair is tested once. The tests of a pair
// get more expensive, and each drops most of the pairs that it sees:
// 1. The boxes of the patches must overlap. Eight boxes are tested at a time
//    (refine/box_lanes.hpp).
// 2. A pair is dropped if the patches share a corner around which all patches are a star, for
//    none of these cross (refine/patch_fans.hpp), or if a plane keeps the two patches apart
//    (refine/patch_outline.hpp).
// 3. For each triangle of one patch, those of the other that cannot cross it are dropped. All four
//    are tested at a time (refine/patch_lanes.hpp).
// 4. The two triangles must cross (triangles_cross()).
// Passes after the first check only the patches and cells around the vertices that were just put
// back.
//
// Threads mark vertices while other threads read states, yet the result is always the same. Marking
// turns `moved` into `to_undo` and nothing else, and a pass asks two questions about a state: is it
// `just_undone`, and is it one of `moved` and `to_undo`? Neither answer changes by marking.
#include "refine/bad_moves.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <deque>
#include <vector>

#include "refine/box_lanes.hpp"
#include "refine/crossing_formulas.hpp"
#include "refine/patch_lanes.hpp"
#include "refine/patch_outline.hpp"
#include "refine/shared_stars.hpp"
#include "refine/subdivision_formulas.hpp"
#include "refine/vertex_moves.hpp"

namespace vdwmesh {
namespace {

bool is_just_undone(MoveState state) { return state == MoveState::just_undone; }

}  // namespace

// What tests 3 and 4 need to know about one patch. It is gathered when the first pair with this
// patch reaches test 3 in a cell, and serves all later pairs of the cell.
template <class Level>
struct BadMoves<Level>::Patch {
  Vertices vertex;
  PatchLanes triangles;
  std::uint32_t moved;  // mask of the triangles with a moved vertex that has not been put back
};

template <class Level>
bool BadMoves<Level>::mark() {
  // For the first pass the constructor has filled dirty_. If the options allow crossings, there is
  // no grid, and dirty_ is empty.
  if (pass_ > 0 && grid_) find_dirty_cells<is_just_undone>();
  const auto judge_patch = [&](std::size_t patch, std::uint64_t& bad) {
    const Vertices v = level_.vertices(patch);
    if (pass_ == 0 || has_vertex<is_just_undone>(v)) bad += mark_turned(v);
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

// Makes exactly those cells dirty that hold a patch with a vertex of a wanted state. In the first
// pass these are the vertices away from where they started, since only pairs with one of them are
// tested. Later they are those just put back: only the triangles of their patches have changed
// since the previous pass, so at least one triangle of each new crossing belongs to such a patch.
// A patch is listed in all cells that it may touch, before and after moves: its box, bounds_of(),
// contains the positions of its vertices both before and after the projection. So a crossing that
// appears because a vertex went back lies in a dirty cell.
template <class Level>
template <bool (*is_wanted)(MoveState)>
void BadMoves<Level>::find_dirty_cells() {
  for_all(dirty_.size(), [&](std::size_t cell) { dirty_[cell] = 0; });
  for_all(level_.patches(), [&](std::size_t patch) {
    const Vertices v = level_.vertices(patch);
    if (!has_vertex<is_wanted>(v)) return;
    // The patch has changed, and with it the fans of its corners.
    if (!fans_.empty()) {
      for (std::size_t k = 0; k < 3; ++k) fans_.forget(v[k]);
    }
    grid_->visit_cells(patch, [&](std::size_t cell) {
      std::atomic_ref(dirty_[cell]).store(1, std::memory_order_relaxed);
    });
  });
}

// Whether a vertex of the patch has a wanted state.
template <class Level>
template <bool (*is_wanted)(MoveState)>
bool BadMoves<Level>::has_vertex(const Vertices& v) {
  return std::any_of(v.begin(), v.end(),
                     [&](std::uint32_t i) { return is_wanted(state_of(level_, move_states_, i)); });
}

template <class Level>
void BadMoves<Level>::mark_vertices(const std::array<std::uint32_t, 3>& vertices) {
  // vdwmesh::mark() marks one vertex; the member of this name makes a whole pass.
  for (const std::uint32_t v : vertices) vdwmesh::mark(level_, move_states_, v);
}

// Looks in a patch for turned triangles (is_turned()) and marks their vertices. Returns whether
// there is one. A triangle whose corners have different atoms cannot be turned and is skipped.
// Where a triangle was before is looked up only if it now faces against its atom's normal, as
// hardly any does.
template <class Level>
bool BadMoves<Level>::mark_turned(const Vertices& v) {
  bool any = false;
  const Buffer<SphereId>& atoms = level_.mesh.vertex_spheres.atoms;
  for (int child = 0; child < Level::kTriangles; ++child) {
    const std::array<int, 3> corner = Level::triangle(child);
    std::array<Vec3d, 3> now, before;
    std::array<SphereId, 3> atom;
    std::array<std::uint32_t, 3> vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      vertex[k] = v[static_cast<std::size_t>(corner[k])];
      now[k] = level_.mesh.positions[vertex[k]];
      atom[k] = atoms[vertex[k]];
    }
    if (atom[0] != atom[1] || atom[0] != atom[2]) continue;
    if (facing(spheres_, now.data(), atom.data()) != Facing::against_one_atom) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      before[k] = level_.before(v, static_cast<std::size_t>(corner[k]));
    }
    if (!is_turned(spheres_, before, now, atom)) continue;
    mark_vertices(vertex);
    any = true;
  }
  return any;
}

// Fills `patch` for patch t of the level: its vertices, its triangles side by side for test 3, and
// which of the triangles have a moved vertex.
template <class Level>
void BadMoves<Level>::gather(std::size_t t, Patch& patch) {
  constexpr auto kTriangles = static_cast<std::size_t>(Level::kTriangles);
  static_assert(kTriangles <= kLanes);
  patch.vertex = level_.vertices(t);
  patch.moved = 0;
  std::array<Vec3d, Level::kVertices> position;
  std::array<SphereId, Level::kVertices> atom;
  std::array<std::uint32_t, Level::kVertices> away;
  for (std::size_t i = 0; i < patch.vertex.size(); ++i) {
    const std::uint32_t v = patch.vertex[i];
    position[i] = level_.mesh.positions[v];
    atom[i] = level_.mesh.vertex_spheres.atoms[v];
    away[i] = is_away(state_of(level_, move_states_, v)) ? 1 : 0;
  }
  for (std::size_t child = 0; child < kTriangles; ++child) {
    const auto corner = Level::triangle(static_cast<int>(child));
    const auto i = static_cast<std::size_t>(corner[0]), j = static_cast<std::size_t>(corner[1]),
               k = static_cast<std::size_t>(corner[2]);
    const bool one_atom = atom[i] == atom[j] && atom[i] == atom[k];
    patch.triangles.set(child, {{patch.vertex[i], patch.vertex[j], patch.vertex[k]},
                                {position[i], position[j], position[k]},
                                one_atom ? atom[i] : kNoSphere});
    patch.moved |= (away[i] | away[j] | away[k]) << child;
  }
  patch.triangles.complete(kTriangles);
}

// The patches of one cell; arrays are by the number of the patch in the cell's list. Each thread
// keeps one object from cell to cell, so that memory is allocated only a few times. The arrays may
// therefore be longer than the list, with values of earlier cells at the end.
template <class Level>
struct BadMoves<Level>::CellPatches {
  BoxLanes boxes;
  std::vector<std::uint8_t> begins;  // bit a: the cell is the first one of the patch along axis a
  SharedStars stars;
  // Made when the first pair needs them, for nearly all pairs share a star.
  std::vector<PatchOutline> outlines;
  std::vector<std::uint8_t> has_outline;
  double reach;  // Å, see take_boxes()
  // The patches with a pair that reached test 3: the first `gathered_count` elements are of this
  // cell. A deque, because references to elements must stay valid while others are appended.
  std::deque<Patch> gathered;
  std::size_t gathered_count = 0;
  std::vector<std::uint32_t> slot;  // index in `gathered` plus 1; 0 if the patch is not there

  void resize(std::size_t patches) {
    boxes.resize(patches);
    stars.resize(patches);
    slot.assign(patches, 0);
    has_outline.assign(patches, 0);
    gathered_count = 0;
    if (patches <= begins.size()) return;
    begins.resize(patches);
    outlines.resize(patches);
  }
};

// Takes the boxes of the patches of a cell, and which of their corners have stars. Returns a
// length (Å) by which any two vertices of these patches differ at most along each axis. This is
// the sum of the three sides of the box around all boxes; length_of() adds the rounding of the
// boxes to float32.
template <class Level>
double BadMoves<Level>::take_boxes(std::size_t cell, CellPatches& here) const {
  const auto listed = grid_->patches_in(cell);
  const PatchGrid::Place place = grid_->place_of(cell);
  here.resize(listed.size());
  std::array<float, 3> lower = grid_->box_of_patch(listed[0]).lower, upper = lower;
  for (std::size_t j = 0; j < listed.size(); ++j) {
    const CellBox& box = grid_->box_of_patch(listed[j]);
    const PatchGrid::Place first = grid_->place_of(box.lower);
    here.boxes.set(j, box);
    // Only patches of Midpoints, with three corners and three midpoints, have stars.
    if constexpr (Level::kVertices == 6) {
      here.stars.set(j, fans_, level_.parent.triangles[listed[j]]);
    }
    int begins = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], box.lower[axis]);
      upper[axis] = std::max(upper[axis], box.upper[axis]);
      begins |= (first[axis] == place[axis]) << axis;
    }
    here.begins[j] = static_cast<std::uint8_t>(begins);
  }
  // The sum is NaN if a side is, which the maximum of the sides might not be. A side is NaN if both
  // its ends are infinite. Every comparison with a NaN fails: so no plane keeps patches apart then,
  // and all pairs are tested.
  double reach = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) reach += grid_->length_of(lower[axis], upper[axis]);
  return reach;
}

// Returns the outline of a patch of a cell, relative to a vertex of the first patch, so that no
// coordinate exceeds the reach.
template <class Level>
const PatchOutline& BadMoves<Level>::outline(std::size_t cell, std::size_t i,
                                             CellPatches& here) const {
  if (here.has_outline[i] != 0) return here.outlines[i];
  const auto listed = grid_->patches_in(cell);
  const Buffer<Vec3d>& positions = level_.mesh.positions;
  const Vec3d origin = positions[level_.vertices(listed[0])[0]];
  const Vertices v = level_.vertices(listed[i]);
  std::array<Vec3d, Level::kVertices> position;
  for (std::size_t k = 0; k < v.size(); ++k) position[k] = positions[v[k]] - origin;
  here.outlines[i].set(v, position, here.reach);
  here.has_outline[i] = 1;
  return here.outlines[i];
}

// Whether a patch must be tested with itself. If a corner of the patch has a star around it, no two
// of its children cross. If all vertices have one atom, triangles_cross() would report nothing:
// each two of the four children share a vertex, and it leaves such pairs of one atom to
// mark_turned(). Otherwise planes may keep the children apart.
template <class Level>
bool BadMoves<Level>::may_cross_itself(std::size_t cell, std::size_t i, CellPatches& here) const {
  if constexpr (Level::kTriangles == 1) return false;
  if (here.stars.has_star(i)) return false;
  const Buffer<SphereId>& atoms = level_.mesh.vertex_spheres.atoms;
  const Vertices v = level_.vertices(grid_->patches_in(cell)[i]);
  const auto is_first_atom = [&](std::uint32_t k) { return atoms[k] == atoms[v[0]]; };
  if (atoms[v[0]] != kNoSphere && std::all_of(v.begin(), v.end(), is_first_atom)) return false;
  return !outline(cell, i, here).separates_children(here.reach);
}

// Tests all pairs of patches that belong to a cell, and marks the vertices of triangles that cross.
// Returns whether there are such triangles.
template <class Level>
bool BadMoves<Level>::mark_crossed(std::size_t cell) {
  constexpr auto kVertices = static_cast<std::size_t>(Level::kVertices);
  constexpr int kAllAxes = 7;
  static thread_local CellPatches here;
  const auto listed = grid_->patches_in(cell);
  if (listed.empty()) return false;
  here.reach = take_boxes(cell, here);
  const auto gathered = [&](std::size_t i) -> const Patch& {
    if (here.slot[i] == 0) {
      const std::size_t next = here.gathered_count++;
      if (next == here.gathered.size()) here.gathered.emplace_back();
      gather(listed[i], here.gathered[next]);
      here.slot[i] = static_cast<std::uint32_t>(next + 1);
    }
    return here.gathered[here.slot[i] - 1];
  };
  bool any = false;
  for (std::size_t i = 0; i < listed.size(); ++i) {
    // A patch is tested with itself in its own first cell.
    if (here.begins[i] == kAllAxes && may_cross_itself(cell, i, here)) {
      any |= mark_pair(gathered(i), gathered(i));
    }
    for (std::size_t first = 0; first < i; first += BoxLanes::kLanes) {
      std::uint32_t near = here.boxes.overlapping(i, first);
      if (first + BoxLanes::kLanes > i) near &= (1u << (i - first)) - 1;
      if (Level::kVertices == 6 && near != 0) near &= ~here.stars.shared(i, first);
      for (; near != 0; near &= near - 1) {
        const std::size_t j = first + static_cast<std::size_t>(std::countr_zero(near));
        // The pair is tested in the first cell that both patches touch, and in no other. That is
        // the cell which, along each axis, is the first one of at least one of the two patches.
        if ((here.begins[i] | here.begins[j]) != kAllAxes) continue;
        // A plane through an edge of either patch may keep them apart.
        const PatchOutline &one = outline(cell, i, here), &other = outline(cell, j, here);
        if (one.template keeps_out<kVertices>(other)) continue;
        if (other.template keeps_out<kVertices>(one)) continue;
        any |= mark_pair(gathered(i), gathered(j));
      }
    }
  }
  return any;
}

// Tests each triangle of patch a with each of patch b; if that is the same patch, each pair once. A
// pair without a moved vertex is not tested: if its triangles cross, they did so before the moves,
// and there is nothing to take back.
template <class Level>
bool BadMoves<Level>::mark_pair(const Patch& a, const Patch& b) {
  bool any = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(Level::kTriangles); ++i) {
    std::uint32_t near = b.triangles.overlapping(a.triangles, i);
    if ((a.moved >> i & 1) == 0) near &= b.moved;
    if (&a == &b) near &= ~std::uint32_t{0} << (i + 1);
    if (near != 0) near &= b.triangles.may_cross(a.triangles, i);
    for (; near != 0; near &= near - 1) {
      const auto j = static_cast<std::size_t>(std::countr_zero(near));
      any |= mark_if_crossing(a, i, b, j);
    }
  }
  return any;
}

// Tests triangle i of patch a with triangle j of patch b and marks their vertices if they cross.
// triangles_cross() asks for the atoms because it leaves triangles of one atom around a common
// vertex to mark_turned().
template <class Level>
bool BadMoves<Level>::mark_if_crossing(const Patch& a, std::size_t i, const Patch& b,
                                       std::size_t j) {
  struct Corners {
    std::array<std::uint32_t, 3> vertex;
    std::array<Vec3d, 3> position;
    std::array<SphereId, 3> atom;
  };
  const auto corners = [&](const Patch& patch, std::size_t child) {
    Corners c;
    const auto corner = Level::triangle(static_cast<int>(child));
    for (std::size_t k = 0; k < 3; ++k) {
      c.vertex[k] = patch.vertex[static_cast<std::size_t>(corner[k])];
      c.position[k] = patch.triangles.corner(child, k);
      c.atom[k] = level_.mesh.vertex_spheres.atoms[c.vertex[k]];
    }
    return c;
  };
  const Corners s = corners(a, i), t = corners(b, j);
  if (!triangles_cross(s.position.data(), s.vertex.data(), s.atom.data(), t.position.data(),
                       t.vertex.data(), t.atom.data())) {
    return false;
  }
  mark_vertices(s.vertex);
  mark_vertices(t.vertex);
  return true;
}

template class BadMoves<Given>;
template class BadMoves<Midpoints>;

}  // namespace vdwmesh
