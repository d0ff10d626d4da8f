// Refinement of meshes whose triangles name their spheres: creases stay creases.
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "contract/refiner_contract.hpp"
#include "measures/exact_union.hpp"
#include "reference/closed_forms.hpp"
#include "support/crease_meshes.hpp"
#include "support/worst.hpp"

namespace vdwmesh::testing {
namespace {

class RefinerConstraints : public RefinerContract {
 protected:
  RefineResult refine(const CreaseMesh& m, int levels) const {
    return RefinerContract::refine(m.spheres, m.mesh, refine_options(levels, Projection::vdw));
  }
  using RefinerContract::refine;
};

constexpr double kOnSphere = 1e-9;  // Å, the contract's

constexpr Sphere kBig{{0.3, -0.2, 0.1}, 1.7}, kSmall{{1.5, 0.9, 0.8}, 1.5};
constexpr std::array<Sphere, 3> kThree{Sphere{{0.1, 0.2, -0.1}, 1.7}, Sphere{{2.2, 0.4, 0.3}, 1.5},
                                       Sphere{{1.0, 1.9, -0.4}, 1.4}};

CreaseMesh two_balls() { return two_balls_mesh(kBig, kSmall, 12, 5); }
CreaseMesh three_balls() { return three_balls_mesh(kThree, 5, 6); }

reference::Measures exact_two() {
  return reference::two_balls(kBig.radius, kSmall.radius, norm(kSmall.center - kBig.center));
}
reference::Measures exact_three() {
  const std::vector<reference::Ball> balls = to_balls(three_balls().spheres);
  return reference::three_balls({balls[0], balls[1], balls[2]});
}

std::size_t label_size(const VertexSpheres& label) {
  return static_cast<std::size_t>(3 - std::count(label.begin(), label.end(), kNoSphere));
}

bool holds(const VertexSpheres& label, SphereId id) {
  return std::find(label.begin(), label.end(), id) != label.end();
}

// Every vertex on the spheres of its label and of the triangles around it, none inside a ball.
void expect_on_boundary(const SphereSet& spheres, const IndexedMesh& mesh) {
  double off = 0, depth = 0;
  const auto gap = [&](SphereId id, const Vec3d& p) {
    return norm(p - spheres[id].center) - spheres[id].radius;
  };
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    for (const SphereId id : mesh.vertex_spheres[v]) {
      if (id != kNoSphere) off = worst(off, std::abs(gap(id, mesh.positions[v])));
    }
    for (SphereId id = 0; id < spheres.size(); ++id) {
      depth = worst(depth, -gap(id, mesh.positions[v]));
    }
  }
  EXPECT_LE(off, kOnSphere);
  EXPECT_LE(depth, kOnSphere);
  ASSERT_EQ(mesh.triangle_spheres.size(), mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      ASSERT_TRUE(holds(mesh.vertex_spheres[v], mesh.triangle_spheres[t])) << "triangle " << t;
    }
  }
}

struct Errors {
  double area, volume;  // relative
};

Errors errors(const IndexedMesh& mesh, const reference::Measures& exact) {
  const reference::MeshFacts facts = facts_of(mesh);
  EXPECT_TRUE(facts.closed_oriented_manifold()) << facts.summary();
  EXPECT_EQ(facts.euler_characteristic(), 2);
  EXPECT_EQ(facts.degenerate_triangles, 0u);
  return {1 - facts.area / exact.area, 1 - facts.volume / exact.volume};
}

// Second order in the edge length, creases or not: a ratio of 4 up to terms of the fourth order.
constexpr double kOrderTwo = 4, kOrderTwoSlack = 0.2;

