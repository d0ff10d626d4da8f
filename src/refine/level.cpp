#include "refine/level.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>

#include "refine/blocks.hpp"
#include "refine/half_edges.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

ProjectionStats join(const ProjectionStats& a, const ProjectionStats& b) {
  return {a.projected + b.projected,
          a.unconverged + b.unconverged,
          a.out_of_reach + b.out_of_reach,
          a.undone + b.undone,
          a.turned + b.turned,
          std::max(a.iterations_max, b.iterations_max),
          std::max(a.residual_max, b.residual_max)};
}

std::uint64_t add(std::uint64_t a, std::uint64_t b) { return a + b; }

template <class Body>
ProjectionStats tally(std::size_t count, const Body& body) {
  return reduce_all(count, ProjectionStats{}, body, join);
}

void count_outcome(const ProjectedPoint& p, ProjectionStats& stats) {
  stats.iterations_max = std::max(stats.iterations_max, p.steps);
  switch (p.outcome) {
    case ProjectionOutcome::converged:
      ++stats.projected;
      stats.residual_max = std::max(stats.residual_max, p.residual);
      break;
    case ProjectionOutcome::unconverged:
      ++stats.unconverged;
      break;
    case ProjectionOutcome::out_of_reach:
      ++stats.out_of_reach;
      break;
  }
}

VertexSpheres label_of(const ProjectedPoint& p) {
  return {p.spheres[0], p.spheres[1], p.spheres[2]};
}

// Triangles that are judged together: where their vertices were and are, their atoms, and what
// became of them.
template <int kVertices>
struct Patch {
  std::array<std::uint32_t, kVertices> vertex;
  std::array<Vec3d, kVertices> before, now;
  std::array<SphereId, kVertices> atom;
  std::array<Fate, kVertices> fate;
};

struct Corners {
  std::array<Vec3d, 3> before, now;
  std::array<SphereId, 3> atom;
};

template <int kVertices>
Corners corners(const Patch<kVertices>& patch, const std::array<int, 3>& at) {
  Corners c;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(at[k]);
    c.before[k] = patch.before[i];
    c.now[k] = patch.now[i];
    c.atom[k] = patch.atom[i];
  }
  return c;
}

bool turned_by_move(const Sphere* spheres, const Corners& c) {
  return facing(spheres, c.now.data(), c.atom.data()) == Facing::against_one_atom &&
         facing(spheres, c.before.data(), c.atom.data()) == Facing::outward;
}

// A level as the passes below see it: patches of vertices with the triangles among them.
//   Given: one triangle of three vertices. Midpoints: a parent triangle, three old vertices and
//   three midpoints, and its four children.
struct Given {
  static constexpr int kVertices = 3, kTriangles = 1;
  const IndexedMesh& given;
  const IndexedMesh& mesh;
  std::size_t patches() const { return given.triangle_count(); }
  std::array<int, 3> triangle(int) const { return {0, 1, 2}; }
  std::array<std::uint32_t, 3> vertices(std::size_t t) const { return given.triangles[t]; }
  Vec3d before(const std::array<std::uint32_t, 3>& v, std::size_t i) const {
    return given.positions[v[i]];
  }
  // The vertices that the level handles, their number among those, and the loop over them.
  bool is_handled(std::uint32_t) const { return true; }
  std::size_t handled(std::uint32_t v) const { return v; }
  std::size_t items() const { return given.vertex_count(); }
  std::optional<std::size_t> handled_by_item(std::size_t item) const { return item; }
};

