// Moves that spoil the mesh, and the passes that take them back.
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

// A move is bad when it turns a triangle of one atom against that atom's outward normal, or when it
// is of a triangle that crosses another, unless the options allow that.
template <class Level>
class BadMoves {
 public:
  BadMoves(const SphereSet& spheres, const Level& level, Buffer<Fate>& fates,
           const RefineOptions& options)
      : spheres_(spheres.spheres().data()),
        level_(level),
        fates_(fates),
        monitor_(options.monitor) {
    if (options.crossings == Crossings::allow) return;
    grid_.emplace(level);
    dirty_.assign(grid_->cell_count(), 1);
  }

  // Marks the vertices whose moves are bad; says whether there are any. The first pass looks at
  // every triangle, later ones at those whose vertices the last one took back and what is near.
  bool mark();

 private:
  using Vertices = std::array<std::uint32_t, Level::kVertices>;
  struct Corners;
  void find_dirty_cells();
  bool has_taken_back(const Vertices& v);
  bool mark_turned(const Vertices& v);
  bool mark_crossed(std::size_t cell);
  Corners corners(std::uint32_t triangle);
  void mark_vertices(const std::array<std::uint32_t, 3>& vertices);

  const Sphere* spheres_;
  const Level& level_;
  Buffer<Fate>& fates_;
  Monitor* monitor_;
  std::optional<TriangleGrid> grid_;  // none where crossings are allowed; then no cells either
  Buffer<std::uint8_t> dirty_;        // of each cell: whether a triangle of it is to be looked at
  int pass_ = 0;
};

extern template class BadMoves<Given>;
extern template class BadMoves<Midpoints>;

// Simultaneous passes: all triangles are judged before any vertex goes back, so their order does
// not matter. Each pass takes back at least one move, and triangles without moves are not judged:
// it ends. Calls restore(item), from many threads, for each item whose vertex goes back; returns
// how many went.
template <class Level, class Restore>
std::uint64_t take_back_bad_moves(const SphereSet& spheres, const Level& level, Buffer<Fate>& fates,
                                  const RefineOptions& options, const Restore& restore) {
  const auto add = [](std::uint64_t a, std::uint64_t b) { return a + b; };
  const auto count_moved = [&](std::size_t i, std::uint64_t& n) { n += fates[i] == Fate::moved; };
  if (reduce_all(fates.size(), std::uint64_t{0}, count_moved, add) == 0) return 0;
  BadMoves<Level> bad(spheres, level, fates, options);
  std::uint64_t total = 0;
  while (bad.mark()) {
    const auto settle = [&](std::size_t item, std::uint64_t& count) {
      const std::optional<std::size_t> i = level.handled_by_item(item);
      if (!i) return;
      if (fates[*i] == Fate::taken_back) fates[*i] = Fate::stayed;
      if (fates[*i] != Fate::taking_back) return;
      fates[*i] = Fate::taken_back;
      restore(item);
      ++count;
    };
    total += reduce_all(level.items(), std::uint64_t{0}, settle, add);
  }
  return total;
}

}  // namespace vdwmesh
