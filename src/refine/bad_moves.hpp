// Moves that spoil the mesh, and the passes that take them back.
#pragma once

#include <cstdint>
#include <optional>

#include "core/buffer.hpp"
#include "extract/sphere_set.hpp"
#include "refine/blocks.hpp"
#include "refine/level_view.hpp"
#include "refine/triangle_grid.hpp"

namespace vdwmesh {

// A move is bad when it turns a triangle of one atom against that atom's outward normal, or when it
// is of a triangle that crosses another.
template <class Level>
class BadMoves {
 public:
  BadMoves(const SphereSet& spheres, const Level& level, Buffer<Fate>& fates)
      : spheres_(spheres.spheres().data()), level_(level), fates_(fates), grid_(level) {}

  // Marks the vertices whose moves are bad; says whether there are any. The first pass looks for
  // turns everywhere and for crossings where several atoms meet: around one atom the mesh lies in
  // one sheet. Later ones look at the triangles of the vertices that the last one took back.
  bool mark();

 private:
  using Vertices = std::array<std::uint32_t, Level::kVertices>;
  bool is_judged(const Vertices& v);
  bool is_crease(const Vertices& v) const;
  bool mark_turned(const Vertices& v);
  bool mark_crossed(std::size_t patch);
  bool mark_crossed(std::uint32_t triangle, std::uint32_t other);

  const Sphere* spheres_;
  const Level& level_;
  Buffer<Fate>& fates_;
  TriangleGrid grid_;
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
                                  const Restore& restore) {
  BadMoves<Level> bad(spheres, level, fates);
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
    total += reduce_all(level.items(), std::uint64_t{0}, settle,
                        [](std::uint64_t a, std::uint64_t b) { return a + b; });
  }
  return total;
}

}  // namespace vdwmesh
