// One pass of the search for bad moves. The projection moves a vertex from its start to the
// surface. The move is bad if it turns a triangle inside out or pushes it through another one. A
// pass only marks such vertices (MoveState::to_undo). take_back_bad_moves() in the header then puts
// them back (MoveState::just_undone) and starts the next pass, until a pass marks nothing.
//
// A patch is a group of triangles that share vertices: one given triangle, a parent triangle's four
// children, or the 16 children of four parent triangles with one parent (refine/level_view.hpp). In
// the last case it has four parts, which are the patches of four children. Turned triangles are
// found patch by patch (is_turned()). Crossing triangles are found in a uniform grid in which
// patches are listed. Two patches with triangles that cross share a cell. Of the cells that two
// patches share, they are tested in the one with the lowest numbers along all axes, so that each
// pair is tested once. The tests of a pair get more expensive, and each drops most of the pairs
// that it sees:
// 1. The boxes of the patches must overlap. Eight boxes are tested at a time
//    (refine/crossings/box_lanes.hpp).
// 2. A pair is dropped if the patches share a corner around which all patches are a star, for
//    none of these cross (refine/crossings/patch_fans.hpp).
// 3. Of patches with several parts, pairs of parts are dropped whose boxes have no point in common.
// 4. A pair of parts is dropped if a plane keeps the two apart
// (refine/crossings/patch_outline.hpp).
// 5. For each triangle of one part, those of the other that cannot cross it are dropped. All four
//    are tested at a time (refine/crossings/patch_lanes.hpp).
// 6. The two triangles must cross (triangles_cross()).
// Passes after the first check only the patches with a vertex that was just put back, and their
// pairs with others (want_changed()).
//
// Threads mark vertices while other threads read states, yet the result is always the same. Marking
// turns `moved` into `to_undo` and nothing else, and a pass asks two questions about a state: is it
// `just_undone`, and is it one of `moved` and `to_undo`? Neither answer changes by marking.
// Of threads that mark one vertex, one lists it; so the order of the list depends on the threads,
// but not what is in it, and callers use it as a set.
#include "refine/crossings/bad_moves.hpp"

#include <algorithm>
#include <bit>
#include <deque>
#include <span>
#include <vector>

#include "core/monitor.hpp"
#include "refine/crossings/box_lanes.hpp"
#include "refine/crossings/crossing_formulas.hpp"
#include "refine/crossings/facing_lanes.hpp"
#include "refine/crossings/patch_lanes.hpp"
#include "refine/crossings/patch_outline.hpp"
#include "refine/crossings/shared_stars.hpp"
#include "refine/crossings/vertex_moves.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

bool is_just_undone(MoveState state) { return state == MoveState::just_undone; }

// View::triangle() of all triangles of a patch.
template <class View>
constexpr auto kTrianglesOf = [] {
  std::array<std::array<std::uint8_t, 3>, static_cast<std::size_t>(View::kTriangles)> all{};
  for (int child = 0; child < View::kTriangles; ++child) {
    for (std::size_t k = 0; k < 3; ++k) {
      all[static_cast<std::size_t>(child)][k] = static_cast<std::uint8_t>(View::triangle(child)[k]);
    }
  }
  return all;
}();

}  // namespace

// What tests 5 and 6 need to know about one part of a patch. It is gathered when the first pair
// with this part reaches test 5 in a cell, and serves all later pairs of the cell.
template <class Level>
struct BadMoves<Level>::GatheredPart {
  std::size_t part;  // its number in the level
  std::array<std::uint32_t, Part::kVertices> vertex;
  PatchLanes triangles;
  std::uint32_t moved;  // mask of the triangles with a moved vertex that has not been put back
};

template <class Level>
const std::vector<std::size_t>& BadMoves<Level>::mark() {
  if (pass_ > 0) {
    want_changed();
  } else if (grid_ && !tests_all_) {
    want_those_with<is_away>();
  }
  marked_.clear();
  mark_all_turned();
  if (grid_) mark_all_crossed();
  ++pass_;
  return marked_.all();
}

// Makes those patches wanted that have a vertex of a wanted state. In the first pass these are the
// vertices away from where they started, since only pairs with one of them are tested.
template <class Level>
template <bool (*is_wanted)(MoveState)>
void BadMoves<Level>::want_those_with() {
  for_all(level_.patches(), [&](std::size_t patch) {
    const Vertices v = level_.vertices(patch);
    if (std::any_of(v.begin(), v.end(), [&](std::uint32_t i) {
          return is_wanted(state_of(level_, move_states_, i));
        })) {
      wanted_.choose(patch);
    }
  });
}

