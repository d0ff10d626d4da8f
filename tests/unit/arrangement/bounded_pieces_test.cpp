// Pieces inserted into a triangulation whose lists of edges have a fixed capacity, as on a device:
// either the triangulation is that of growing lists, or the insertion fails and says so.
#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "creases/plane/piece_insertion.hpp"
#include "creases/plane/plane_insertion.hpp"

namespace vdwmesh {
namespace {

using Outcome = PlaneTypes::Outcome;

// The ends of a piece, vertices 0 and 1, and points on both sides of it in turn, so that an edge
// between any two points one after the other crosses it.
std::vector<PlanePoint> zigzag(int between) {
  std::vector<PlanePoint> points{{-1, 0}, {static_cast<double>(between), 0}};
  for (int i = 0; i < between; ++i) {
    points.push_back(
        {i + 0.01 * (i % 5), i % 2 == 0 ? 0.8 + 0.03 * (i % 3) : -0.9 + 0.02 * (i % 4)});
  }
  return points;
}

// Inserts the points, and then the piece between vertices 0 and 1.
template <class Memory>
Outcome insert_zigzag(const std::vector<PlanePoint>& points, PlaneTriangulationOf<Memory>& plane) {
  plane.start(points, nullptr);
  std::uint32_t near = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const PlaneTypes::Location at = plane.locate(plane.point(i), near);
    plane.insert(i, at);
    near = plane.triangle_at(i);
  }
  EXPECT_FALSE(plane.has_failed());
  return plane.insert_piece(0, 1, 7);
}

// A triangulation with room for so many edges in each list of insert_piece(), and for as many
// points and triangles as there may be. An element behind each list shows whether it was written.
struct RoomForEdges {
  PatchFailure failure = PatchFailure::none;
  PlaneTriangulationOf<BoundedMemory> plane{BoundedMemory(&failure)};
  std::vector<std::shared_ptr<void>> arrays;
  std::vector<const PlaneTypes::ListedEdge*> guards;

  RoomForEdges(std::uint32_t edges, std::uint32_t others) {
    const auto place = [&](auto& array, PatchArray kind) {
      using Array = std::remove_reference_t<decltype(array)>;
      using T = typename Array::value_type;
      const std::uint32_t most = kind == PatchArray::insertions ? edges : others;
      const auto room = std::make_shared<std::vector<T>>(most + 1);
      array = Array(room->data(), most, &failure);
      if constexpr (std::is_same_v<T, PlaneTypes::ListedEdge>) {
        room->back() = kGuard;
        guards.push_back(&room->back());
      }
      arrays.push_back(room);
    };
    plane.visit_state(place);
    plane.visit_scratch(place);
  }

  bool is_whole() const {
    for (const PlaneTypes::ListedEdge* guard : guards) {
      if (guard->from != kGuard.from || guard->to != kGuard.to) return false;
    }
    return guards.size() == 2;  // crossed and flipped edges
  }
  static constexpr PlaneTypes::ListedEdge kGuard{123, 456, 789};
};

TEST(BoundedPieces, WithoutRoomForEdgesAPieceIsBlocked) {
  const std::vector<PlanePoint> points = zigzag(40);
  PlaneTriangulation growing;
  ASSERT_EQ(insert_zigzag(points, growing), Outcome::inserted);
  std::uint32_t least = 0;  // the room that suffices
  for (std::uint32_t edges = 0; least == 0 && edges < 1000; ++edges) {
    SCOPED_TRACE(edges);
    RoomForEdges bounded(edges, 1000);
    const Outcome outcome = insert_zigzag(points, bounded.plane);
    EXPECT_TRUE(bounded.is_whole());
    if (outcome == Outcome::inserted) {
      least = edges;
      EXPECT_EQ(bounded.failure, PatchFailure::none);
      ASSERT_EQ(bounded.plane.triangles().size(), growing.triangles().size());
      for (std::uint32_t t = 0; t < growing.triangles().size(); ++t) {
        EXPECT_EQ(bounded.plane.triangle(t).vertices, growing.triangle(t).vertices);
        EXPECT_EQ(bounded.plane.triangle(t).pieces, growing.triangle(t).pieces);
      }
    } else {
      EXPECT_EQ(outcome, Outcome::blocked);
      EXPECT_EQ(bounded.failure, PatchFailure::no_room);
    }
  }
  // The piece crosses an edge between any two of the 40 points one after the other.
  EXPECT_GE(least, 39u);
}

}  // namespace
}  // namespace vdwmesh
