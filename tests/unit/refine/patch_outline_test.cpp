// Patches that a plane keeps apart have no triangles that cross, and taking back bad moves with all
// shortcuts gives the same mesh as with tests of all pairs of triangles.
#include "refine/crossings/patch_outline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "core/order/split_mix.hpp"
#include "extract/extractor.hpp"
#include "refine/children.hpp"
#include "refine/crossings/bad_moves.hpp"
#include "refine/crossings/crossing_formulas.hpp"
#include "refine/crossings/preparation.hpp"
#include "refine/crossings/vertex_moves.hpp"
#include "refine/half_edges.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : state_(seed) {}
  std::uint64_t below(std::uint64_t count) { return split_mix(state_++) % count; }
  double unit() { return static_cast<double>(split_mix(state_++) >> 11) * 0x1p-53; }
  Vec3d place(double scale) { return {scale * unit(), scale * unit(), scale * unit()}; }

 private:
  std::uint64_t state_;
};

struct SixVertices {
  std::array<std::uint32_t, 6> vertex;
  std::array<Vec3d, 6> position;
};

// The triangles of a patch cross none of the other; of the same patch, each pair once.
bool any_cross(const SixVertices& a, const SixVertices& b, bool is_same) {
  const std::array<SphereId, 3> none{kNoSphere, kNoSphere, kNoSphere};
  const auto corners = [](const SixVertices& patch, int child) {
    std::pair<std::array<Vec3d, 3>, std::array<std::uint32_t, 3>> found;
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(child_corner(child, k));
      found.first[static_cast<std::size_t>(k)] = patch.position[i];
      found.second[static_cast<std::size_t>(k)] = patch.vertex[i];
    }
    return found;
  };
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < (is_same ? i : 4); ++j) {
      const auto [s, vs] = corners(a, i);
      const auto [t, vt] = corners(b, j);
      if (boxes_overlap(s.data(), t.data()) &&
          triangles_cross(s.data(), vs.data(), none.data(), t.data(), vt.data(), none.data())) {
        return true;
      }
    }
  }
  return false;
}

// Few points, so that patches share vertices. On a lattice they also lie in planes and lines; away
// from it, coordinates are rounded. Midpoints are near the middles of their edges, or anywhere.
TEST(PatchOutline, ShutsOutNoPatchThatCrosses) {
  Chance draw(1);
  int apart = 0, sharing = 0, crossing = 0, sound = 0, unsound = 0;
  for (int round = 0; round < 100000; ++round) {
    std::vector<Vec3d> points;
    for (int i = 0; i < 7; ++i) {
      points.push_back(round % 2 == 0 ? Vec3d{1.0 * static_cast<double>(draw.below(4)),
                                              1.0 * static_cast<double>(draw.below(4)),
                                              1.0 * static_cast<double>(draw.below(3))}
                                      : draw.place(0.7));
    }
    const auto patch = [&] {
      SixVertices found;
      std::array<std::uint32_t, 3> corner{};
      for (auto& c : corner) c = static_cast<std::uint32_t>(draw.below(points.size()));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t u = corner[k], v = corner[(k + 1) % 3];
        found.vertex[k] = u;
        found.position[k] = points[u];
        // The same edge has the same midpoint in every patch.
        Chance of_edge(1000003 * static_cast<std::uint64_t>(round) + 8 * (u * v) + 64 * (u + v));
        const double size = std::array{0.0, 0.1, 0.3, 2.0}[of_edge.below(4)];
        found.vertex[k + 3] = 100 + 10 * std::min(u, v) + std::max(u, v);
        found.position[k + 3] =
            midpoint(points[u], points[v]) + of_edge.place(size) - Vec3d{size / 2, size / 2, 0};
      }
      return found;
    };
    const SixVertices a = patch(), b = patch();
    PatchOutline of_a, of_b;
    of_a.set(a.vertex, a.position, 6);
    of_b.set(b.vertex, b.position, 6);
    const bool is_apart = of_a.keeps_out<6>(of_b) || of_b.keeps_out<6>(of_a);
    const bool cross = any_cross(a, b, false);
    ASSERT_FALSE(is_apart && cross) << round;
    const bool shares = std::ranges::any_of(
        a.vertex, [&](std::uint32_t v) { return std::ranges::count(b.vertex, v) > 0; });
    apart += is_apart;
    sharing += is_apart && shares;
    crossing += cross;
    const bool is_sound = of_a.separates_children(6);
    ASSERT_FALSE(is_sound && any_cross(a, a, true)) << round;
    sound += is_sound;
    unsound += any_cross(a, a, true);
  }
  EXPECT_GT(apart, 10000);
  EXPECT_GT(sharing, 5000);
  EXPECT_GT(crossing, 10000);
  EXPECT_GT(sound, 10000);
  EXPECT_GT(unsound, 100);
}