// Makes those patches wanted of which a vertex was put back after the last pass. Only their
// triangles have changed since. Triangles of two other patches are as the last pass saw them: if
// they crossed, and one had a moved vertex, it marked that vertex, which was put back, so its patch
// is among these. The fans of these patches have changed, too.
template <class Level>
void BadMoves<Level>::want_changed() {
  wanted_.clear();
  if constexpr (Level::kKnowsPatches) {
    const std::vector<std::size_t>& items = marked_.all();
    for_all(items.size(), [&](std::size_t i) {
      for (const std::size_t patch : level_.patches_at(items[i])) {
        if (wanted_.choose(patch) && !fans_.empty()) fans_.renew(level_, patch);
      }
    });
  } else {
    want_those_with<is_just_undone>();
  }
}

// A patch is listed in all cells that it may touch, before and after moves: its box contains the
// positions of its vertices both before and after the projection. So a crossing that appears
// because a vertex went back lies in a dirty cell, one that lists a wanted patch.
template <class Level>
void BadMoves<Level>::find_dirty_cells() {
  dirty_->clear();
  const std::vector<std::size_t>& patches = wanted_.list();
  for_all(patches.size(), [&](std::size_t i) {
    grid_->visit_cells(patches[i], [&](std::size_t cell) { dirty_->choose(cell); });
  });
}

template <class Level>
void BadMoves<Level>::mark_all_turned() {
  if (pass_ == 0) {
    for_all(level_.patches(), [&](std::size_t patch) { mark_turned(patch); });
    return;
  }
  const std::vector<std::size_t>& patches = wanted_.list();
  for_all(patches.size(), [&](std::size_t i) { mark_turned(patches[i]); });
}

template <class Level>
void BadMoves<Level>::mark_all_crossed() {
  const auto judge = [&](std::size_t i, std::size_t cell) {
    // No progress is reported: the call only throws Cancelled if the caller asked to stop.
    if (i % kBlock == 0) advance(monitor_, 0);
    mark_crossed(cell);
  };
  if (tests_all_pairs()) {
    for_all(grid_->cell_count(), [&](std::size_t cell) { judge(cell, cell); });
    return;
  }
  find_dirty_cells();
  const std::vector<std::size_t>& cells = dirty_->list();
  for_all(cells.size(), [&](std::size_t i) { judge(i, cells[i]); });
}

// Marks the vertices of a triangle of a patch of `view`, the level or that of its parts.
template <class Level>
template <class View>
void BadMoves<Level>::mark_corners(const View& view, std::size_t patch, int triangle) {
  const auto v = view.vertices(patch);
  for (const int corner : View::triangle(triangle)) {
    const auto i = static_cast<std::size_t>(corner);
    if (vdwmesh::mark(level_, move_states_, v[i])) marked_.append(view.item_of(patch, i));
  }
}

// Looks in a patch for turned triangles (is_turned()) and marks their vertices. If all its vertices
// have one atom, four triangles at a time are found to face outward.
template <class Level>
void BadMoves<Level>::mark_turned(std::size_t patch) {
  const Vertices v = level_.vertices(patch);
  if constexpr (Level::kTriangles % static_cast<int>(kLanes) == 0) {
    const Buffer<SphereId>& atoms = level_.mesh.vertex_spheres.atoms;
    const SphereId atom = atoms[v[0]];
    bool is_one = true;
    for (const std::uint32_t i : v) is_one &= atoms[i] == atom;
    if (is_one) {
      if (atom == kNoSphere) return;
      for (std::size_t first = 0; first < Level::kTriangles; first += kLanes) {
        const std::uint32_t certain = outward_for_certain(
            spheres_[atom].center, [&](std::size_t k, std::size_t lane) -> const Vec3d& {
              return level_.mesh.positions[v[kTrianglesOf<Level>[first + lane][k]]];
            });
        for (std::uint32_t left = ~certain & 0xfu; left != 0; left &= left - 1) {
          mark_if_turned(patch, v, static_cast<int>(first) + std::countr_zero(left));
        }
      }
      return;
    }
  }
  for (int child = 0; child < Level::kTriangles; ++child) mark_if_turned(patch, v, child);
}

