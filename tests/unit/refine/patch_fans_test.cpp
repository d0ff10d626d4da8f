// Fans of patches whose children are divided: triangles around a star do not cross, vertices of a
// patch are where they are said to be, and a border that turns too far is not taken for a star.
#include "refine/crossings/patch_fans.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/order/split_mix.hpp"
#include "extract/extractor.hpp"
#include "refine/children.hpp"
#include "refine/crossings/crossing_formulas.hpp"
#include "refine/crossings/preparation.hpp"
#include "refine/half_edges.hpp"
#include "surface/patch_star.hpp"

namespace vdwmesh {
namespace {

// A mesh of two balls that was divided twice, each time with midpoints thrown about by up to half
// of `size` (Å) along each axis, and what Midpoints refers to on the second level.
struct DividedTwice {
  IndexedMesh parent, mesh;
  Buffer<std::uint32_t> edge;
  std::size_t given = 0;  // vertices of the mesh that was divided

  explicit DividedTwice(double size) {
    const SphereSet spheres({{{0, 0, 0}, 1}, {{1.1, 0.2, 0.1}, 0.8}});
    ExtractOptions extract;
    extract.grid.spacing = 0.7;
    RefineOptions options;
    options.subdivisions = 2;
    mesh = prepare_mesh(make_cpu_extractor()->extract(spheres, extract).mesh, options);
    given = mesh.vertex_count();
    std::uint64_t draw = 5;
    const auto shift = [&] {
      return size * (static_cast<double>(split_mix(draw++) >> 11) * 0x1p-53 - 0.5);
    };
    for (int depth = 0; depth < 2; ++depth) {
      parent = std::move(mesh);
      mesh = {};
      edge = number_edges(parent.opposite);
      make_children(level(), Connectivity::half_edges, mesh);
      for (std::size_t h = 0; h < level().items(); ++h) {
        if (!level().handled_by_item(h)) continue;
        const Vec3d middle = level().middle_of(h);
        mesh.positions[level().midpoint_of(h)] = middle + Vec3d{shift(), shift(), shift()};
      }
    }
  }
  DividedMidpoints level() const { return {{parent, edge, mesh}}; }
};

bool cross(const IndexedMesh& mesh, std::size_t s, std::size_t t) {
  const std::array<SphereId, 3> none{kNoSphere, kNoSphere, kNoSphere};
  std::array<Vec3d, 3> a, b;
  for (std::size_t k = 0; k < 3; ++k) {
    a[k] = mesh.positions[mesh.triangles[s][k]];
    b[k] = mesh.positions[mesh.triangles[t][k]];
  }
  return boxes_overlap(a.data(), b.data()) &&
         triangles_cross(a.data(), mesh.triangles[s].data(), none.data(), b.data(),
                         mesh.triangles[t].data(), none.data());
}

// The triangles of all patches with a corner v.
std::vector<std::size_t> triangles_of_fan(const DividedMidpoints& level, std::uint32_t v) {
  std::vector<std::size_t> found;
  for (std::size_t t = 0; t < level.patches(); ++t) {
    const Triangle corner = level.corners(t);
    if (corner[0] != v && corner[1] != v && corner[2] != v) continue;
    for (std::size_t k = 16 * t; k < 16 * t + 16; ++k) found.push_back(k);
  }
  return found;
}

TEST(FansOfDividedPatches, HaveNoCrossingsIfTheyAreStars) {
  std::size_t stars = 0, crossed = 0;
  for (const double size : {0.0, 0.05, 0.1, 0.2, 0.3}) {
    const DividedTwice divided(size);
    const DividedMidpoints level = divided.level();
    const PatchFans fans(level);
    ASSERT_EQ(level.corner_vertices(), divided.given);
    for (std::uint32_t v = 0; v < level.corner_vertices(); ++v) {
      const std::vector<std::size_t> fan = triangles_of_fan(level, v);
      bool any = false;
      for (std::size_t i = 0; i < fan.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) any = any || cross(divided.mesh, fan[i], fan[j]);
      }
      ASSERT_FALSE(any && fans.is_star(v)) << v << " thrown by " << size;
      stars += fans.is_star(v);
      crossed += any;
    }
  }
  EXPECT_GT(stars, 30u);
  EXPECT_GT(crossed, 30u);
}

constexpr Vec3d kFar{0.4, -0.3, 0.5};

// Midpoints that are put back change the fans of both patches that have them, and no others.
TEST(FansOfDividedPatches, AreRenewedPatchByPatch) {
  DividedTwice divided(0.05);
  const DividedMidpoints level = divided.level();
  const auto is_thrown = [&](std::size_t h) { return level.handled_by_item(h) && h % 16 == 0; };
  for (std::size_t h = 0; h < level.items(); ++h) {
    if (is_thrown(h)) divided.mesh.positions[level.midpoint_of(h)] = level.middle_of(h) + kFar;
  }
  PatchFans fans(level);
  std::vector<bool> was(level.corner_vertices());
  for (std::uint32_t v = 0; v < was.size(); ++v) was[v] = fans.is_star(v);
  std::size_t changed = 0;
  for (std::size_t h = 0; h < level.items(); ++h) {
    if (!is_thrown(h)) continue;
    divided.mesh.positions[level.midpoint_of(h)] = level.middle_of(h);
    for (const std::size_t patch : level.patches_at(h)) fans.renew(level, patch);
  }
  const PatchFans anew(level);
  for (std::uint32_t v = 0; v < was.size(); ++v) {
    ASSERT_EQ(fans.is_star(v), anew.is_star(v)) << v;
    changed += fans.is_star(v) != was[v];
  }
  EXPECT_GT(changed, 5u);
}

// The view of a patch has the triangles of the mesh, and vertices where edges were halved.
TEST(FansOfDividedPatches, HaveTheVerticesOfTheMesh) {
  const DividedTwice divided(0);
  const DividedMidpoints level = divided.level();
  for (std::size_t t = 0; t < level.patches(); ++t) {
    const auto v = level.vertices(t);
    for (std::size_t child = 0; child < 16; ++child) {
      const auto corner = DividedMidpoints::triangle(static_cast<int>(child));
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(v[static_cast<std::size_t>(corner[k])], divided.mesh.triangles[16 * t + child][k])
            << t << ' ' << child;
      }
    }
    for (std::size_t i = 0; i < v.size(); ++i) {
      ASSERT_EQ(level.before(v, i), divided.mesh.positions[v[i]]) << t << ' ' << i;
    }
  }
}