class RefinerConstraintsConvergence : public RefinerConstraints {
 protected:
  void expect_order_two(const CreaseMesh& m, const reference::Measures& exact) const {
    Errors last{0, 0};
    for (int level = 1; level <= 4; ++level) {
      const RefineResult result = refine(m, level);
      expect_on_boundary(m.spheres, result.mesh);
      EXPECT_EQ(left_out(result), 0u);
      for (const ProjectionStats& s : result.levels) EXPECT_EQ(s.turned, 0u);
      const Errors now = errors(result.mesh, exact);
      if (level > 1) {
        EXPECT_NEAR(last.area / now.area, kOrderTwo, kOrderTwoSlack) << "level " << level;
        EXPECT_NEAR(last.volume / now.volume, kOrderTwo, kOrderTwoSlack) << "level " << level;
      }
      last = now;
    }
  }
};

TEST_P(RefinerConstraintsConvergence, TwoBalls) { expect_order_two(two_balls(), exact_two()); }

TEST_P(RefinerConstraintsConvergence, ThreeBallsWithCorners) {
  expect_order_two(three_balls(), exact_three());
}

// Two independent ways to the measures of the three balls, both in double.
constexpr double kClosedFormRelative = 1e-13;

TEST(ThreeBalls, ClosedFormAgreesWithTheExactUnion) {
  const ExactUnion exact = exact_union(three_balls().spheres);
  EXPECT_NEAR(exact_three().area / exact.area, 1, kClosedFormRelative);
  EXPECT_NEAR(exact_three().volume / exact.volume, 1, kClosedFormRelative);
}

TEST_P(RefinerConstraints, GivenVerticesStayWhereTheyAre) {
  for (const CreaseMesh& m : {two_balls(), three_balls()}) {
    const RefineResult result = refine(m, 2);
    ASSERT_GT(result.mesh.vertex_count(), m.mesh.vertex_count());
    for (std::size_t v = 0; v < m.mesh.vertex_count(); ++v) {
      ASSERT_EQ(result.mesh.positions[v], m.mesh.positions[v]);
      ASSERT_EQ(result.mesh.vertex_spheres[v], m.mesh.vertex_spheres[v]);
    }
    EXPECT_EQ(refine(m, 0).mesh.positions, m.mesh.positions);
    EXPECT_EQ(refine(m, 0).mesh.triangle_spheres, m.mesh.triangle_spheres);
  }
}

// A midpoint is labelled with the spheres of the parents on both sides of its edge; each child is
// of its parent's sphere.
TEST_P(RefinerConstraints, LabelsAreThoseOfTheEdges) {
  for (const CreaseMesh& m : {two_balls(), three_balls()}) {
    const IndexedMesh mesh = refine(m, 1).mesh;
    std::vector<std::vector<SphereId>> around(mesh.vertex_count());
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
      ASSERT_EQ(mesh.triangle_spheres[t], m.mesh.triangle_spheres[t / 4]);
      for (const std::uint32_t v : mesh.triangles[t]) {
        std::vector<SphereId>& ids = around[v];
        if (std::find(ids.begin(), ids.end(), mesh.triangle_spheres[t]) == ids.end()) {
          ids.push_back(mesh.triangle_spheres[t]);
        }
      }
    }
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      ASSERT_EQ(mesh.vertex_spheres[v], on_spheres(around[v])) << "vertex " << v;
    }
  }
}

// In the middle between its ends, on the circle: by angles about the axis, in other words than the
// refiner's.
constexpr double kMiddleOfArc = 1e-12;  // rad

TEST_P(RefinerConstraints, CreaseMidpointsHalveTheirArcs) {
  const CreaseMesh m = two_balls();
  const IndexedMesh mesh = refine(m, 1).mesh;
  const Vec3d axis = unit_along(kSmall.center - kBig.center), u = any_normal_to(axis);
  const Vec3d v = cross(axis, u);
  const auto angle = [&](std::size_t i) {
    const Vec3d out = mesh.positions[i] - kBig.center;
    return std::atan2(dot(out, v), dot(out, u));
  };
  std::size_t found = 0;
  for (std::size_t i = m.mesh.vertex_count(); i < mesh.vertex_count(); ++i) {
    if (label_size(mesh.vertex_spheres[i]) != 2) continue;
    ++found;
    const double steps = angle(i) / (2 * std::numbers::pi / 24);
    EXPECT_NEAR(steps, std::round(steps), kMiddleOfArc);
    EXPECT_NE(static_cast<int>(std::round(steps)) % 2, 0);
  }
  EXPECT_EQ(found, 12u);
}