struct Midpoints {
  static constexpr int kVertices = 6, kTriangles = 4;
  const IndexedMesh& parent;
  const Buffer<std::uint32_t>& edge;
  const IndexedMesh& mesh;
  std::size_t patches() const { return parent.triangle_count(); }
  std::array<int, 3> triangle(int child) const {
    return {child_corner(child, 0), child_corner(child, 1), child_corner(child, 2)};
  }
  std::uint32_t midpoint_of(std::size_t h) const {
    return static_cast<std::uint32_t>(parent.vertex_count() + edge[h]);
  }
  std::array<std::uint32_t, 6> vertices(std::size_t t) const {
    const Triangle& v = parent.triangles[t];
    return {v[0], v[1], v[2], midpoint_of(3 * t), midpoint_of(3 * t + 1), midpoint_of(3 * t + 2)};
  }
  Vec3d before(const std::array<std::uint32_t, 6>& v, std::size_t i) const {
    if (i < 3) return parent.positions[v[i]];
    return midpoint(parent.positions[v[i - 3]], parent.positions[v[i == 5 ? 0 : i - 2]]);
  }
  bool is_handled(std::uint32_t v) const { return v >= parent.vertex_count(); }
  std::size_t handled(std::uint32_t v) const { return v - parent.vertex_count(); }
  // An edge is the item of its first half-edge.
  std::size_t items() const { return parent.opposite.size(); }
  std::optional<std::size_t> handled_by_item(std::size_t h) const {
    if (parent.opposite[h] < h) return std::nullopt;
    return edge[h];
  }
  std::uint32_t start_of(std::size_t h) const { return parent.triangles[h / 3][h % 3]; }
  std::uint32_t end_of(std::size_t h) const { return parent.triangles[h / 3][(h + 1) % 3]; }
  Vec3d start(std::size_t h) const {
    return midpoint(parent.positions[start_of(h)], parent.positions[end_of(h)]);
  }
  double reach(std::size_t h) const {
    return midpoint_reach(parent.positions[start_of(h)], parent.positions[end_of(h)]);
  }
  // The atom of a midpoint that is not on the surface.
  VertexSpheres unprojected_label(const Sphere* spheres, std::size_t h) const {
    return on_sphere(nearer_sphere(spheres, parent.vertex_spheres[start_of(h)][0],
                                   parent.vertex_spheres[end_of(h)][0], start(h)));
  }
};

template <class Level>
Fate fate_of(const Level& level, Buffer<Fate>& fates, std::uint32_t v) {
  if (!level.is_handled(v)) return Fate::stayed;
  // Other threads may be marking the vertex at this moment.
  return std::atomic_ref(fates[level.handled(v)]).load(std::memory_order_relaxed);
}

template <class Level>
Patch<Level::kVertices> read_patch(const Level& level, Buffer<Fate>& fates, std::size_t t) {
  Patch<Level::kVertices> patch;
  patch.vertex = level.vertices(t);
  for (std::size_t i = 0; i < patch.vertex.size(); ++i) {
    const std::uint32_t v = patch.vertex[i];
    patch.before[i] = level.before(patch.vertex, i);
    patch.now[i] = level.mesh.positions[v];
    patch.atom[i] = level.mesh.vertex_spheres[v][0];
    patch.fate[i] = fate_of(level, fates, v);
  }
  return patch;
}

// Marks the moved vertices of each triangle that its move turned; says how many triangles. From the
// second pass on only a patch with a vertex that the last one took back can have changed.
template <class Level>
std::uint64_t mark_turned(const SphereSet& spheres, const Level& level, Buffer<Fate>& fates,
                          int pass) {
  const Sphere* balls = spheres.spheres().data();
  const auto mark = [&](std::size_t t, std::uint64_t& count) {
    const auto v = level.vertices(t);
    const auto has = [&](Fate fate) {
      return std::any_of(v.begin(), v.end(),
                         [&](std::uint32_t i) { return fate_of(level, fates, i) == fate; });
    };
    if (pass > 0 && !has(Fate::taken_back)) return;
    const auto patch = read_patch(level, fates, t);
    for (int child = 0; child < Level::kTriangles; ++child) {
      const std::array<int, 3> at = level.triangle(child);
      if (!turned_by_move(balls, corners(patch, at))) continue;
      ++count;
      for (const int k : at) {
        const auto i = static_cast<std::size_t>(k);
        if (patch.fate[i] != Fate::moved && patch.fate[i] != Fate::taking_back) continue;
        std::atomic_ref(fates[level.handled(patch.vertex[i])])
            .store(Fate::taking_back, std::memory_order_relaxed);
      }
    }
  };
  return reduce_all(level.patches(), std::uint64_t{0}, mark, add);
}