// Marks the vertices of a triangle of a patch if it is turned. A triangle whose corners have
// different atoms cannot be turned. Where a triangle was before is looked up only if it now faces
// against its atom's normal, as hardly any does.
template <class Level>
void BadMoves<Level>::mark_if_turned(std::size_t patch, const Vertices& v, int child) {
  const std::array<int, 3> corner = Level::triangle(child);
  std::array<Vec3d, 3> now, before;
  std::array<SphereId, 3> atom;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = v[static_cast<std::size_t>(corner[k])];
    now[k] = level_.mesh.positions[vertex];
    atom[k] = level_.mesh.vertex_spheres.atoms[vertex];
  }
  if (atom[0] != atom[1] || atom[0] != atom[2]) return;
  if (facing(spheres_, now.data(), atom.data()) != Facing::against_one_atom) return;
  for (std::size_t k = 0; k < 3; ++k) {
    before[k] = level_.before(v, static_cast<std::size_t>(corner[k]));
  }
  if (is_turned(spheres_, before, now, atom)) mark_corners(level_, patch, child);
}

// Fills `gathered` for part t of the level: its vertices, its triangles side by side for test 5,
// and which of the triangles have a moved vertex.
template <class Level>
void BadMoves<Level>::gather(std::size_t t, GatheredPart& gathered) {
  constexpr auto kTriangles = static_cast<std::size_t>(Part::kTriangles);
  static_assert(kTriangles <= kLanes);
  gathered.part = t;
  gathered.vertex = parts().vertices(t);
  gathered.moved = 0;
  std::array<Vec3d, Part::kVertices> position;
  std::array<SphereId, Part::kVertices> atom;
  std::array<std::uint32_t, Part::kVertices> away;
  for (std::size_t i = 0; i < gathered.vertex.size(); ++i) {
    const std::uint32_t v = gathered.vertex[i];
    position[i] = level_.mesh.positions[v];
    atom[i] = level_.mesh.vertex_spheres.atoms[v];
    away[i] = is_away(state_of(level_, move_states_, v)) ? 1 : 0;
  }
  for (std::size_t child = 0; child < kTriangles; ++child) {
    const auto corner = Part::triangle(static_cast<int>(child));
    const auto i = static_cast<std::size_t>(corner[0]), j = static_cast<std::size_t>(corner[1]),
               k = static_cast<std::size_t>(corner[2]);
    const bool one_atom = atom[i] == atom[j] && atom[i] == atom[k];
    gathered.triangles.set(child, {{gathered.vertex[i], gathered.vertex[j], gathered.vertex[k]},
                                   {position[i], position[j], position[k]},
                                   one_atom ? atom[i] : kNoSphere});
    gathered.moved |= (away[i] | away[j] | away[k]) << child;
  }
  gathered.triangles.complete(kTriangles);
}

// The patches of one cell; arrays are by the number of the patch in the cell's list, or by that of
// the part: part a of patch i has the number kParts i + a. Each thread keeps one object from cell
// to cell, so that memory is allocated only a few times. The arrays may therefore be longer than
// the list, with values of earlier cells at the end.
template <class Level>
struct BadMoves<Level>::CellPatches {
  std::span<const std::uint32_t> listed;
  BoxLanes boxes;
  std::vector<std::uint8_t> begins;  // bit a: the cell is the first one of the patch along axis a
  // By block of BoxLanes::kLanes patches, eight, a bit for each: whether the patch is wanted.
  std::vector<std::uint32_t> wanted;
  SharedStars stars;
  std::vector<PatchOutline> outlines;  // made when the first pair needs them
  std::vector<std::uint8_t> has_outline;
  double reach;  // Å, see take_boxes()
  // The parts with a pair that reached test 5: the first `gathered_count` elements are of this
  // cell. A deque, because references to elements must stay valid while others are appended.
  std::deque<GatheredPart> gathered;
  std::size_t gathered_count = 0;
  std::vector<std::uint32_t> slot;  // index in `gathered` plus 1; 0 if the part is not there

  void take(std::span<const std::uint32_t> patches) {
    listed = patches;
    const std::size_t count = patches.size();
    boxes.resize(count);
    stars.resize(count);
    wanted.assign(count / BoxLanes::kLanes + 1, 0);
    has_outline.assign(kParts * count, 0);
    slot.assign(kParts * count, 0);
    gathered_count = 0;
    if (count <= begins.size()) return;
    begins.resize(count);
    outlines.resize(kParts * count);
  }
  // The part of the level that has this number in the cell.
  std::size_t part_of_level(std::size_t part) const {
    return kParts * listed[part / kParts] + part % kParts;
  }
};