TEST_P(RefinerConstraints, AnEdgeBetweenPointsOfTheCircleGoesToItsTrianglesSphere) {
  const Sphere big{{0, 0, 0}, 2}, bump{{1, 0.1, 0}, 1.3};
  const int n = 9;
  const CreaseMesh m = bump_without_inner_vertices(big, bump, n, 6);
  const RefineResult result = refine(m, 1);
  expect_on_boundary(m.spheres, result.mesh);
  int across = 0, along_circle = 0;
  for (std::size_t v = m.mesh.vertex_count(); v < result.mesh.vertex_count(); ++v) {
    const VertexSpheres label = result.mesh.vertex_spheres[v];
    along_circle += label_size(label) == 2;
    if (label != on_sphere(1)) continue;
    ++across;
    EXPECT_GT(norm(result.mesh.positions[v] - big.center) - big.radius, 0.01);
  }
  EXPECT_EQ(across, n - 3);
  EXPECT_EQ(along_circle, n);
}

// Normals of the two spheres, or three, at a crease; double rounded to float.
constexpr double kNormalTolerance = 2e-7;

TEST_P(RefinerConstraints, NormalsAreTheMeanOfTheSpheres) {
  for (const CreaseMesh& m : {two_balls(), three_balls()}) {
    const IndexedMesh mesh = refine(m, 2).mesh;
    ASSERT_EQ(mesh.normals.size(), mesh.vertex_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      Vec3d sum{0, 0, 0};
      for (const SphereId id : mesh.vertex_spheres[v]) {
        if (id != kNoSphere) sum = sum + unit_along(mesh.positions[v] - m.spheres[id].center);
      }
      EXPECT_LE(norm(cast<double>(mesh.normals[v]) - unit_along(sum)), kNormalTolerance);
    }
  }
}

TEST_P(RefinerConstraints, StatsCountVerticesOnTheirSpheres) {
  const CreaseMesh m = three_balls();
  const RefineResult result = refine(m, 2);
  ASSERT_EQ(result.levels.size(), 3u);
  EXPECT_EQ(result.levels[0].projected, m.mesh.vertex_count());
  EXPECT_EQ(result.levels[1].projected, m.mesh.triangle_count() * 3 / 2);
  EXPECT_EQ(result.levels[2].projected, 4 * m.mesh.triangle_count() * 3 / 2);
  for (const ProjectionStats& s : result.levels) {
    EXPECT_EQ(s.iterations_max, 0);
    EXPECT_LE(s.residual_max, kOnSphere);
  }
  CreaseMesh off = m;
  off.mesh.positions[5] = off.mesh.positions[5] + Vec3d{0, 0, 1e-6};
  EXPECT_EQ(refine(off, 0).levels[0].unconverged, 1u);
  // The triangles around a vertex that went to the far side of its sphere face inward.
  off.mesh.positions[5] = off.mesh.positions[5] - Vec3d{0, 0, 8};
  EXPECT_GT(refine(off, 0).levels[0].turned, 0u);
}

TEST_P(RefinerConstraints, PermutedSpheresPermuteTheLabelsAlone) {
  const CreaseMesh m = three_balls();
  const IndexedMesh plain = refine(m, 2).mesh;
  for (const std::vector<SphereId>& place :
       {std::vector<SphereId>{2, 0, 1}, {1, 2, 0}, {2, 1, 0}, {0, 2, 1}}) {
    const IndexedMesh mesh = refine(relabelled(m, place), 2).mesh;
    EXPECT_EQ(mesh.positions, plain.positions);
    EXPECT_EQ(mesh.normals, plain.normals);
    EXPECT_EQ(mesh.triangles, plain.triangles);
    const IndexedMesh expected = relabelled({m.spheres, plain}, place).mesh;
    EXPECT_EQ(mesh.vertex_spheres, expected.vertex_spheres);
    EXPECT_EQ(mesh.triangle_spheres, expected.triangle_spheres);
  }
}