// Two triangles of a square cut along its diagonal, folded along it: apart unless they lie on one
// another.
TEST(PatchOutline, KeepsTrianglesApartUpToARightAngle) {
  for (const double degrees : {0.0, 30.0, 89.0, -89.0, 180.0}) {
    const double turn = degrees * std::numbers::pi / 180;
    const std::array<Vec3d, 3> one{{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}},
        other{{{1, 0, 0}, {0, 0, 0}, {0, std::cos(turn), std::sin(turn)}}};
    PatchOutline a, b;
    a.set(std::array<std::uint32_t, 3>{0, 1, 2}, one, 1);
    b.set(std::array<std::uint32_t, 3>{1, 0, 3}, other, 1);
    EXPECT_EQ(a.keeps_out<3>(b), degrees < 90) << degrees;
    EXPECT_EQ(b.keeps_out<3>(a), degrees < 90) << degrees;
  }
}

struct BallSet {
  const char* name;
  std::vector<Sphere> balls;
  double spacing;
};

std::vector<BallSet> ball_sets() {
  Chance draw(7);
  std::vector<BallSet> sets(5);
  sets[0] = {"random", {}, 0.9};
  for (int i = 0; i < 6; ++i) sets[0].balls.push_back({draw.place(3), 0.6 + draw.unit()});
  sets[1] = {"lattice on the grid", {}, 0.75};  // many vertices in a line or a plane
  for (int i = 0; i < 8; ++i) {
    sets[1].balls.push_back({{1.5 * (i & 1), 0.75 * (i & 2), 0.375 * (i & 4)}, 1});
  }
  sets[2] = {"far away", {}, 0.9};
  for (int i = 0; i < 5; ++i) {
    sets[2].balls.push_back({draw.place(2) + Vec3d{3e4, -2e4, 1e5}, 0.5 + draw.unit()});
  }
  sets[3] = {"flat", {}, 0.5};
  for (int i = 0; i < 9; ++i) {
    sets[3].balls.push_back({{2 * draw.unit(), 2 * draw.unit(), 0.05 * draw.unit()}, 0.5});
  }
  sets[4] = {"small in large", {{{0, 0, 0}, 3}}, 1.3};
  for (int i = 0; i < 6; ++i) sets[4].balls.push_back({draw.place(3), 0.4 + 0.3 * draw.unit()});
  return sets;
}

// The label of the midpoint of half-edge h where it stays in the middle.
VertexSpheres label_in_the_middle(const SphereSet& spheres, const Midpoints& level, std::size_t h) {
  const std::uint32_t a = level.start_of(h), b = level.end_of(h);
  const IndexedMesh& parent = level.parent;
  const EdgeEnds ends{parent.positions[a], parent.positions[b], parent.vertex_spheres.atoms[a],
                      parent.vertex_spheres.atoms[b]};
  return ends.unprojected_label(spheres.spheres().data());
}

