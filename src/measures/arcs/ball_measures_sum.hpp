// BallMeasurer::measure(). Included by ball_measures.hpp alone.
#pragma once

#include <bit>
#include <numbers>

#include "core/sum.hpp"
#include "measures/arcs/arguments.hpp"
#include "measures/arcs/ball_measures.hpp"

namespace vdwmesh::arcs {

inline constexpr double kPi = std::numbers::pi;

// Multiplies the product by a factor, and rescales it to size 1 before it can overflow or
// underflow.
inline void multiply(ComplexNumber& product, const ComplexNumber& factor) {
  product = product * factor;
  const double size = product.re * product.re + product.im * product.im;
  if (size > 1e100 || size < 1e-100) {
    const double scale = 1 / std::sqrt(size);
    product = {product.re * scale, product.im * scale};
  }
}

// The sum so far, modulo 2 pi, is in [pi, 2 pi) if the product's imaginary part is negative. Adding
// an angle of at most pi takes it from there to [0, pi) if and only if it completes a turn.
inline void AngleSum::add(const ComplexNumber& factor) {
  const bool was_below = product_.im < 0;
  multiply(product_, factor);
  turns_ += was_below && !(product_.im < 0);
}

inline BallMeasures BallMeasurer::measure(const CellView& cell) {
  doubts_ = cell.doubts;
  has_faces_ = is_closed_ = false;
  // Without a plane nothing was cut off the ball, and without a vertex nothing is left of it.
  if (cell.empty()) return {0, 0, doubts_, 0, 0};
  if (cell.plane_count == kWalls) return {4 * kPi, 4 * kPi / 3, doubts_, 2, 0};
  ++stamp_;
  if (faces_.size() < cell.plane_count) {
    faces_.resize(2 * cell.plane_count);
    stamps_.resize(faces_.size());
    planes_.resize(faces_.size() + 1);  // one is written but not kept
  }
  is_closed_ = find_inside(cell);
  // A simple polytope has two more faces than half its vertices.
  if (!find_faces(cell)) doubts_ |= kDamaged;
  find_edges(cell);
  find_feet(cell);
  return is_closed_ ? measure_polytope(cell) : measure_patch(cell);
}

// Finds which vertices are inside the ball, and returns whether all are. If a vertex nearly lies on
// the sphere, three circles nearly meet in one point, which is a doubt.
inline bool BallMeasurer::find_inside(const CellView& cell) {
  const std::uint32_t count = cell.vertex_count;
  if (height_.size() < count + kLanes) height_.resize(2 * (count + kLanes));
  const Lanes one = all_lanes(1);
  LaneBits inside{}, near{};
  for (std::size_t i = 0; i < count; i += kLanes) {  // NaN behind the last
    const Lanes x = lanes_at(cell.x + i), y = lanes_at(cell.y + i), z = lanes_at(cell.z + i);
    const Lanes height = x * x + y * y + z * z - one, size = height < 0 ? -height : height;
    store_lanes(&height_[i], height);
    inside -= height < 0;  // -1 in each lane if so
    near |= size < 2 * kTouching;
  }
  if ((near[0] | near[1] | near[2] | near[3]) != 0) doubts_ |= kThirdCircle;
  inside_ = static_cast<std::uint32_t>(inside[0] + inside[1] + inside[2] + inside[3]);
  return inside_ == count;
}

// Lists the planes that have a face, without branches. Returns whether their number satisfies
// Euler's formula.
inline bool BallMeasurer::find_faces(const CellView& cell) {
  const std::uint32_t* const planes_left = cell.plane_left;
  std::uint64_t* const stamps = stamps_.data();
  const std::uint64_t stamp = stamp_;  // a copy that stays in a register: stores cannot change it
  for (std::uint32_t v = 0, count = cell.vertex_count; v < count; ++v) {
    for (std::uint32_t side = 1; side <= 3; ++side) stamps[planes_left[end_of(v, side)]] = stamp;
  }
  std::uint32_t* const planes = planes_.data();
  std::uint32_t found = 0;
  for (std::uint32_t plane = 0, count = cell.plane_count; plane < count; ++plane) {
    planes[found] = plane;
    found += stamps[plane] == stamp;
  }
  face_count_ = found;
  return 2 * found == cell.vertex_count + 4;
}

// Lists the edges, each once, by how many of their ends are inside the ball. There are no branches
// on these numbers, because the processor could not predict them.
inline void BallMeasurer::find_edges(const CellView& cell) {
  const std::uint32_t vertices = cell.vertex_count;
  if (edges_[0].size() < 3 * vertices) {
    for (std::vector<EdgeEnd>& list : edges_) list.resize(6 * vertices);
    patch_corners_.resize(12 * vertices);  // an edge has two corners at most
    corner_places_.resize(12 * vertices);
  }
  const EdgeEnd* const twins = cell.twin;
  EdgeEnd* const inner = edges_[2].data();
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    for (std::uint32_t side = 1; side <= 3; ++side) {
      const EdgeEnd end = end_of(v, side);
      inner[count] = end;
      count += end < twins[end];
    }
  }
  edge_count_ = {0, 0, count};
  if (inside_ == vertices) return;
  // Edges with both ends inside stay in the list `inner`. They move towards its front, never beyond
  // the element that is being read, so no unread element is overwritten.
  const double* const heights = height_.data();
  const auto is_inside = [&](std::uint32_t v) {  // the sign of the height, which is never -0
    return static_cast<std::size_t>(std::bit_cast<std::uint64_t>(heights[v]) >> 63);
  };
  EdgeEnd* const lists[3] = {edges_[0].data(), edges_[1].data(), inner};
  std::size_t counts[3] = {0, 0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    const EdgeEnd end = inner[i];
    const std::size_t ends_inside = is_inside(vertex_of(end)) + is_inside(vertex_of(twins[end]));
    lists[ends_inside][counts[ends_inside]++] = end;
  }
  edge_count_ = {counts[0], counts[1], counts[2]};
}

