// Projection moves vertices to the surface. A move may fold a triangle over or push it through
// another one. This header finds such bad moves and takes them back, that is, it puts the vertices
// back to where they started. It does so in passes, until no bad move is left.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/blocks.hpp"
#include "core/buffer.hpp"
#include "refine/level_view.hpp"
#include "refine/patch_fans.hpp"
#include "refine/patch_grid.hpp"
#include "refine/refiner.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

class PatchOutline;

// Finds the bad moves of one refinement level. The move of a vertex is bad in two cases:
//   1. The vertex belongs to a turned triangle: its corners all have the same atom, and it faces
//      against the outward normal of that atom, but faced outward before the moves.
//   2. The vertex belongs to a pair of triangles that cross (refine/crossing_formulas.hpp), and at
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
        monitor_(options.monitor) {
    if (options.crossings == Crossings::allow) return;
    grid_.emplace(level);
    dirty_.assign(grid_->cell_count(), 1);
    // If few vertices have moved, few cells have a pair to test, and are worth being found.
    if (moved < move_states.size() / 8) {
      find_dirty_cells<is_away>();
      return;
    }
    if constexpr (kHasFans) fans_ = patch_fans(level);
  }

  // One pass: changes the state of every vertex with a bad move from MoveState::moved to
  // MoveState::to_undo, and returns whether there is such a vertex. The first call checks all
  // triangles. A later call checks only the triangles with a vertex in MoveState::just_undone, and
  // those that share a cell with them, because all others are as the previous pass left them.
  bool mark();

 private:
  using Part = typename Level::Part;
  static constexpr std::size_t kParts = Level::kParts;
  static constexpr bool kHasFans = Level::kVertices > 3;         // a single triangle has none
  using Vertices = std::array<std::uint32_t, Level::kVertices>;  // the mesh vertices of a patch
  struct GatheredPart;
  struct PartBoxes;
  struct CellPatches;
  template <bool (*is_wanted)(MoveState)>
  void find_dirty_cells();
  template <bool (*is_wanted)(MoveState)>
  bool has_vertex(const Vertices& v);
  bool mark_turned(const Vertices& v);
  bool mark_crossed(std::size_t cell);
  bool must_test(const Vertices& v);
  double take_boxes(std::size_t cell, CellPatches& here);
  const Part& parts() const { return level_; }
  const PartBoxes& boxes_of_parts(std::size_t i, CellPatches& here) const;
  const PatchOutline& outline(std::size_t part, CellPatches& here) const;
  const GatheredPart& gathered(std::size_t part, CellPatches& here);
  bool may_cross_itself(std::size_t part, CellPatches& here) const;
  bool mark_within(std::size_t i, CellPatches& here);
  bool mark_between(std::size_t i, std::size_t j, CellPatches& here);
  bool mark_parts(std::size_t a, std::size_t b, CellPatches& here);
  bool mark_pair(const GatheredPart& a, const GatheredPart& b);
  bool mark_if_crossing(const GatheredPart& a, std::size_t i, const GatheredPart& b, std::size_t j);
  void gather(std::size_t part, GatheredPart& gathered);
  void mark_vertices(const std::array<std::uint32_t, 3>& vertices);

  const Sphere* spheres_;
  const Level& level_;
  Buffer<MoveState>& move_states_;
  Monitor* monitor_;
  std::optional<PatchGrid> grid_;  // empty if crossings are allowed
  Buffer<std::uint8_t> dirty_;     // by cell of grid_: 1 if this pass tests its pairs, else 0
  StarFans fans_;                  // of the parent's vertices; empty if few vertices moved
  int pass_ = 0;                   // passes done
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
  std::uint64_t total = 0;
  while (bad.mark()) {
    const auto settle = [&](std::size_t item, std::uint64_t& count) {
      const std::optional<std::size_t> i = level.handled_by_item(item);
      if (!i) return;
      // The vertex was put back before the pass that has just ended. That pass has checked the
      // triangles around it, so nothing is left to check.
      if (move_states[*i] == MoveState::just_undone) move_states[*i] = MoveState::stayed;
      if (move_states[*i] != MoveState::to_undo) return;
      move_states[*i] = MoveState::just_undone;
      restore(item);
      ++count;
    };
    total += sum_all(level.items(), settle);
  }
  return total;
}

}  // namespace vdwmesh
