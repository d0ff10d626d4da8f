// Reads the faces that a ball shares with its neighbours from its power cell.
//
// A face is a polygon with arcs. From the circle's centre it falls into a triangle over each
// segment of its boundary and a sector over each arc. With the segment from p to q, counter-
// clockwise about the axis n, s = n · (p × q) is twice the area of the triangle, and s (p + q) / 6
// the integral over it of the place, from the ball's centre. The arm's integral along an arc is n ×
// (start - end). So one sum of s (p + q, 1) and one of starts less ends give all of a face.
#pragma once

#include <span>
#include <vector>

#include "measures/arcs/ball_caps.hpp"
#include "measures/arcs/cut_ball.hpp"
#include "measures/arcs/shared_face.hpp"

namespace vdwmesh::arcs {

// Keeps its memory from ball to ball.
class CellFaces {
 public:
  // The faces of the ball at a list place, which CutBall measured last, with the caps that it cut.
  // They mean nothing if the ball is in doubt. The span is valid until the next call.
  std::span<const SharedFace> read(const CellListView& list, ListPlace place, const BallCaps& caps,
                                   const CutBall& cut);

 private:
  void add_segment(const CellView& cell, std::uint32_t a, std::uint32_t b, const Lanes& from,
                   const Lanes& to);
  void add_inner_segments(const CellView& cell, const BallMeasurer& measurer);
  void add_corners(const CellView& cell, const BallMeasurer& measurer);
  void add_face(const CellListView& list, const Sphere& ball, ListPlace other, const Cap& cap,
                double angle, const Position& segments, const Position& ends);

  // By plane, valid for planes with a face, in units of the ball's radius: sums of s (p + q) with
  // that of s as the fourth number, and of starts less ends.
  std::vector<Position> segments_, ends_;
  std::vector<SharedFace> faces_;
  std::size_t count_ = 0;
};

VDWMESH_INLINE void CellFaces::add_segment(const CellView& cell, std::uint32_t a, std::uint32_t b,
                                           const Lanes& from, const Lanes& to) {
  const Lanes turned = turned_cross(from, to);
  const Vec3d moment{turned[1], turned[2], turned[0]};
  const Lanes both = (from + to) + Lanes{0, 0, 0, 1};
  // Edges run clockwise about a and counter-clockwise about b.
  double *const of_a = segments_[a].at, *const of_b = segments_[b].at;
  store_lanes(of_a, lanes_at(of_a) - all_lanes(inner(cell.plane[a].axis, moment)) * both);
  store_lanes(of_b, lanes_at(of_b) + all_lanes(inner(cell.plane[b].axis, moment)) * both);
}

// Edges that lie in the ball from end to end.
inline void CellFaces::add_inner_segments(const CellView& cell, const BallMeasurer& measurer) {
  for (const EdgeEnd end : measurer.inner_edges()) {
    const auto [from, to, a, b] = BallMeasurer::edge_of(cell, end);
    add_segment(cell, a, b, lanes_at(cell.position[from].at), lanes_at(cell.position[to].at));
  }
}

// Corners, and the segments that end there. An edge that leaves the ball at both ends has two
// corners, one behind the other; any other segment runs from a vertex inside or to one.
inline void CellFaces::add_corners(const CellView& cell, const BallMeasurer& measurer) {
  const auto corners = measurer.corners();
  const auto places = measurer.corner_places();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto& [edge, direction] = corners[i];
    const auto [from, to, a, b] = BallMeasurer::edge_of(cell, edge);
    const Lanes corner = lanes_at(places[i].at);
    const Lanes start = all_lanes(direction) * corner;
    store_lanes(ends_[a].at, lanes_at(ends_[a].at) + start);
    store_lanes(ends_[b].at, lanes_at(ends_[b].at) - start);
    const bool first_of_two =
        direction > 0 && i + 1 < corners.size() && corners[i + 1].edge == edge;
    const bool second_of_two = direction < 0 && i > 0 && corners[i - 1].edge == edge;
    if (second_of_two) continue;  // its segment was added with the first
    if (first_of_two) {
      add_segment(cell, a, b, corner, lanes_at(places[i + 1].at));
    } else if (direction > 0) {
      add_segment(cell, a, b, corner, lanes_at(cell.position[to].at));
    } else {
      add_segment(cell, a, b, lanes_at(cell.position[from].at), corner);
    }
  }
}

VDWMESH_INLINE void CellFaces::add_face(const CellListView& list, const Sphere& ball,
                                        ListPlace other, const Cap& cap, double angle,
                                        const Position& segments, const Position& ends) {
  const Sphere& neighbor = list.spheres[other];
  if (only_touch(ball, neighbor)) return;
  const double r = ball.radius, twice = segments.at[3],
               squared = (1 - cap.cosine) * (1 + cap.cosine);
  const Vec3d arc = cross(cap.axis, Vec3d{ends.at[0], ends.at[1], ends.at[2]}),
              both{segments.at[0], segments.at[1], segments.at[2]};
  const Vec3d moment =
      (1.0 / 6) * (both - (2 * cap.cosine * twice) * cap.axis) + (squared / 3) * arc;
  faces_[count_++] = {.other = list.id[other],
                      .other_radius = neighbor.radius,
                      .axis = cap.axis,
                      .plane = shared_plane(ball, neighbor, cap),
                      .angle = angle,
                      .arc = r * arc,
                      .area = 0.5 * (squared * angle + twice) * r * r,
                      .moment = (r * r * r) * moment};
}

VDWMESH_INLINE std::span<const SharedFace> CellFaces::read(const CellListView& list,
                                                           ListPlace place, const BallCaps& caps,
                                                           const CutBall& cut) {
  count_ = 0;
  const CellView& cell = cut.cell();
  const BallMeasurer& measurer = cut.measurer();
  const bool closed = measurer.is_closed();
  if (cell.empty() || cell.plane_count == kWalls || !(closed || measurer.has_faces())) return {};
  if (segments_.size() < cell.plane_count) {
    segments_.resize(2 * cell.plane_count);
    ends_.resize(2 * cell.plane_count);
    faces_.resize(2 * cell.plane_count);
  }
  for (const std::uint32_t plane : measurer.planes()) segments_[plane] = ends_[plane] = {};
  add_inner_segments(cell, measurer);
  if (!closed) add_corners(cell, measurer);
  for (const std::uint32_t plane : measurer.planes()) {
    if (plane < kWalls || !(closed || measurer.face(plane).meets_ball())) continue;
    const std::uint32_t cap = cut.has_equal_caps()
                                  ? caps.farthest_of_equal(list, place, cut.cap_of(plane))
                                  : cut.cap_of(plane);
    add_face(list, list.spheres[place], caps.neighbors()[cap], caps.caps()[cap],
             closed ? 0 : measurer.face(plane).angle, segments_[plane], ends_[plane]);
  }
  return {faces_.data(), count_};
}

}  // namespace vdwmesh::arcs