// Takes the boxes of the patches of a cell, which of them are wanted, and which of their
// corners have stars. Returns a length (Å) by which any two vertices of these patches differ at
// most along each axis. This is the sum of the three sides of the box around all boxes; length_of()
// adds the rounding of the boxes to float32.
template <class Level>
double BadMoves<Level>::take_boxes(std::size_t cell, CellPatches& here) {
  const auto listed = grid_->patches_in(cell);
  const PatchGrid::Place place = grid_->place_of(cell);
  here.take(listed);
  std::array<float, 3> lower = grid_->box_of_patch(listed[0]).lower, upper = lower;
  for (std::size_t j = 0; j < listed.size(); ++j) {
    const PatchBox& box = grid_->box_of_patch(listed[j]);
    const PatchGrid::Place first = grid_->place_of(box.lower);
    here.boxes.set(j, box);
    if (tests_all_pairs() || wanted_[listed[j]]) {
      here.wanted[j / BoxLanes::kLanes] |= 1u << j % BoxLanes::kLanes;
    }
    if constexpr (kHasFans) here.stars.set(j, fans_, level_.corners(listed[j]));
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
  for (std::size_t axis = 0; axis < 3; ++axis) {
    reach += PatchGrid::length_of(lower[axis], upper[axis]);
  }
  return reach;
}

// Returns the outline of a part in a cell, relative to a vertex of the first patch, so that no
// coordinate exceeds the reach.
template <class Level>
const PatchOutline& BadMoves<Level>::outline(std::size_t part, CellPatches& here) const {
  PatchOutline& outline = here.outlines[part];
  if (here.has_outline[part] != 0) return outline;
  here.has_outline[part] = 1;
  const Buffer<Vec3d>& positions = level_.mesh.positions;
  const Vec3d origin = positions[parts().vertices(kParts * here.listed[0])[0]];
  const auto v = parts().vertices(here.part_of_level(part));
  std::array<Vec3d, Part::kVertices> position;
  for (std::size_t k = 0; k < v.size(); ++k) position[k] = positions[v[k]] - origin;
  outline.set(v, position, here.reach);
  return outline;
}

// Returns what gather() finds of a part in a cell.
template <class Level>
const typename BadMoves<Level>::GatheredPart& BadMoves<Level>::gathered(std::size_t part,
                                                                        CellPatches& here) {
  if (here.slot[part] == 0) {
    const std::size_t next = here.gathered_count++;
    if (next == here.gathered.size()) here.gathered.emplace_back();
    gather(here.part_of_level(part), here.gathered[next]);
    here.slot[part] = static_cast<std::uint32_t>(next + 1);
  }
  return here.gathered[here.slot[part] - 1];
}

// Whether a part must be tested with itself. If all its vertices have one atom, triangles_cross()
// would report nothing: each two of the four children share a vertex, and it leaves such pairs of
// one atom to mark_turned(). Otherwise planes may keep the children apart.
template <class Level>
bool BadMoves<Level>::may_cross_itself(std::size_t part, CellPatches& here) const {
  if constexpr (Part::kTriangles == 1) return false;
  const Buffer<SphereId>& atoms = level_.mesh.vertex_spheres.atoms;
  const auto v = parts().vertices(here.part_of_level(part));
  const auto is_first_atom = [&](std::uint32_t k) { return atoms[k] == atoms[v[0]]; };
  if (atoms[v[0]] != kNoSphere && std::all_of(v.begin(), v.end(), is_first_atom)) return false;
  return !outline(part, here).separates_children(here.reach);
}

// Tests all pairs of triangles of patch i of a cell. If a corner of the patch has a star around it,
// none of them cross.
template <class Level>
void BadMoves<Level>::mark_within(std::size_t i, CellPatches& here) {
  if (here.stars.has_star(i)) return;
  for (std::size_t a = kParts * i; a < kParts * (i + 1); ++a) {
    if (may_cross_itself(a, here)) mark_pair(gathered(a, here), gathered(a, here));
    for (std::size_t b = kParts * i; b < a; ++b) mark_parts(a, b, here);
  }
}

// Tests all triangles of patch i of a cell with all those of patch j.
template <class Level>
void BadMoves<Level>::mark_between(std::size_t i, std::size_t j, CellPatches& here) {
  if constexpr (kParts == 1) {
    mark_parts(i, j, here);
  } else {
    const PartBoxes &one = grid_->boxes_of_parts(here.listed[i]),
                    &other = grid_->boxes_of_parts(here.listed[j]);
    for (std::uint32_t near = one.overlapping(other); near != 0; near &= near - 1) {
      const auto pair = static_cast<std::size_t>(std::countr_zero(near));
      mark_parts(kParts * i + pair / kParts, kParts * j + pair % kParts, here);
    }
  }
}

// Tests the triangles of one part with those of another, unless a plane through an edge of either
// part keeps the two apart.
template <class Level>
void BadMoves<Level>::mark_parts(std::size_t a, std::size_t b, CellPatches& here) {
  constexpr auto kVertices = static_cast<std::size_t>(Part::kVertices);
  const PatchOutline &one = outline(a, here), &other = outline(b, here);
  if (one.template keeps_out<kVertices>(other)) return;
  if (other.template keeps_out<kVertices>(one)) return;
  mark_pair(gathered(a, here), gathered(b, here));
}

// Tests all pairs of patches that belong to a cell, and marks the vertices of triangles that cross.
// A pair of patches is left out if neither of the two is wanted.
template <class Level>
void BadMoves<Level>::mark_crossed(std::size_t cell) {
  constexpr int kAllAxes = 7;
  static thread_local CellPatches here;
  const std::size_t count = grid_->patches_in(cell).size();
  if (count == 0) return;
  here.reach = take_boxes(cell, here);
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_wanted = (here.wanted[i / BoxLanes::kLanes] >> i % BoxLanes::kLanes & 1) != 0;
    // A patch is tested with itself in its own first cell.
    if (is_wanted && here.begins[i] == kAllAxes) mark_within(i, here);
    for (std::size_t first = 0; first < i; first += BoxLanes::kLanes) {
      // The patches before i of a block of eight, if i is wanted; else those that are wanted.
      std::uint32_t tested = is_wanted ? 0xffu : here.wanted[first / BoxLanes::kLanes];
      if (first + BoxLanes::kLanes > i) tested &= (1u << (i - first)) - 1;
      if (tested == 0) continue;
      std::uint32_t near = tested & here.boxes.overlapping(i, first);
      if (kHasFans && near != 0) near &= ~here.stars.shared(i, first);
      for (; near != 0; near &= near - 1) {
        const std::size_t j = first + static_cast<std::size_t>(std::countr_zero(near));
        // The pair is tested in the first cell that both patches touch, and in no other. That is
        // the cell which, along each axis, is the first one of at least one of the two patches.
        if ((here.begins[i] | here.begins[j]) == kAllAxes) mark_between(i, j, here);
      }
    }
  }
}