// How many midpoints move: so few that the search begins with those, or most; or most, of which
// every other one is thrown about so far that going back makes new crossings.
enum class Moving { few, most, wildly };

// Moves midpoints to the nearest sphere, which wrinkles the mesh in the creases, leaves some and
// throws a few about.
Buffer<MoveState> move_midpoints(const SphereSet& spheres, const Midpoints& level, Moving moving,
                                 IndexedMesh& mesh, Chance& draw) {
  Buffer<MoveState> states(level.items() / 2);
  for (std::size_t h = 0; h < level.items(); ++h) {
    const auto i = level.handled_by_item(h);
    if (!i) continue;
    const std::uint32_t v = level.midpoint_of(h);
    const Vec3d start = level.middle_of(h);
    mesh.positions[v] = start;
    mesh.vertex_spheres.set(v, label_in_the_middle(spheres, level, h));
    states[*i] = MoveState::stayed;
    const std::uint64_t fate = draw.below(30);
    if (fate < 4 || (moving == Moving::few && draw.below(10) > 0)) continue;
    states[*i] = MoveState::moved;
    const double throws = moving == Moving::wildly ? 0.8 : 0.4;
    if (fate < (moving == Moving::wildly ? 17u : 6u)) {
      mesh.positions[v] = start + draw.place(throws) - 0.5 * throws * Vec3d{1, 1, 1};
      continue;
    }
    const auto ids = spheres.size();
    SphereId nearest = 0;
    for (SphereId id = 1; id < ids; ++id) {
      if (gap(spheres.spheres()[id], start) < gap(spheres.spheres()[nearest], start)) nearest = id;
    }
    mesh.positions[v] = nearest_on_sphere(spheres.spheres()[nearest], start).position;
    mesh.vertex_spheres.set(v, on_sphere(nearest));
  }
  return states;
}

// What take_back_bad_moves() promises, with all pairs of triangles in every pass. Returns how many
// passes it took, with the last one, which finds nothing.
int restore_by_all_pairs(const SphereSet& spheres, const Midpoints& level, IndexedMesh& mesh,
                         Buffer<MoveState> states) {
  const std::size_t first = level.first_handled();
  std::vector<std::size_t> half_edge(mesh.vertex_count());  // by midpoint
  for (std::size_t h = 0; h < level.items(); ++h) half_edge[level.midpoint_of(h)] = h;
  const auto is_away = [&](std::uint32_t v) {
    return v >= first && states[v - first] == MoveState::moved;
  };
  const auto before = [&](std::uint32_t v) {
    return v < first ? mesh.positions[v] : level.middle_of(half_edge[v]);
  };
  int passes = 0;
  for (std::vector<bool> bad(mesh.vertex_count(), true); std::ranges::count(bad, true) > 0;) {
    ++passes;
    bad.assign(mesh.vertex_count(), false);
    const auto mark = [&](const Triangle& t) {
      for (const std::uint32_t v : t) bad[v] = bad[v] || is_away(v);
    };
    for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
      const Triangle& t = mesh.triangles[i];
      std::array<Vec3d, 3> now, then;
      std::array<SphereId, 3> atoms;
      for (std::size_t k = 0; k < 3; ++k) {
        now[k] = mesh.positions[t[k]];
        then[k] = before(t[k]);
        atoms[k] = mesh.vertex_spheres.atoms[t[k]];
      }
      const Sphere* const all = spheres.spheres().data();
      if (facing(all, now.data(), atoms.data()) == Facing::against_one_atom &&
          facing(all, then.data(), atoms.data()) == Facing::outward) {
        mark(t);
      }
      for (std::size_t j = 0; j < i; ++j) {
        const Triangle& u = mesh.triangles[j];
        if (std::ranges::none_of(t, is_away) && std::ranges::none_of(u, is_away)) continue;
        std::array<Vec3d, 3> other;
        std::array<SphereId, 3> other_atoms;
        for (std::size_t k = 0; k < 3; ++k) {
          other[k] = mesh.positions[u[k]];
          other_atoms[k] = mesh.vertex_spheres.atoms[u[k]];
        }
        if (!boxes_overlap(now.data(), other.data()) ||
            !triangles_cross(now.data(), t.data(), atoms.data(), other.data(), u.data(),
                             other_atoms.data())) {
          continue;
        }
        mark(t);
        mark(u);
      }
    }
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      if (!bad[v]) continue;
      mesh.positions[v] = level.middle_of(half_edge[v]);
      mesh.vertex_spheres.set(v, label_in_the_middle(spheres, level, half_edge[v]));
      states[v - first] = MoveState::stayed;
    }
  }
  return passes;
}

