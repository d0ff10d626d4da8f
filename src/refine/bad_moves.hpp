// Projection may fold a triangle over or push it through another one. This header finds the moves
// that did so, and puts their vertices back in passes until no bad move is left.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/blocks.hpp"
#include "core/buffer.hpp"
#include "refine/level_view.hpp"
#include "refine/refiner.hpp"
#include "refine/triangle_grid.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh {

// Finds the bad moves of one level. A move of a vertex is bad in two cases:
//   1. The vertex belongs to a triangle whose corners all have the same atom. The triangle faces
//      against the outward normal of that atom, and did not do so before the moves.
//   2. The vertex belongs to a triangle that crosses another one (refine/crossing_formulas.hpp).
//      The second case is left out if the options allow crossings.
// `Level` is Given or Midpoints (refine/level_view.hpp).
template <class Level>
class BadMoves {
 public:
  // All arguments must outlive the object. `move_states` has the state of each handled vertex.
  BadMoves(const SphereSet& spheres, const Level& level, Buffer<MoveState>& move_states,
           const RefineOptions& options)
      : spheres_(spheres.spheres().data()),
        level_(level),
        move_states_(move_states),
        monitor_(options.monitor) {
    if (options.crossings == Crossings::allow) return;
    grid_.emplace(level);
    dirty_.assign(grid_->cell_count(), 1);
  }

  // One pass: changes the state of every vertex with a bad move from MoveState::moved to
  // MoveState::to_undo, and returns whether there is any. The first pass checks all triangles. A
  // later pass checks only the triangles with a vertex that was put back after the previous pass,
  // and the triangles near them: nothing else has changed.
  bool mark();

 private:
  using Vertices = std::array<std::uint32_t, Level::kVertices>;  // of a patch
  struct Corners;                                                // of a triangle
  void find_dirty_cells();
  bool has_taken_back(const Vertices& v);
  bool mark_turned(const Vertices& v);
  bool mark_crossed(std::size_t cell);
  Corners corners(std::uint32_t triangle);
  void mark_vertices(const std::array<std::uint32_t, 3>& vertices);

  const Sphere* spheres_;
  const Level& level_;
  Buffer<MoveState>& move_states_;
  Monitor* monitor_;
  std::optional<TriangleGrid> grid_;  // empty if crossings are allowed
  Buffer<std::uint8_t> dirty_;        // by cell of grid_: 1 if the next pass checks its triangles
  int pass_ = 0;                      // passes done
};

extern template class BadMoves<Given>;
extern template class BadMoves<Midpoints>;

// Takes back all bad moves of a level and returns how many vertices it put back. Calls
// restore(item) for the item of each such vertex (see handled_by_item()), from many threads at
// once.
//
// Each pass checks all triangles before any vertex is put back, so neither the order of the
// triangles nor the number of threads matters. The loop ends: a bad triangle, and one triangle at
// least of a bad pair, has a moved vertex. A pass that finds one therefore puts a vertex back, and
// no vertex moves a second time.
template <class Level, class Restore>
std::uint64_t take_back_bad_moves(const SphereSet& spheres, const Level& level,
                                  Buffer<MoveState>& move_states, const RefineOptions& options,
                                  const Restore& restore) {
  const auto count_moved = [&](std::size_t i, std::uint64_t& n) {
    n += move_states[i] == MoveState::moved;
  };
  if (sum_all(move_states.size(), count_moved) == 0) return 0;
  BadMoves<Level> bad(spheres, level, move_states, options);
  std::uint64_t total = 0;
  while (bad.mark()) {
    const auto settle = [&](std::size_t item, std::uint64_t& count) {
      const std::optional<std::size_t> i = level.handled_by_item(item);
      if (!i) return;
      // Vertices that were put back before this pass: it has checked the triangles around them.
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
