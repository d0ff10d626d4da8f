// Moves that are only seen to be bad once another one is back.
#include "refine/crossings/bad_moves.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "refine/level_view.hpp"

namespace vdwmesh {
namespace {

// Far below all triangles here: those in a plane z = 0 face outward where z sees them
// counter-clockwise.
const SphereSet kBelow(std::vector<Sphere>{{{0, 0, -10}, 10}});

struct Moves {
  std::vector<Triangle> triangles;
  std::vector<Vec3d> before, after;
  std::vector<SphereId> atoms;  // of the vertices
};

// Where the vertices are after the bad moves were taken back.
std::vector<Vec3d> settled(const Moves& moves, Crossings crossings) {
  IndexedMesh given;
  given.positions.assign(moves.before.begin(), moves.before.end());
  given.triangles.assign(moves.triangles.begin(), moves.triangles.end());
  given.vertex_spheres.atoms.assign(moves.atoms.begin(), moves.atoms.end());
  IndexedMesh mesh = given;
  mesh.positions.assign(moves.after.begin(), moves.after.end());
  Buffer<MoveState> move_states;
  for (std::size_t v = 0; v < given.vertex_count(); ++v) {
    move_states.push_back(moves.after[v] == moves.before[v] ? MoveState::stayed : MoveState::moved);
  }
  RefineOptions options;
  options.crossings = crossings;
  take_back_bad_moves(kBelow, Given{given.positions, mesh}, move_states, options,
                      [&](std::size_t v) { mesh.positions[v] = given.positions[v]; });
  return {mesh.positions.begin(), mesh.positions.end()};
}

// Of a square cut along its diagonal, vertex 2 moves through the first triangle's opposite edge and
// turns it. The second triangle still faces outward with both of its moves, and with neither of
// them, but is turned when vertex 2 alone is back.
TEST(BadMoves, ATriangleTurnedByWhatWentBackGoesBackToo) {
  Moves moves{{{0, 1, 2}, {1, 3, 2}},
              {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}},
              {{0, 0, 0}, {2, 0, 0}, {0, -4, 0}, {1, -1, 0}},
              {0, 0, 0, 0}};
  EXPECT_EQ(settled(moves, Crossings::allow), moves.before);
  // Without the first triangle nothing is turned, and everything stays where it went.
  moves.triangles.erase(moves.triangles.begin());
  EXPECT_EQ(settled(moves, Crossings::allow), moves.after);
}

// The first triangle is turned, far from where it was; the second, of no atom, has moved down by 3
// and would pierce the first where that was, in (1, 1, 0).
TEST(BadMoves, ATriangleThatWentBackIsCrossedWhereItWas) {
  Moves moves{{{0, 1, 2}, {3, 4, 5}},
              {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 2}, {1, 1, 4}, {2, 2, 3}},
              {{100, 0, 0}, {100, 4, 0}, {104, 0, 0}, {1, 1, -1}, {1, 1, 1}, {2, 2, 0}},
              {0, 0, 0, kNoSphere, kNoSphere, kNoSphere}};
  EXPECT_EQ(settled(moves, Crossings::undo), moves.before);
  // The crossing alone brings the second triangle back.
  std::vector<Vec3d> first_back = moves.after;
  for (std::size_t v = 0; v < 3; ++v) first_back[v] = moves.before[v];
  EXPECT_EQ(settled(moves, Crossings::allow), first_back);
}

}  // namespace
}  // namespace vdwmesh