// Takes back the bad moves of a level as `view` sees it, and returns how many.
template <class Level>
std::uint64_t restore(const SphereSet& spheres, const Level& view, IndexedMesh& mesh,
                      Buffer<MoveState> states) {
  return take_back_bad_moves(spheres, view, states, {}, [&](std::size_t h) {
    const std::uint32_t v = view.midpoint_of(h);
    mesh.positions[v] = view.middle_of(h);
    mesh.vertex_spheres.set(v, label_in_the_middle(spheres, view, h));
  });
}

struct RestoredMeshes {
  std::uint64_t undone = 0;
  int most_passes = 0;
};

// Two levels, so that the second has edges that lie in a line since the first, and a parent that
// was divided: its patches are those of Midpoints as well as those of DividedMidpoints.
RestoredMeshes expect_those_of_all_pairs(const BallSet& set, Moving moving, Chance& draw) {
  const SphereSet spheres(set.balls);
  ExtractOptions extract;
  extract.grid.spacing = set.spacing;
  RefineOptions options;
  options.subdivisions = 2;
  IndexedMesh parent = prepare_mesh(make_cpu_extractor()->extract(spheres, extract).mesh, options);
  RestoredMeshes all;
  for (int depth = 0; depth < 2 && parent.triangle_count() < 2000; ++depth) {
    const Buffer<std::uint32_t> edge = number_edges(parent.opposite);
    IndexedMesh mesh;
    const Midpoints level{parent, edge, mesh};
    make_children(level, Connectivity::half_edges, mesh);
    const Buffer<MoveState> states = move_midpoints(spheres, level, moving, mesh, draw);
    IndexedMesh expected = mesh, divided = mesh;
    const int passes =
        restore_by_all_pairs(spheres, Midpoints{parent, edge, expected}, expected, states);
    all.most_passes = std::max(all.most_passes, passes);
    all.undone += restore(spheres, level, mesh, states);
    EXPECT_EQ(mesh.positions, expected.positions) << set.name << ", level " << depth + 1;
    if (depth > 0) {
      restore(spheres, DividedMidpoints{{parent, edge, divided}}, divided, states);
      EXPECT_EQ(divided.positions, expected.positions) << set.name << ", divided";
    }
    parent = std::move(mesh);
  }
  return all;
}

TEST(BadMovesOfMidpoints, AreThoseOfAllPairs) {
  Chance draw(11), wild_draw(12);
  int most_passes = 0;
  for (const BallSet& set : ball_sets()) {
    EXPECT_GT(expect_those_of_all_pairs(set, Moving::most, draw).undone, 20u) << set.name;
    const RestoredMeshes wild = expect_those_of_all_pairs(set, Moving::wildly, wild_draw);
    EXPECT_GT(wild.undone, 20u) << set.name;
    most_passes = std::max(most_passes, wild.most_passes);
    EXPECT_GT(expect_those_of_all_pairs(set, Moving::few, draw).undone, 0u) << set.name;
  }
  // Two passes that find something, so that the second depends on what the first has put back.
  EXPECT_GT(most_passes, 2);
}

}  // namespace
}  // namespace vdwmesh