// Simultaneous passes: all triangles are judged before any vertex goes back, so their order does
// not matter. Each pass takes back at least one move, and a triangle without moves is not turned by
// one: it ends. `take_back(item)` restores the vertex of an item.
template <class Level, class TakeBack>
void take_back_turns(const SphereSet& spheres, const Level& level, Buffer<Fate>& fates,
                     ProjectionStats& stats, const TakeBack& take_back) {
  for (int pass = 0; mark_turned(spheres, level, fates, pass) > 0; ++pass) {
    const auto restore = [&](std::size_t item, std::uint64_t& n) {
      const std::optional<std::size_t> i = level.handled_by_item(item);
      if (!i || fates[*i] != Fate::taking_back) return;
      fates[*i] = Fate::taken_back;
      take_back(item);
      ++n;
    };
    const std::uint64_t count = reduce_all(level.items(), std::uint64_t{0}, restore, add);
    stats.undone += count;
    stats.projected -= count;
  }
}

std::uint64_t count_turned(const SphereSet& spheres, const IndexedMesh& mesh) {
  const auto count = [&](std::size_t t, std::uint64_t& n) {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k) {
      c.now[k] = mesh.positions[mesh.triangles[t][k]];
      c.atom[k] = mesh.vertex_spheres[mesh.triangles[t][k]][0];
    }
    n += facing(spheres.spheres().data(), c.now.data(), c.atom.data()) != Facing::outward;
  };
  return reduce_all(mesh.triangle_count(), std::uint64_t{0}, count, add);
}

// Square of the longest edge at each vertex. Of squares, which are not negative, the bit patterns
// order as the numbers do, so a maximum of integers serves.
Buffer<std::uint64_t> longest_edge_squares(const IndexedMesh& mesh) {
  Buffer<std::uint64_t> square(mesh.vertex_count());
  for_all(square.size(), [&](std::size_t v) { square[v] = 0; });
  const auto raise = [&](std::uint32_t v, std::uint64_t bits) {
    std::atomic_ref slot(square[v]);
    std::uint64_t old = slot.load(std::memory_order_relaxed);
    while (old < bits && !slot.compare_exchange_weak(old, bits, std::memory_order_relaxed)) {
    }
  };
  for_all(mesh.triangle_count(), [&](std::size_t t) {
    const Triangle& v = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      const double s = squared_distance(mesh.positions[a], mesh.positions[b]);
      raise(a, std::bit_cast<std::uint64_t>(s));
      raise(b, std::bit_cast<std::uint64_t>(s));
    }
  });
  return square;
}

void write_children(const Midpoints& level, IndexedMesh& mesh) {
  const IndexedMesh& parent = level.parent;
  mesh.triangles.resize(4 * parent.triangle_count());
  if (12 * parent.triangle_count() <= kMaxHalfEdges) {
    mesh.opposite.resize(12 * parent.triangle_count());
  }
  for_all(parent.triangle_count(), [&](std::size_t t) {
    const auto v = level.vertices(t);
    for (int child = 0; child < 4; ++child) {
      for (int k = 0; k < 3; ++k) {
        mesh.triangles[4 * t + static_cast<std::size_t>(child)][static_cast<std::size_t>(k)] =
            v[static_cast<std::size_t>(child_corner(child, k))];
      }
    }
    if (mesh.opposite.empty()) return;
    for (std::size_t h = 3 * t; h < 3 * t + 3; ++h) {
      write_child_opposites(static_cast<std::uint32_t>(h), parent.opposite[h],
                            mesh.opposite.data());
    }
  });
}

template <class T>
void copy_front(const Buffer<T>& from, std::size_t size, Buffer<T>& to) {
  if (from.empty()) return;
  to.resize(size);
  for_all(from.size(), [&](std::size_t i) { to[i] = from[i]; });
}

