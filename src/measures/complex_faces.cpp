// visit_by_triangulation(): the faces of the dual complex's edges.
//
// 1. inclusion_exclusion() has the exposed angle of an edge's circle and the area of its power
// face.
// 2. Each triangle of the complex adds a segment of its dual line to the faces of its three edges:
//    from the corner or the orthogonal centre on one side to that on the other. At a corner an arc
//    of each edge's circle begins or ends. These are the sums of arcs/cell_faces.hpp.
// 3. A ball gathers the faces of its edges, scaled back to Å.
#include "measures/complex_faces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "complex/dual_complex.hpp"
#include "complex/simplex_shape.hpp"
#include "measures/measures.hpp"

namespace vdwmesh {
namespace {

class ComplexFaces {
 public:
  ComplexFaces(const PowerTriangulation& triangulation, const DualComplex& complex)
      : t_(triangulation), k_(complex), segments_(k_.edges.size()), ends_(k_.edges.size()) {
    for (const DualTriangle& f : k_.triangles) add_triangle(f);
  }

  // The face of an edge, seen from its first ball, in Å.
  SharedFace face(std::size_t e, const EdgeCone& cone) const {
    const auto [a, b] = k_.edges[e].vertices;
    const EdgeShape shape = edge_shape(ball(a), ball(b));
    const Vec3d axis = axis_of(e, shape.length);
    const double unit = std::ldexp(1.0, t_.scale_exponent), squared = shape.squared_circle_radius;
    const Vec3d arc = cross(axis, ends_[e]);
    const Vec3d moment = segments_[e] + (squared / 3) * arc;
    return {.other = t_.ids[b],
            .other_radius = unit * ball(b).radius,
            .axis = axis,
            .plane = {1 / (unit * shape.length), unit * shape.height[0], unit * shape.height[1]},
            .angle = cone.angle,
            .arc = unit * arc,
            .area = unit * unit * cone.face,
            .moment = unit * unit * unit * moment};
  }

 private:
  const Sphere& ball(std::uint32_t i) const { return t_.balls[i]; }
  Vec3d between(std::uint32_t i, std::uint32_t j) const { return ball(j).center - ball(i).center; }
  Vec3d axis_of(std::size_t e, double length) const {
    const auto [a, b] = k_.edges[e].vertices;
    return (1 / length) * between(a, b);
  }

  // The end of a triangle's dual line on either side, from the centre of its first ball. Of two
  // common points `above` is on the side of cells[0].
  std::array<Vec3d, 2> ends_of(const DualTriangle& f) const {
    const auto [a, b, c] = f.vertices;
    CommonPoints corners{};
    if (f.exposed[0] || f.exposed[1]) corners = common_points(ball(a), ball(b), ball(c));
    const auto end = [&](std::size_t side, const Vec3d& corner) {
      if (f.exposed[side]) return corner;
      const auto& v = t_.cells[f.cells[side]];
      return between(a, v[0]) + orthogonal_center({ball(v[0]), ball(v[1]), ball(v[2]), ball(v[3])});
    };
    return {end(0, corners.above), end(1, corners.below)};
  }

  // The boundary of a face runs counter-clockwise about the axis from the edge's lower to its
  // higher ball. It has the triangle's third ball on its right, so it runs upwards, to side 0, if
  // the two balls and the third one are counter-clockwise from above: for all edges but that of
  // vertices 0 and 2.
  void add_triangle(const DualTriangle& f) {
    const std::array<Vec3d, 2> ends = ends_of(f);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t start = k == 1 ? 0 : 1, stop = 1 - start;
      const std::uint32_t e = f.edges[k], a = k_.edges[e].vertices[0], b = k_.edges[e].vertices[1];
      const Vec3d shift = between(a, f.vertices[0]);
      const Vec3d from = shift + ends[start], to = shift + ends[stop];
      const EdgeShape shape = edge_shape(ball(a), ball(b));
      const Vec3d axis = axis_of(e, shape.length);
      const double twice = dot(axis, cross(from, to));
      segments_[e] = segments_[e] + (twice / 6) * (from + to - (2 * shape.height[0]) * axis);
      if (f.exposed[stop]) ends_[e] = ends_[e] + to;
      if (f.exposed[start]) ends_[e] = ends_[e] - from;
    }
  }

  const PowerTriangulation& t_;
  const DualComplex& k_;
  std::vector<Vec3d> segments_, ends_;  // by edge, from the centre of its first ball
};

// By ball of the triangulation: its faces, in the order of the edges. Balls that only touch share
// none.
std::vector<std::vector<SharedFace>> faces_by_ball(const PowerTriangulation& triangulation,
                                                   const DualComplex& complex,
                                                   const std::vector<EdgeCone>& cones) {
  const ComplexFaces faces(triangulation, complex);
  std::vector<std::vector<SharedFace>> by_ball(triangulation.balls.size());
  for (std::size_t e = 0; e < complex.edges.size(); ++e) {
    const auto [a, b] = complex.edges[e].vertices;
    const Sphere &first = triangulation.balls[a], &second = triangulation.balls[b];
    if (complex.edges[e].contact == Contact::touching ||
        edge_shape(first, second).squared_circle_radius == 0) {
      continue;
    }
    const SharedFace face = faces.face(e, cones[e]);
    by_ball[a].push_back(face);
    by_ball[b].push_back(seen_from_other(face, triangulation.ids[a],
                                         std::ldexp(first.radius, triangulation.scale_exponent)));
  }
  return by_ball;
}

}  // namespace

void visit_by_triangulation(std::span<const SphereId> wanted, std::vector<NumberedBall> near,
                            std::span<SphereMeasures> per_sphere, FaceVisitor& visitor) {
  std::vector<SphereId> sorted(wanted.begin(), wanted.end());
  std::ranges::sort(sorted);
  std::ranges::sort(near, {}, &NumberedBall::id);
  const auto repeated = std::ranges::unique(near, {}, &NumberedBall::id);
  near.erase(repeated.begin(), repeated.end());
  std::vector<Sphere> balls;
  for (const NumberedBall& n : near) balls.push_back(n.ball);
  PowerTriangulation triangulation = triangulate(SphereSet(std::move(balls)));
  for (SphereId& id : triangulation.ids) id = near[id].id;
  const DualComplex complex = dual_complex(triangulation);
  std::vector<EdgeCone> cones;
  const std::vector<SphereMeasures> measures = inclusion_exclusion(triangulation, complex, cones);
  const auto faces = faces_by_ball(triangulation, complex, cones);
  for (const SphereId id : wanted) per_sphere[id] = {0, 0};  // if a concentric ball covers it
  for (std::size_t i = 0; i < measures.size(); ++i) {
    const SphereId id = triangulation.ids[i];
    if (!std::ranges::binary_search(sorted, id)) continue;
    per_sphere[id] = {std::ldexp(measures[i].area, 2 * triangulation.scale_exponent),
                      std::ldexp(measures[i].volume, 3 * triangulation.scale_exponent)};
    const auto place = std::ranges::lower_bound(near, id, {}, &NumberedBall::id);
    visitor.visit(id, place->ball, per_sphere[id].area, faces[i]);
  }
}

}  // namespace vdwmesh
