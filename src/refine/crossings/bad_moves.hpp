// Projection moves vertices to the surface. A move may fold a triangle over or push it through
// another one. This header finds such bad moves and takes them back, that is, it puts the vertices
// back to where they started. It does so in passes, until no bad move is left.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/blocks.hpp"
#include "core/buffer.hpp"
#include "refine/chosen_indices.hpp"
#include "refine/crossings/patch_fans.hpp"
#include "refine/crossings/patch_grid.hpp"
#include "refine/level_view.hpp"
#include "refine/refiner.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class PatchOutline;

// Finds the bad moves of one refinement level. The move of a vertex is bad in two cases:
//   1. The vertex belongs to a turned triangle: its corners all have the same atom, and it faces
//      against the outward normal of that atom, but faced outward before the moves.
//   2. The vertex belongs to a pair of triangles that cross
//   (refine/crossings/crossing_formulas.hpp), and at
//      least one vertex of the pair has moved. This case is left out if the options allow
//      crossings.
// `Level` is one of the views Given, Midpoints and DividedMidpoints, which also define a patch, its
// parts, a handled vertex and the states of moves (refine/level_view.hpp).
template <class Level>
class BadMoves {
 public:
  // All arguments must outlive the object. `move_states` has the state of each handled vertex,
  // counted from level.first_handled(); `moved` of them have moved.
  BadMoves(const SphereSet& spheres, const Level& level, Buffer<MoveState>& move_states,
           std::uint64_t moved, const RefineOptions& options)
      : spheres_(spheres.spheres().data()),
        level_(level),
        move_states_(move_states),
        monitor_(options.monitor),
        wanted_(level.patches()) {
    if (options.crossings == Crossings::allow) return;
    grid_.emplace(level);
    dirty_.emplace(grid_->cell_count());
    // If few vertices have moved, few cells have a pair to test, and are worth being found. An
    // eighth is a guess.
    tests_all_ = moved >= move_states.size() / 8;
    if constexpr (kHasFans) {
      if (tests_all_) fans_ = PatchFans(level);
    }
  }

  // One pass: changes the state of every vertex with a bad move from MoveState::moved to
  // MoveState::to_undo, and returns the items of these vertices in the level's loop over the
  // handled ones; the list is valid until the next call. The first call checks all triangles.
  // Precondition of a later one: exactly the vertices that the call before returned were put back,
  // and have the state MoveState::just_undone. It checks only the triangles of patches with such a
  // vertex, and pairs with one of these: all others are as that call left them.
  const std::vector<std::size_t>& mark();

 private:
  using Part = typename Level::Part;
  static constexpr std::size_t kParts = Level::kParts;
  static constexpr bool kHasFans = Level::kVertices > 3;         // a single triangle has none
  using Vertices = std::array<std::uint32_t, Level::kVertices>;  // the mesh vertices of a patch
  struct GatheredPart;
  struct CellPatches;
  template <bool (*is_wanted)(MoveState)>
  void want_those_with();
  void want_changed();
  void find_dirty_cells();
  void mark_all_turned();
  void mark_all_crossed();
  bool tests_all_pairs() const { return pass_ == 0 && tests_all_; }
  void mark_turned(std::size_t patch);
  void mark_if_turned(std::size_t patch, const Vertices& v, int child);
  void mark_crossed(std::size_t cell);
  double take_boxes(std::size_t cell, CellPatches& here);
  const Part& parts() const { return level_; }
  const PatchOutline& outline(std::size_t part, CellPatches& here) const;
  const GatheredPart& gathered(std::size_t part, CellPatches& here);
  bool may_cross_itself(std::size_t part, CellPatches& here) const;
  void mark_within(std::size_t i, CellPatches& here);
  void mark_between(std::size_t i, std::size_t j, CellPatches& here);
  void mark_parts(std::size_t a, std::size_t b, CellPatches& here);
  void mark_pair(const GatheredPart& a, const GatheredPart& b);
  void mark_if_crossing(const GatheredPart& a, std::size_t i, const GatheredPart& b, std::size_t j);
  void gather(std::size_t part, GatheredPart& gathered);
  template <class View>
  void mark_corners(const View& view, std::size_t patch, int triangle);

  const Sphere* spheres_;
  const Level& level_;
  Buffer<MoveState>& move_states_;
  Monitor* monitor_;
  std::optional<PatchGrid> grid_;       // empty if crossings are allowed
  ChosenIndices wanted_;                // patches of which this pass tests all pairs
  std::optional<ChosenIndices> dirty_;  // cells of grid_ with such a patch
  bool tests_all_ = false;              // whether the first pass tests all pairs
  PatchFans fans_;                      // of a level with midpoints if it does, else empty
  SharedList marked_;                   // items of vertices that the last pass has marked
  int pass_ = 0;                        // passes done
};

extern template class BadMoves<Given>;
extern template class BadMoves<Midpoints>;
extern template class BadMoves<DividedMidpoints>;

// Takes back all bad moves of a level and returns how many vertices it put back. For each of them
// it calls restore(item), which must put the vertex back. `item` is its index in the level's loop
// over the handled vertices (level.handled_by_item()). The calls come from many threads at once.
//
// Each pass finishes its search before any vertex is put back, so neither the order of the
// triangles nor the number of threads matters. The loop ends: a turned triangle has a moved vertex,
// and so has a pair that is tested for crossing. A pass that finds something therefore puts at
// least one vertex back, and a vertex that was put back never moves again.
template <class Level, class Restore>
std::uint64_t take_back_bad_moves(const SphereSet& spheres, const Level& level,
                                  Buffer<MoveState>& move_states, const RefineOptions& options,
                                  const Restore& restore) {
  const auto count_moved = [&](std::size_t i, std::uint64_t& n) {
    n += move_states[i] == MoveState::moved;
  };
  const std::uint64_t moved = sum_all(move_states.size(), count_moved);
  if (moved == 0) return 0;
  BadMoves<Level> bad(spheres, level, move_states, moved, options);
  std::vector<std::size_t> previous;
  std::uint64_t total = 0;
  for (;;) {
    const std::vector<std::size_t>& marked = bad.mark();
    if (marked.empty()) return total;
    // The pass that has just ended has checked the triangles around the vertices that were put back
    // before it, so nothing is left to check.
    for_all(previous.size(), [&](std::size_t i) {
      move_states[*level.handled_by_item(previous[i])] = MoveState::stayed;
    });
    for_all(marked.size(), [&](std::size_t i) {
      move_states[*level.handled_by_item(marked[i])] = MoveState::just_undone;
      restore(marked[i]);
    });
    total += marked.size();
    previous = marked;
  }
}

}  // namespace vdwmesh