TEST_P(RefinerConstraints, GivenOppositesAndSingleStepsMakeNoDifference) {
  const CreaseMesh m = three_balls();
  const IndexedMesh at_once = refine(m, 2).mesh;
  const CreaseMesh half{m.spheres, refine(m, 1).mesh};
  ASSERT_FALSE(half.mesh.opposite.empty());
  const IndexedMesh in_steps = refine(half, 1).mesh;
  EXPECT_EQ(hash(in_steps), hash(at_once));
  EXPECT_EQ(in_steps.opposite, at_once.opposite);
}

TEST_P(RefinerConstraints, ThreadsDoNotMatter) {
  const CreaseMesh m = three_balls();
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return refine(m, 4);
  };
  const RefineResult one = with_threads(1);
  for (const std::size_t threads : {2u, 3u, 8u}) {
    const RefineResult more = with_threads(threads);
    EXPECT_EQ(hash(more.mesh), hash(one.mesh)) << threads << " threads";
    EXPECT_EQ(more.mesh.opposite, one.mesh.opposite);
    EXPECT_EQ(more.levels.back().residual_max, one.levels.back().residual_max);
  }
}

TEST_P(RefinerConstraints, BackendsAgree) {
  if (GetParam() == Backend::cpu) GTEST_SKIP() << "the backend compared with";
  for (const CreaseMesh& m : {two_balls(), three_balls()}) {
    const RefineResult cpu =
        make_refiner(Backend::cpu)->refine(m.spheres, m.mesh, refine_options(3, Projection::vdw));
    const RefineResult device = refine(m, 3);
    EXPECT_EQ(hash(device.mesh), hash(cpu.mesh));
    EXPECT_EQ(device.levels.back().residual_max, cpu.levels.back().residual_max);
  }
}

TEST_P(RefinerConstraints, TheObserverSeesTheTrianglesSpheres) {
  const CreaseMesh m = two_balls();
  RefineOptions options = refine_options(1, Projection::vdw);
  std::vector<std::size_t> seen;
  options.on_level = [&](int, const IndexedMesh& mesh) {
    EXPECT_EQ(mesh.triangle_spheres.size(), mesh.triangle_count());
    seen.push_back(mesh.triangle_spheres.size());
  };
  refine(m.spheres, m.mesh, options);
  EXPECT_EQ(seen, (std::vector<std::size_t>{m.mesh.triangle_count(), 4 * m.mesh.triangle_count()}));
}

TEST_P(RefinerConstraints, WithoutProjectionMidpointsStayOnTheirEdges) {
  CreaseMesh m = two_balls();
  m.mesh.normals.assign(m.mesh.vertex_count(), {0, 0, 1});
  const RefineResult plain = refine(m.spheres, m.mesh, refine_options(1, Projection::none));
  const RefineResult projected = refine(m, 1);
  EXPECT_EQ(plain.mesh.triangles, projected.mesh.triangles);
  EXPECT_EQ(plain.mesh.vertex_spheres, projected.mesh.vertex_spheres);
  EXPECT_EQ(plain.mesh.triangle_spheres, projected.mesh.triangle_spheres);
  EXPECT_EQ(plain.mesh.normals.size(), plain.mesh.vertex_count());
  EXPECT_NEAR(facts_of(plain.mesh).area / facts_of(m.mesh).area, 1, 1e-12);
}