Vec3d at(double degrees, double radius) {
  const double angle = degrees * std::numbers::pi / 180;
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

// A winding stair of one patch around its first corner: all triangles and turns are positive, and
// the border runs around by 90 degrees more than `turns` times 360.
bool is_star_of_stair(double turns) {
  const auto row = [&](int k, double part) {  // `part` from 0 to 1 along row k from the corner
    const double spread[] = {0, 170, 300, 390, 450};
    const double all = turns > 0 ? spread[k] : 90;
    const double middle = turns > 0 ? 215 : 35;
    return at(middle + all * (part - 0.5), std::pow(6.0, k));
  };
  const Vec3d origin{0, 0, 0}, up{0, 0, 1};
  const TwiceDivided patch{at_corners(origin, row(4, 0), row(4, 1)),
                           at_corners(row(2, 0), row(4, 0.5), row(2, 1)),
                           at_corners(row(1, 0), row(4, 0.25), row(3, 1)),
                           at_corners(row(3, 0), row(4, 0.75), row(1, 1)),
                           at_corners(row(3, 1.0 / 3), row(3, 2.0 / 3), row(2, 0.5))};
  StarFans fans(3);
  fans.add({0, 1, 2}, judge_twice_divided(patch, at_corners(up, up, up)));
  return fans.is_star(0);
}

TEST(FansOfDividedPatches, AreNoStarsIfTheBorderOfOnePatchRunsAround) {
  EXPECT_TRUE(is_star_of_stair(0));
  EXPECT_FALSE(is_star_of_stair(1));
}

}  // namespace
}  // namespace vdwmesh
