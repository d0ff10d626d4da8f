// The crease-exact mesh against closed forms: area, volume, topology, order of convergence.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "contract/exact_mesher_contract.hpp"
#include "reference/closed_forms.hpp"

namespace vdwmesh::testing {
namespace {

class ExactMesherAnalytic : public ExactMesherContract {};
VDWMESH_INSTANTIATE_BACKENDS(ExactMesherAnalytic);

struct Errors {
  double area, volume;  // relative; positive where the mesh has less
};

Errors errors_of(const IndexedMesh& mesh, const reference::Measures& exact) {
  const MeshMeasures m = measures(mesh);
  return {1 - m.area / exact.area, 1 - m.volume.value() / exact.volume};
}

reference::Measures measures_of(const ExactUnion& u) { return {u.area, u.volume}; }

// Second order in the edge length: a ratio of 4, up to terms of the fourth order.
constexpr double kOrderTwo = 4, kOrderTwoSlack = 0.2;
// Relative: what is left after Richardson's extrapolation from the last two levels, of the fourth
// order; issue 6 asks for it.
constexpr double kExtrapolated = 2e-5;

// From the second level on; the first has the terms of the fourth order of the coarsest mesh.
void expect_order_two(const SphereSet& spheres, double edge_length,
                      const reference::Measures& exact) {
  const IndexedMesh mesh = mesh_at(spheres, edge_length).mesh;
  std::vector<MeshMeasures> levels;
  for (int level = 0; level <= 3; ++level) {
    levels.push_back(measures(subdivided(spheres, mesh, level)));
  }
  const auto ratio = [](double coarse, double fine, double limit) {
    return (coarse - limit) / (fine - limit);
  };
  for (std::size_t l = 1; l + 1 < levels.size(); ++l) {
    const MeshMeasures &coarse = levels[l], &fine = levels[l + 1];
    EXPECT_NEAR(ratio(coarse.area, fine.area, exact.area), kOrderTwo, kOrderTwoSlack);
    EXPECT_NEAR(ratio(*coarse.volume, *fine.volume, exact.volume), kOrderTwo, kOrderTwoSlack);
  }
  const double area = extrapolate_second_order(levels[2].area, levels[3].area);
  const double volume = extrapolate_second_order(*levels[2].volume, *levels[3].volume);
  EXPECT_NEAR(area, exact.area, kExtrapolated * exact.area);
  EXPECT_NEAR(volume, exact.volume, kExtrapolated * exact.volume);
}

SphereSet three_balls() {
  return SphereSet({{{0.1, 0.2, -0.1}, 1.7}, {{2.2, 0.4, 0.3}, 1.5}, {{1.0, 1.9, -0.4}, 1.4}});
}
reference::Measures exact_three() {
  const std::vector<reference::Ball> balls = to_balls(three_balls());
  return reference::three_balls({balls[0], balls[1], balls[2]});
}

TEST_P(ExactMesherAnalytic, OneSphere) {
  const SphereSet spheres = one_sphere(1.7);
  expect_union_meshes(spheres, 0.35, 2);
  expect_order_two(spheres, 0.35, reference::ball(1.7));
}

TEST_P(ExactMesherAnalytic, TwoSpheres) {
  for (const double distance : {0.4, 1.2, 2.0, 3.0}) {
    SCOPED_TRACE(distance);
    const SphereSet spheres = two_spheres(1.7, 1.5, distance);
    expect_union_meshes(spheres, 0.35, 2);
    expect_order_two(spheres, 0.35, reference::two_balls(1.7, 1.5, distance));
  }
}

TEST_P(ExactMesherAnalytic, ThreeSpheresWithTwoCorners) {
  const IndexedMesh mesh = expect_union_meshes(three_balls(), 0.35, 2);
  EXPECT_EQ(std::count_if(mesh.vertex_spheres.others.begin(), mesh.vertex_spheres.others.end(),
                          [](const OtherSpheres& o) { return o[1] != kNoSphere; }),
            2);
  const ExactMeshStats stats = mesh_at(three_balls(), 0.35).stats;
  EXPECT_EQ(stats.corners, 2u);
  EXPECT_EQ(stats.arcs, 3u);
  EXPECT_EQ(stats.points + stats.contacts, 0u);
  expect_order_two(three_balls(), 0.35, exact_three());
}

// Nothing is narrow there, so no piece of an arc has to be split.
TEST_P(ExactMesherAnalytic, WideArcsStayAsTheyWereSampled) {
  EXPECT_EQ(mesh_at(one_sphere(1.7), 0.3).stats.split, 0u);
  EXPECT_EQ(mesh_at(SphereSet({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}}), 0.3).stats.split, 0u);
}

TEST_P(ExactMesherAnalytic, SpheresApart) {
  const SphereSet spheres = two_spheres(1.7, 1.5, 4.0);
  const IndexedMesh mesh = expect_union_meshes(spheres, 0.4, 1);
  EXPECT_EQ(topology(mesh).components, 2u);
  expect_order_two(spheres, 0.4, reference::two_balls(1.7, 1.5, 4.0));
}

TEST_P(ExactMesherAnalytic, RingOfBalls) {
  for (const int n : {5, 6, 12, 31}) {
    SCOPED_TRACE(n);
    // Neighbours overlap by a quarter of the radius, and no others meet.
    const double ball = 1.5, ring = 1.75 * ball / 2 / std::sin(std::numbers::pi / n);
    const SphereSet spheres = ring_of_spheres(n, ring, ball);
    const IndexedMesh mesh = expect_union_meshes(spheres, 0.4, 1);
    EXPECT_EQ(topology(mesh).euler_characteristic, 0);
    EXPECT_EQ(topology(mesh).genus, 1);
    if (n < 12) expect_order_two(spheres, 0.4, reference::ring_of_balls(n, ring, ball));
  }
}

// Six equal balls of which neighbours meet in pairs and triples, and opposite ones do not, so that
// no four have a point in common. Area and volume are additive: those of unions of two and of three
// balls give those of the whole.
reference::Measures exact_octahedron(double cage_radius, double ball_radius) {
  const double r = ball_radius, edge = std::sqrt(2.0) * cage_radius;
  const std::vector<reference::Ball> face = to_balls(
      SphereSet({{{cage_radius, 0, 0}, r}, {{0, cage_radius, 0}, r}, {{0, 0, cage_radius}, r}}));
  const auto union_of = [&](double reference::Measures::*part) {
    const double one = reference::ball(r).*part;
    const double pair = 2 * one - reference::two_balls(r, r, edge).*part;
    const double triple =
        reference::three_balls({face[0], face[1], face[2]}).*part - 3 * one + 3 * pair;
    return 6 * one - 12 * pair + 8 * triple;
  };
  return {union_of(&reference::Measures::area), union_of(&reference::Measures::volume)};
}

// Six balls that close a void between them: 12 pairs meet, and the 8 triples cover the faces.
TEST_P(ExactMesherAnalytic, OctahedronWithAVoid) {
  const SphereSet spheres = cage(octahedron_corners(), 2.0, 1.8);
  const IndexedMesh mesh = expect_union_meshes(spheres, 0.35, 2);
  EXPECT_EQ(topology(mesh).euler_characteristic, 4);
  EXPECT_EQ(topology(mesh).voids, 1u);
  expect_order_two(spheres, 0.35, exact_octahedron(2.0, 1.8));
}

// Pairs meet and triples do not: 8 windows in the wall of one room.
TEST_P(ExactMesherAnalytic, OctahedronWithWindows) {
  const SphereSet spheres = cage(octahedron_corners(), 2.0, 1.5);
  const IndexedMesh mesh = expect_union_meshes(spheres, 0.35, 2);
  EXPECT_EQ(topology(mesh).euler_characteristic, 2 - 2 * 7);
}

TEST_P(ExactMesherAnalytic, IcosahedronWithAVoid) {
  const SphereSet spheres = cage(icosahedron_corners(), 3.0, 1.9);
  const IndexedMesh mesh = expect_union_meshes(spheres, 0.35, 1);
  EXPECT_EQ(topology(mesh).euler_characteristic, 4);
}

TEST_P(ExactMesherAnalytic, IcosahedronWithWindows) {
  // Edges of the body are 2 / sqrt(phi sqrt(5)) = 1.0515 of its radius: pairs meet beyond 1.577 Å
  // and triples beyond 1.822 Å.
  const SphereSet spheres = cage(icosahedron_corners(), 3.0, 1.7);
  const IndexedMesh mesh = expect_union_meshes(spheres, 0.35, 1);
  EXPECT_EQ(topology(mesh).euler_characteristic, 2 - 2 * 19);
}

TEST_P(ExactMesherAnalytic, ShellOfManyBalls) {
  const IndexedMesh mesh = expect_union_meshes(hollow_shell(200, 6, 1.2), 0.4, 1);
  EXPECT_EQ(topology(mesh).voids, 1u);
}

// Two spheres and edges of h: the error is c h², c depending on the shape of the triangles, which
// is much the same at all h. Between h and h/2 that is a ratio of 4.
TEST_P(ExactMesherAnalytic, AreaErrorFallsWithTheSquareOfTheEdgeLength) {
  constexpr double kShapes = 0.8;  // the part of the ratio that is left to the triangles' shapes
  for (const SphereSet& spheres : {two_spheres(1.7, 1.5, 2.0), three_balls(), cluster(40, 3)}) {
    const reference::Measures exact = measures_of(exact_union(spheres));
    double before = 0;
    for (const double h : {0.6, 0.3, 0.15}) {
      const Errors error = errors_of(mesh_at(spheres, h).mesh, exact);
      EXPECT_GT(error.area, 0);    // inscribed
      EXPECT_GT(error.volume, 0);  // the same
      if (before > 0) {
        EXPECT_NEAR(before / error.area, kOrderTwo, kShapes) << "edge length " << h;
      }
      before = error.area;
    }
  }
}

// As many balls as a small protein, as close together.
TEST_P(ExactMesherAnalytic, ConvergesOnACluster) {
  const SphereSet spheres = cluster(150, 8);
  expect_order_two(spheres, 0.5, measures_of(exact_union(spheres)));
}

}  // namespace
}  // namespace vdwmesh::testing