// Projects given vertex v, and says what became of it.
Fate project_vertex(const TargetSurface& surface, std::size_t v, double reach, IndexedMesh& mesh,
                    ProjectionStats& stats) {
  const ProjectedPoint p = surface.project(mesh.positions[v], reach);
  count_outcome(p, stats);
  if (p.outcome != ProjectionOutcome::converged) return Fate::stayed;
  mesh.positions[v] = p.position;
  const bool keeps_label = p.steps == 0 && surface.on_label(p.position, mesh.vertex_spheres[v]);
  if (!keeps_label) mesh.vertex_spheres[v] = label_of(p);
  return p.steps > 0 ? Fate::moved : Fate::stayed;
}

// Makes the midpoint of half-edge h, projected where that succeeds.
Fate make_midpoint(const SphereSet& spheres, const TargetSurface& surface, const Midpoints& level,
                   std::size_t h, IndexedMesh& mesh, ProjectionStats& stats) {
  const std::uint32_t v = level.midpoint_of(h);
  const Vec3d start = level.start(h);
  if (!mesh.normals.empty()) {
    mesh.normals[v] = unit_normal(cast<double>(level.parent.normals[level.start_of(h)]) +
                                  cast<double>(level.parent.normals[level.end_of(h)]));
  }
  if (surface.projection() != Projection::none) {
    const ProjectedPoint p = surface.project(start, level.reach(h));
    count_outcome(p, stats);
    if (p.outcome == ProjectionOutcome::converged) {
      mesh.positions[v] = p.position;
      mesh.vertex_spheres[v] = label_of(p);
      return p.steps > 0 ? Fate::moved : Fate::stayed;
    }
  }
  mesh.positions[v] = start;
  mesh.vertex_spheres[v] = level.unprojected_label(spheres.spheres().data(), h);
  return Fate::stayed;
}

}  // namespace

ProjectionStats project_given(const SphereSet& spheres, const TargetSurface& surface,
                              const IndexedMesh& given, IndexedMesh& mesh) {
  ProjectionStats stats;
  if (surface.projection() != Projection::none) {
    Buffer<Fate> fates(mesh.vertex_count());
    const Buffer<std::uint64_t> squares = longest_edge_squares(given);
    stats = tally(mesh.vertex_count(), [&](std::size_t v, ProjectionStats& total) {
      const double reach = std::sqrt(std::bit_cast<double>(squares[v]));
      fates[v] = project_vertex(surface, v, reach, mesh, total);
    });
    const bool labelled = !given.vertex_spheres.empty();
    take_back_turns(spheres, Given{given, mesh}, fates, stats, [&](std::size_t v) {
      mesh.positions[v] = given.positions[v];
      mesh.vertex_spheres[v] = labelled ? given.vertex_spheres[v] : on_sphere(kNoSphere);
    });
  }
  stats.turned = count_turned(spheres, mesh);
  return stats;
}

SubdividedMesh subdivide(const SphereSet& spheres, const TargetSurface& surface,
                         const IndexedMesh& parent) {
  const Buffer<std::uint32_t> edge = number_edges(parent.opposite);
  SubdividedMesh child;
  IndexedMesh& mesh = child.mesh;
  const Midpoints level{parent, edge, mesh};
  const std::size_t edges = parent.opposite.size() / 2;
  const std::size_t vertices = parent.vertex_count() + edges;
  copy_front(parent.positions, vertices, mesh.positions);
  copy_front(parent.vertex_spheres, vertices, mesh.vertex_spheres);
  copy_front(parent.normals, vertices, mesh.normals);
  write_children(level, mesh);

  Buffer<Fate> fates(edges);
  child.stats = tally(level.items(), [&](std::size_t h, ProjectionStats& total) {
    const std::optional<std::size_t> i = level.handled_by_item(h);
    if (i) fates[*i] = make_midpoint(spheres, surface, level, h, mesh, total);
  });
  take_back_turns(spheres, level, fates, child.stats, [&](std::size_t h) {
    const std::uint32_t v = level.midpoint_of(h);
    mesh.positions[v] = level.start(h);
    mesh.vertex_spheres[v] = level.unprojected_label(spheres.spheres().data(), h);
  });
  child.stats.turned = count_turned(spheres, mesh);
  return child;
}

}  // namespace vdwmesh