// A circle so small that the balls' radii hardly tell its radius: its relative error from them
// would be (radius of the ball / radius of the circle)² × 2^-53.
TEST_P(RefinerConstraints, TinyCirclesStayRound) {
  for (const double overlap : {1e-6, 1e-9, 1e-12}) {
    const Vec3d direction = unit_along({0.48, -0.6, 0.64});
    const Sphere a{{0, 0, 0}, 1.7}, b{(1.7 + 1.5 - overlap) * direction, 1.5};
    const CreaseMesh m = two_balls_mesh(a, b, 6, 6);
    const double radius = norm(m.mesh.positions[0] - m.mesh.positions[3]) / 2;
    ASSERT_GT(radius, 0);
    const RefineResult result = refine(m, 2);
    expect_on_boundary(m.spheres, result.mesh);
    EXPECT_EQ(result.levels[1].turned + result.levels[2].turned, 0u) << overlap;
    EXPECT_GT(errors(result.mesh, reference::two_balls(1.7, 1.5, norm(b.center))).area, 0);
    // A coordinate of 1.7 Å is rounded to 2^-53 of itself, twice in the way from the axis.
    const double rounding = 8 * 1.7 * std::numeric_limits<double>::epsilon();
    const Vec3d middle = 0.5 * (m.mesh.positions[0] + m.mesh.positions[3]);
    for (std::size_t v = 0; v < result.mesh.vertex_count(); ++v) {
      if (label_size(result.mesh.vertex_spheres[v]) != 2) continue;
      EXPECT_NEAR(norm(result.mesh.positions[v] - middle), radius, rounding) << overlap;
    }
  }
}

// By powers of two, so that every rounding is the same.
TEST_P(RefinerConstraints, ScaleDoesNotMatter) {
  for (const double scale : {1.0, std::exp2(-40), std::exp2(40)}) {
    const Sphere a{scale * kBig.center, scale * kBig.radius};
    const Sphere b{scale * kSmall.center, scale * kSmall.radius};
    const IndexedMesh mesh = refine(two_balls_mesh(a, b, 12, 5), 1).mesh;
    const IndexedMesh expected = refine(two_balls(), 1).mesh;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      ASSERT_EQ(mesh.positions[v], scale * expected.positions[v]);
    }
  }
}

TEST_P(RefinerConstraints, BadInputIsRefused) {
  const CreaseMesh m = two_balls();
  const auto refuse = [&](const IndexedMesh& mesh, const RefineOptions& options,
                          const std::string& words) {
    try {
      refine(m.spheres, mesh, options);
      ADD_FAILURE() << "nothing thrown: " << words;
    } catch (const InvalidInput& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(words));
    }
  };
  const RefineOptions once = refine_options(1, Projection::vdw);
  refuse(m.mesh, field_options(1, FieldKind::blinn, GridSpec{{-3, -3, -3}, 0.5, {12, 12, 12}}),
         "project them to vdw");
  IndexedMesh bad = m.mesh;
  bad.triangle_spheres.pop_back();
  refuse(bad, once, "triangle labels");
  bad = m.mesh;
  bad.triangle_spheres[3] = 2;
  refuse(bad, once, "triangle 3");
  bad = m.mesh;
  bad.vertex_spheres = {};
  refuse(bad, once, "label them");
}

// The result and its parent, with nothing to search in.
TEST(RefineBytes, OfConstrainedMeshesAreTheMeshesAndTheEdges) {
  const std::uint64_t labelled = refine_bytes(1002, 2000, 1, 2, TriangleLabels::spheres);
  const auto mesh = [](std::uint64_t v, std::uint64_t t) {
    return indexed_mesh_bytes({v, t}, {.connectivity = Connectivity::half_edges,
                                       .labels = TriangleLabels::spheres,
                                       .width = LabelWidth::three});
  };
  EXPECT_EQ(labelled, mesh(4002, 8000) + mesh(16002, 32000) + std::uint64_t{8000} * 12);
  EXPECT_LT(labelled, refine_bytes(1002, 2000, 1, 2));
  EXPECT_EQ(labelled, refine_bytes(1002, 2000, 290000, 2, TriangleLabels::spheres));
}

VDWMESH_INSTANTIATE_BACKENDS(RefinerConstraints);
VDWMESH_INSTANTIATE_BACKENDS(RefinerConstraintsConvergence);

}  // namespace
}  // namespace vdwmesh::testing