// Tests each triangle of part a with each of part b; if that is the same part, each pair once. A
// pair without a moved vertex is not tested: if its triangles cross, they did so before the moves,
// and there is nothing to take back.
template <class Level>
void BadMoves<Level>::mark_pair(const GatheredPart& a, const GatheredPart& b) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(Part::kTriangles); ++i) {
    std::uint32_t near = b.triangles.overlapping(a.triangles, i);
    if ((a.moved >> i & 1) == 0) near &= b.moved;
    if (&a == &b) near &= ~std::uint32_t{0} << (i + 1);
    if (near != 0) near &= b.triangles.may_cross(a.triangles, i);
    for (; near != 0; near &= near - 1) {
      mark_if_crossing(a, i, b, static_cast<std::size_t>(std::countr_zero(near)));
    }
  }
}

// Tests triangle i of part a with triangle j of part b and marks their vertices if they cross.
// triangles_cross() asks for the atoms because it leaves triangles of one atom around a common
// vertex to mark_turned().
template <class Level>
void BadMoves<Level>::mark_if_crossing(const GatheredPart& a, std::size_t i, const GatheredPart& b,
                                       std::size_t j) {
  struct ChildCorners {
    std::array<std::uint32_t, 3> vertex;
    std::array<Vec3d, 3> position;
    std::array<SphereId, 3> atom;
  };
  const auto corners = [&](const GatheredPart& part, std::size_t child) {
    ChildCorners c;
    const auto corner = Part::triangle(static_cast<int>(child));
    for (std::size_t k = 0; k < 3; ++k) {
      c.vertex[k] = part.vertex[static_cast<std::size_t>(corner[k])];
      c.position[k] = part.triangles.corner(child, k);
      c.atom[k] = level_.mesh.vertex_spheres.atoms[c.vertex[k]];
    }
    return c;
  };
  const ChildCorners s = corners(a, i), t = corners(b, j);
  if (!triangles_cross(s.position.data(), s.vertex.data(), s.atom.data(), t.position.data(),
                       t.vertex.data(), t.atom.data())) {
    return;
  }
  mark_corners(parts(), a.part, static_cast<int>(i));
  mark_corners(parts(), b.part, static_cast<int>(j));
}

template class BadMoves<Given>;
template class BadMoves<Midpoints>;
template class BadMoves<DividedMidpoints>;

}  // namespace vdwmesh