inline void BallMeasurer::find_feet(const CellView& cell) {
  if (feet_.size() < cell.plane_count) feet_.resize(2 * cell.plane_count);
  for (const std::uint32_t plane : planes()) {
    const Lanes p = lanes_at(&cell.plane[plane].axis.x);
    store_lanes(feet_[plane].at, all_lanes(p[3]) * __builtin_shufflevector(p, p, 2, 0, 1, 3));
  }
}

VDWMESH_INLINE BallMeasurer::EdgeIncidence BallMeasurer::edge_of(const CellView& cell,
                                                                 EdgeEnd end) {
  const EdgeEnd twin = cell.twin[end];
  return {vertex_of(end), vertex_of(twin), cell.plane_left[twin - 1], cell.plane_left[end - 1]};
}

// The cross product of two vectors in three lanes, in the order z, x, y.
VDWMESH_INLINE Lanes turned_cross(const Lanes& a, const Lanes& b) {
  return a * __builtin_shufflevector(b, b, 1, 2, 0, 3) -
         __builtin_shufflevector(a, a, 1, 2, 0, 3) * b;
}

VDWMESH_INLINE double sum_of(const Lanes& lanes) {
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

// For a cell inside the ball: its volume. Every edge adds six times the volume of two pyramids with
// the apex in the centre: their bases are the triangles between the edge and the foot of either
// face. A pyramid gives t times twice the area of its base. Edges run clockwise about a and
// counter-clockwise about b, seen from outside.
inline BallMeasures BallMeasurer::measure_polytope(const CellView& cell) {
  const Foot* const feet = feet_.data();
  Lanes sums{};
  for (const EdgeEnd end : edges(2)) {
    const auto [from, to, a, b] = edge_of(cell, end);
    sums += (lanes_at(feet[b].at) - lanes_at(feet[a].at)) *
            turned_cross(lanes_at(cell.position[from].at), lanes_at(cell.position[to].at));
  }
  const double sum = sum_of(sums);
  if (!(std::abs(sum) <= 6 * 4 * kPi)) doubts_ |= kNotFinite;
  return {0, sum / 6, doubts_, 0, 0};
}

inline BallMeasures BallMeasurer::measure_patch(const CellView& cell) {
  segments_ = corners_ = 0;
  worst_ = 1;
  turning_ = {};
  for (const std::uint32_t plane : planes()) faces_[plane] = {};
  add_inner_edges(cell);
  add_crossing_edges(cell);
  add_outer_edges(cell);
  return sum_up(cell);
}

// Begins the sums with the edges that are segments from end to end: add_segment() in lanes.
inline void BallMeasurer::add_inner_edges(const CellView& cell) {
  const Foot* const feet = feet_.data();
  Lanes pyramid{}, open{};
  for (const EdgeEnd end : edges(2)) {
    const auto [from, to, a, b] = edge_of(cell, end);
    const Lanes moment =
        turned_cross(lanes_at(cell.position[from].at), lanes_at(cell.position[to].at));
    pyramid += (lanes_at(feet[b].at) - lanes_at(feet[a].at)) * moment;
    const Vec3d turned{moment[1], moment[2], moment[0]};
    const Cap& p = cell.plane[a];
    const Cap& q = cell.plane[b];
    open += all_lanes(inner(q.axis, turned)) * lanes_at(&q.axis.x) -
            all_lanes(inner(p.axis, turned)) * lanes_at(&p.axis.x);
    faces_[a].crossed = faces_[b].crossed = true;
  }
  segments_ += static_cast<std::uint32_t>(edge_count_[2]);
  pyramid_ = sum_of(pyramid);
  open_ = {open[0], open[1], open[2]};
}

inline void BallMeasurer::add_crossing_edges(const CellView& cell) {
  for (const EdgeEnd end : edges(1)) {
    const auto [from, to, a, b] = edge_of(cell, end);
    add_edge(cell, {a, b, cell.vertex(from), cell.vertex(to), end}, 1, height_[from] < 0);
  }
}

// Adds the edges that enter the ball between their ends: their point nearest to the centre is
// between them, and nearer than 1. The margin leaves the last word to add_edge(); it is wider than
// the error of an edge in planes that are not nearly parallel.
inline void BallMeasurer::add_outer_edges(const CellView& cell) {
  constexpr double kMargin = 1e-3;
  for (const EdgeEnd end : edges(0)) {
    const auto [from, to, a, b] = edge_of(cell, end);
    const PolytopeEdge edge{a, b, cell.vertex(from), cell.vertex(to), end};
    const Vec3d along = edge.to - edge.from;
    const double start = inner(edge.from, along), stop = inner(edge.to, along);
    if (!(start < 0 && stop > 0)) continue;
    const double squared = inner(along, along);
    if (height_[from] * squared - start * start > kMargin * squared) continue;
    add_edge(cell, edge, 0, false);
  }
}

// How the circles of two caps lie to each other.
struct Crossing {
  Vec3d normal;         // axis × axis of the other cap
  double squared_sine;  // of the angle between the axes
  double toward;        // distance of the other plane from the disk's centre; < 0 if that is beyond
  double gram;          // Gram determinant of both axes and a corner: > 0 if the circles cross
  double turn_cosine;   // cosine of the turning angle at a corner, times both circles' radii
};

// Precondition: the circle of `cap` is the smaller one. With q = |b - a|² / 2 the cosine of the
// angle between axes a and b is 1 - q; if they point to opposite sides, -1 + q with q = |b + a|²
// / 2. So differences of numbers near 1 keep their digits: those of small circles, of circles about
// one axis, and of circles about opposite ones. Positions on the smaller circle keep them too,
// because they come from distances to its own centre.
VDWMESH_INLINE Crossing crossing_of(const Cap& cap, const Cap& other) {
  const double sign = inner(cap.axis, other.axis) < 0 ? -1 : 1;
  const Vec3d apart = other.axis - sign * cap.axis;
  const double q = 0.5 * inner(apart, apart);
  Crossing c;
  c.normal = cross(cap.axis, apart);
  c.squared_sine = inner(c.normal, c.normal);
  c.toward = (other.cosine - sign * cap.cosine) + sign * q * cap.cosine;
  c.gram = (1 - cap.cosine) * (1 + cap.cosine) * c.squared_sine - c.toward * c.toward;
  // cosine - t t' = sign ((1 - u) + u (1 - sign t' sgn(t)) - q) with u = |t|.
  const double u = std::abs(cap.cosine);
  const double facing = cap.cosine < 0 ? -sign * other.cosine : sign * other.cosine;
  c.turn_cosine = sign * (((1 - u) + u * (1 - facing)) - q);
  return c;
}

// Adds the segment of an edge inside the ball, and its corners, one or two. A point x of both
// planes and the sphere is middle ± (root / sine²) a × b with the axes a, b and the sine of the
// angle between them; root² is the Gram determinant of a, b and x. The edge runs against a × b.
inline void BallMeasurer::add_edge(const CellView& cell, const PolytopeEdge& edge, int ends_inside,
                                   bool from_inside) {
  const Cap& a = cell.plane[edge.a];
  const Cap& b = cell.plane[edge.b];
  const bool a_is_smaller = std::abs(a.cosine) >= std::abs(b.cosine);
  const Cap& small = a_is_smaller ? a : b;
  const Crossing c = crossing_of(small, a_is_smaller ? b : a);
  if (ends_inside == 0 && std::abs(c.gram) < kTouching * c.squared_sine) {
    doubts_ |= kIllConditioned;
  }
  if (c.squared_sine < kNearlyParallel) doubts_ |= kParallelPlanes;
  if (ends_inside == 0 && !(c.gram > 0)) return;
  const double root = std::sqrt(c.gram > 0 ? c.gram : 0), inverse = 1 / c.squared_sine;
  const double condition = 1 / root;  // infinite if the circles do not cross
  worst_ = condition > worst_ ? condition : worst_;
  const Vec3d middle =
      small.cosine * small.axis + (c.toward * inverse) * cross(c.normal, small.axis);
  const Vec3d half = (a_is_smaller ? root * inverse : -root * inverse) * c.normal;
  const ComplexNumber turn{c.turn_cosine, root};
  Vec3d from = edge.from, to = edge.to;
  if (!from_inside) {
    from = middle + half;
    add_corner(edge, a, b, from, 1);
    turning_.add(turn);
  }
  if (from_inside || ends_inside == 0) {
    to = middle - half;
    add_corner(edge, a, b, to, -1);
    turning_.add(turn);
  }
  add_segment(a, b, from, to);
  faces_[edge.a].crossed = faces_[edge.b].crossed = true;
  ++segments_;
}

// Adds the segment from p to q of an edge. It adds det(axis, p, q) to twice the area of face b and
// subtracts det(axis, p, q), with the axis of a, from twice the area of face a.
inline void BallMeasurer::add_segment(const Cap& a, const Cap& b, const Vec3d& from,
                                      const Vec3d& to) {
  const Vec3d moment = cross(from, to);
  const double of_a = -inner(a.axis, moment), of_b = inner(b.axis, moment);
  pyramid_ += a.cosine * of_a + b.cosine * of_b;
  open_ = open_ + of_a * a.axis + of_b * b.axis;
}

// Adds a corner. Direction 1: an arc of circle a starts there and one of b ends; -1: the other way
// round. To open_ a face adds 2 F axis, of which the sectors of its arcs are phi sine² axis; the
// patch adds the integral of x × dx along its boundary, which runs against the arcs: for each arc
// t axis × (start - end) - phi sine² axis. The terms with phi cancel.
inline void BallMeasurer::add_corner(const PolytopeEdge& edge, const Cap& a, const Cap& b,
                                     const Vec3d& corner, int direction) {
  const Vec3d arm = static_cast<double>(direction) * (a.cosine * a.axis - b.cosine * b.axis);
  open_ = open_ + cross(arm, corner);
  add_arc_end(faces_[edge.a], a, corner, -direction);
  add_arc_end(faces_[edge.b], b, corner, direction);
  corner_places_[corners_] = {corner.x, corner.y, corner.z, 0};
  patch_corners_[corners_++] = {edge.end, direction};
}

// Adds an arc's end (direction 1) or start (-1). Arcs run counter-clockwise about the axis. The
// product of all ends and conjugated starts, as complex numbers whose argument is the angle from
// the face's first corner, has the exposed angle of the circle as its argument. The size of such a
// number is the squared radius of the circle.
inline void BallMeasurer::add_arc_end(CellFace& face, const Cap& cap, const Vec3d& corner,
                                      int direction) {
  face.balance += direction;
  const Vec3d arm = corner - cap.cosine * cap.axis;
  if (face.ends++ == 0) {
    face.reference = arm;
    return;
  }
  const ComplexNumber place{inner(face.reference, arm),
                            direction * inner(cap.axis, cross(face.reference, arm))};
  multiply(face.arc, place);
}

// A face that no segment bounds has the whole disk of its plane, or nothing of it: the disk's
// centre decides. Walls have no disk.
inline bool BallMeasurer::is_whole_disk(const CellView& cell, std::uint32_t plane) {
  if (plane < kWalls) return false;
  const Cap& cap = cell.plane[plane];
  const Vec3d center = cap.cosine * cap.axis;
  for (const std::uint32_t other : planes()) {
    if (other == plane) continue;
    const Cap& wall = cell.plane[other];
    if (inner(wall.axis, center) > wall.cosine) return false;
  }
  return true;
}

// Fills angles_: the exposed angles of the circles with corners, in the order of the planes, and
// behind them the remainder of the sum of turning angles, without its whole turns.
inline void BallMeasurer::find_angles() {
  const std::size_t most = face_count_ + 1 + kLanes;
  if (angles_.size() < most) {
    for (std::vector<double>* v : {&angles_, &re_, &im_}) v->resize(2 * most);
  }
  std::size_t count = 0;
  for (const std::uint32_t plane : planes()) {
    const CellFace& face = faces_[plane];
    re_[count] = face.arc.re;
    im_[count] = face.arc.im;
    count += face.ends > 0;
  }
  re_[count] = turning_.product().re;
  im_[count] = turning_.product().im;
  for (std::size_t i = 0; i <= count; i += kLanes) {  // may compute unused elements at the end
    store_lanes(&angles_[i], arguments(lanes_at(&re_[i]), lanes_at(&im_[i])));
  }
}

inline BallMeasures BallMeasurer::sum_up(const CellView& cell) {
  find_angles();
  const double* next_angle = angles_.data();
  // The sum of phi t over circles with corners, and of phi (t - 1) over whole circles, whose 2 pi
  // go into `turns`. With thousands of caps both are far larger than the area that is left.
  WideSum bend;
  std::uint32_t disks = 0, whole_circles = 0;
  double deepest = 1;
  for (const std::uint32_t plane : planes()) {
    CellFace& face = faces_[plane];
    const Cap& cap = cell.plane[plane];
    double angle = 0;
    if (face.ends > 0) {
      angle = *next_angle++;
      if (!(angle >= kTinyAngle && angle <= 2 * kPi - kTinyAngle)) doubts_ |= kTinyArc;
      if (face.balance != 0) doubts_ |= kDamaged;
    } else if (!face.crossed) {
      if (!is_whole_disk(cell, plane)) continue;
      angle = 2 * kPi;
      face.whole = true;
      ++whole_circles;
    }
    face.angle = angle;
    ++disks;
    bend.add(face.ends > 0 ? angle * cap.cosine : angle * (cap.cosine - 1));
    pyramid_ += angle * cap.cosine * (1 - cap.cosine) * (1 + cap.cosine);
    deepest = cap.cosine < deepest ? cap.cosine : deepest;
  }
  // Every plane cuts the ball. If none has a face inside the ball, the cell lies outside of it.
  if (disks == 0) return {0, 0, doubts_, 0, 0};
  has_faces_ = true;
  const auto euler = static_cast<std::int32_t>(2 - inside_ + segments_ - disks);
  bend.add(-*next_angle);
  const double turns = euler + static_cast<double>(whole_circles) - turning_.turns();
  bend.add(2 * kPi * turns);
  const double area = bend.value();
  const double volume = (area + 0.5 * pyramid_) / 3;
  if (!(kRounding * worst_ <= kMaxError)) doubts_ |= kIllConditioned;
  if (!(inner(open_, open_) <= kMaxOpen * kMaxOpen)) doubts_ |= kOpenSurface;
  // The patch is the sphere less its caps, of which the largest has the area 2 pi (1 - deepest).
  const double most = 2 * kPi * (1 + deepest) + kMaxError;
  if (!(area >= -kMaxError && area <= most)) doubts_ |= kDamaged;
  if (!(std::abs(volume) <= 4 * kPi)) doubts_ |= kNotFinite;  // NaN too
  return {area, volume, doubts_, euler, corners_};
}

}  // namespace vdwmesh::arcs
