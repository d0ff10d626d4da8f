// CrossingGuard: a hash table of the zones' cells. Triangles that have left a cell stay in its
// list: they are tested where they are now, which does no harm.
#include "remesh/crossing_guard.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/crossings/facet_pair_exact.hpp"
#include "spheres/box.hpp"

namespace vdwmesh::remesh {
namespace {

Facet facet_of(const NewTriangle& t) {
  return make_facet(t.vertex, t.corner[0], t.corner[1], t.corner[2]);
}
Box box_of(const NewTriangle& t) {
  Box box = empty_box();
  for (const Vec3d& p : t.corner) include(box, p);
  return box;
}
NewTriangle placed(const DynamicMesh& mesh, const std::vector<Vec3d>& positions, std::uint32_t t) {
  const Triangle v = mesh.triangle(t);
  return {v, {positions[v[0]], positions[v[1]], positions[v[2]]}};
}

// Flat triangles are left out, as the search of the finished mesh does.
bool cross_each_other(const NewTriangle& a, const NewTriangle& b) {
  if (!meet(box_of(a), box_of(b))) return false;
  const Facet f = facet_of(a), g = facet_of(b);
  if ((!has_area(f) && is_flat_exactly(f)) || (!has_area(g) && is_flat_exactly(g))) return false;
  return do_intersect(f, g);
}

}  // namespace

std::size_t CrossingGuard::KeyHash::operator()(const CellKey& key) const {
  std::uint64_t hash = 0;
  for (const std::int32_t k : key) {
    hash = (hash ^ static_cast<std::uint32_t>(k)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

template <class Visit>
void CrossingGuard::visit_keys(const Box& box, const Visit& visit) const {
  std::int32_t from[3], to[3];
  for (int axis = 0; axis < 3; ++axis) {
    from[axis] = static_cast<std::int32_t>(std::floor(box.lower[axis] / cell_));
    to[axis] = static_cast<std::int32_t>(std::floor(box.upper[axis] / cell_));
  }
  for (std::int32_t x = from[0]; x <= to[0]; ++x) {
    for (std::int32_t y = from[1]; y <= to[1]; ++y) {
      for (std::int32_t z = from[2]; z <= to[2]; ++z) visit(CellKey{x, y, z});
    }
  }
}

CrossingGuard::CrossingGuard(const DynamicMesh& mesh, const std::vector<Vec3d>& positions,
                             std::span<const Box> zones, double cell)
    : mesh_(mesh), positions_(positions), cell_(cell) {
  for (const Box& zone : zones) {
    visit_keys(zone, [&](const CellKey& key) { cells_.try_emplace(key); });
  }
  if (cells_.empty()) return;
  for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.is_triangle(t)) note(t);
  }
}

void CrossingGuard::note(std::uint32_t triangle) {
  if (cells_.empty()) return;
  visit_keys(box_of(placed(mesh_, positions_, triangle)), [&](const CellKey& key) {
    const auto cell = cells_.find(key);
    if (cell == cells_.end() || std::ranges::count(cell->second, triangle) > 0) return;
    cell->second.push_back(triangle);
  });
}

bool CrossingGuard::allows(std::span<const NewTriangle> made,
                           std::span<const std::uint32_t> removed) const {
  if (cells_.empty()) return true;
  bool found = false;
  for (std::size_t i = 0; i < made.size() && !found; ++i) {
    bool in_zone = false;
    visit_keys(box_of(made[i]), [&](const CellKey& key) {
      const auto cell = cells_.find(key);
      if (found || cell == cells_.end()) return;
      in_zone = true;
      found = std::ranges::any_of(cell->second, [&](std::uint32_t t) {
        return mesh_.is_triangle(t) && std::ranges::count(removed, t) == 0 &&
               cross_each_other(made[i], placed(mesh_, positions_, t));
      });
    });
    for (std::size_t j = 0; in_zone && !found && j < i; ++j) {
      found = cross_each_other(made[i], made[j]);
    }
  }
  return !found;
}

}  // namespace vdwmesh::remesh
