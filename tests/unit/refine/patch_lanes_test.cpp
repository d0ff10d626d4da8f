// The tests of four triangles at a time, and of the boxes of four parts, against the same pair by
// pair: boxes alike, and no pair left out that triangles_cross() finds.
#include "refine/crossings/patch_lanes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "core/order/split_mix.hpp"
#include "refine/crossings/crossing_formulas.hpp"
#include "refine/crossings/part_boxes.hpp"

namespace vdwmesh {
namespace {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : state_(seed) {}
  std::uint64_t below(std::uint64_t count) { return split_mix(state_++) % count; }

 private:
  std::uint64_t state_;
};

// Few places, so that triangles share vertices and edges, lie in one plane, touch, and are flat;
// the second scale adds digits, so that sides are rounded.
struct Points {
  std::vector<Vec3d> position;
  std::vector<SphereId> atom;
};
Points points_of(double scale, Draw& draw) {
  Points points;
  for (int i = 0; i < 12; ++i) {
    const auto coordinate = [&] { return scale * static_cast<double>(draw.below(5)); };
    points.position.push_back({coordinate(), coordinate(), coordinate()});
    points.atom.push_back(draw.below(4) == 0 ? kNoSphere : static_cast<SphereId>(draw.below(2)));
  }
  return points;
}

struct SetOfFour {
  PatchLanes lanes;
  std::vector<PatchTriangle> triangles;
  std::vector<std::array<SphereId, 3>> atoms;
};
SetOfFour patch_of(std::size_t count, const Points& points, Draw& draw) {
  SetOfFour patch;
  for (std::size_t t = 0; t < count; ++t) {
    PatchTriangle triangle{};
    std::array<SphereId, 3> atoms{};
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.vertex[k] = static_cast<std::uint32_t>(draw.below(points.position.size()));
      triangle.corner[k] = points.position[triangle.vertex[k]];
      atoms[k] = points.atom[triangle.vertex[k]];
    }
    triangle.atom = atoms[0] == atoms[1] && atoms[0] == atoms[2] ? atoms[0] : kNoSphere;
    patch.lanes.set(t, triangle);
    patch.triangles.push_back(triangle);
    patch.atoms.push_back(atoms);
  }
  patch.lanes.complete(count);
  return patch;
}

TEST(PatchLanes, LeavesOutNoPairThatCrosses) {
  Draw draw(1);
  int crossing = 0, left_out = 0;
  for (int round = 0; round < 20000; ++round) {
    const Points points = points_of(round % 2 == 0 ? 1 : 0.1, draw);
    const std::size_t sizes[2] = {1 + draw.below(4), 1 + draw.below(4)};
    const SetOfFour a = patch_of(sizes[0], points, draw), b = patch_of(sizes[1], points, draw);
    for (std::size_t i = 0; i < sizes[0]; ++i) {
      const PatchTriangle& s = a.triangles[i];
      const std::uint32_t boxes = b.lanes.overlapping(a.lanes, i);
      const std::uint32_t left = b.lanes.may_cross(a.lanes, i);
      ASSERT_EQ(boxes >> sizes[1], 0u);
      for (std::size_t j = 0; j < sizes[1]; ++j) {
        const PatchTriangle& t = b.triangles[j];
        const bool overlap = boxes_overlap(s.corner.data(), t.corner.data()) != 0;
        ASSERT_EQ((boxes >> j & 1) != 0, overlap);
        const bool cross =
            overlap && triangles_cross(s.corner.data(), s.vertex.data(), a.atoms[i].data(),
                                       t.corner.data(), t.vertex.data(), b.atoms[j].data()) != 0;
        ASSERT_LE(cross, (left >> j & 1) != 0) << round << ' ' << i << ' ' << j;
        crossing += cross;
        left_out += overlap && (left >> j & 1) == 0;
      }
    }
  }
  EXPECT_GT(crossing, 1000);
  EXPECT_GT(left_out, 1000) << "the tests leave out nothing";
}

// Sides of few values, so that boxes touch, lie within each other and are flat.
PartBoxes boxes_of(Draw& draw) {
  PartBoxes boxes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t part = 0; part < 4; ++part) {
      boxes.lower[axis][part] = static_cast<float>(draw.below(6));
      boxes.upper[axis][part] = boxes.lower[axis][part] + static_cast<float>(draw.below(4));
    }
  }
  return boxes;
}

TEST(PartBoxes, OverlapAsOneByOne) {
  Draw draw(3);
  for (int turn = 0; turn < 200; ++turn) {
    const PartBoxes own = boxes_of(draw), other = boxes_of(draw);
    std::uint32_t expected = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b < 4; ++b) {
        bool meet = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          meet = meet && own.lower[axis][a] <= other.upper[axis][b] &&
                 other.lower[axis][b] <= own.upper[axis][a];
        }
        expected |= (meet ? 1u : 0u) << (4 * a + b);
      }
    }
    ASSERT_EQ(own.overlapping(other), expected) << turn;
  }
}

}  // namespace
}  // namespace vdwmesh
