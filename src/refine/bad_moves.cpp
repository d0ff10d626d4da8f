#include "refine/bad_moves.hpp"

#include <algorithm>
#include <array>

#include "refine/crossing_formulas.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

struct Corners {
  std::array<std::uint32_t, 3> vertex;
  std::array<Vec3d, 3> position;
};

Corners corners(const IndexedMesh& mesh, const std::array<std::uint32_t, 3>& v) {
  return {v, {mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]}};
}

}  // namespace

template <class Level>
bool BadMoves<Level>::mark() {
  const auto judge = [&](std::size_t patch, std::uint64_t& bad) {
    const Vertices v = level_.vertices(patch);
    if (pass_ > 0 && !is_judged(v)) return;
    bad += mark_turned(v);
    if (pass_ > 0 || is_crease(v)) bad += mark_crossed(patch);
  };
  const std::uint64_t bad = reduce_all(level_.patches(), std::uint64_t{0}, judge,
                                       [](std::uint64_t a, std::uint64_t b) { return a + b; });
  ++pass_;
  return bad > 0;
}

template <class Level>
bool BadMoves<Level>::is_judged(const Vertices& v) {
  return std::any_of(v.begin(), v.end(), [&](std::uint32_t i) {
    return fate_of(level_, fates_, i) == Fate::taken_back;
  });
}

template <class Level>
bool BadMoves<Level>::is_crease(const Vertices& v) const {
  const SphereId atom = level_.mesh.vertex_spheres[v[0]][0];
  return std::any_of(v.begin(), v.end(),
                     [&](std::uint32_t i) { return level_.mesh.vertex_spheres[i][0] != atom; });
}

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
      atom[k] = level_.mesh.vertex_spheres[v[i]][0];
    }
    if (facing(spheres_, now.data(), atom.data()) != Facing::against_one_atom) continue;
    if (facing(spheres_, before.data(), atom.data()) != Facing::outward) continue;
    for (const std::uint32_t i : vertex) vdwmesh::mark(level_, fates_, i);
    any = true;
  }
  return any;
}

template <class Level>
bool BadMoves<Level>::mark_crossed(std::size_t patch) {
  bool any = false;
  for (std::size_t child = 0; child < Level::kTriangles; ++child) {
    const auto t = static_cast<std::uint32_t>(Level::kTriangles * patch + child);
    grid_.visit_near(t, [&](std::uint32_t other) { any = mark_crossed(t, other) || any; });
  }
  return any;
}

template <class Level>
bool BadMoves<Level>::mark_crossed(std::uint32_t triangle, std::uint32_t other) {
  if (triangle == other) return false;
  const Corners a = corners(level_.mesh, level_.mesh.triangles[triangle]);
  const Corners b = corners(level_.mesh, level_.mesh.triangles[other]);
  if (!boxes_overlap(a.position.data(), b.position.data())) return false;
  const auto is_moved = [&](std::uint32_t v) { return is_away(fate_of(level_, fates_, v)); };
  if (!std::any_of(a.vertex.begin(), a.vertex.end(), is_moved) &&
      !std::any_of(b.vertex.begin(), b.vertex.end(), is_moved)) {
    return false;
  }
  if (!triangles_cross(a.position.data(), a.vertex.data(), b.position.data(), b.vertex.data())) {
    return false;
  }
  for (const std::uint32_t v : a.vertex) vdwmesh::mark(level_, fates_, v);
  for (const std::uint32_t v : b.vertex) vdwmesh::mark(level_, fates_, v);
  return true;
}

template class BadMoves<Given>;
template class BadMoves<Midpoints>;

}  // namespace vdwmesh
