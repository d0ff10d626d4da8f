// Decides whether a block of 2^level bricks along each axis can hold surface, from bounds on the
// field over the block's box. The brick search descends an octree of such blocks. It drops a block
// if the bounds prove that no surface crosses it: that the field is below the isovalue at all of
// its nodes, or that it is at or above the isovalue at all of them. The test is one-sided. Loose
// bounds keep blocks without surface, which only costs time; wrong bounds would lose surface.
//
// For the union of balls, a block is outside if no ball touches its box, and inside if one ball
// holds all of it. For blended fields, FieldBounds bounds the sum over the atoms from below and
// above. The CPU evaluates the bounds in double, the device in float32
// (cuda/extract/bricks/brick_search.cu). Host and device.
#pragma once

#include "core/host_device.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/field_kinds.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// The lattice indices first .. last, along each axis, of the nodes that the cells of a block touch.
// The block has 2^level bricks along each axis.
struct LatticeBlock {
  std::int64_t first[3], last[3];
  int level;
};

// `index` counts blocks of that level, so at level 0 it is the index of a brick.
VDWMESH_HD inline LatticeBlock lattice_block(const BrickIndex& index, int level) {
  const std::int32_t b[3] = {index.x, index.y, index.z};
  LatticeBlock block{};
  block.level = level;
  const std::int64_t side = static_cast<std::int64_t>(kBrickSide) << level;
  for (int axis = 0; axis < 3; ++axis) {
    block.first[axis] = b[axis] * side;
    block.last[axis] = block.first[axis] + side;
  }
  return block;
}

// The box around those nodes of a block that belong to the grid.
struct BlockBox {
  Vec3d lower, upper;   // Å
  bool empty;           // no node of the block belongs to the grid
  bool touches_border;  // some nodes of the block are virtual, hence outside
};

VDWMESH_HD inline BlockBox block_box(const GridSpec& grid, const LatticeBlock& block) {
  BlockBox box{{0, 0, 0}, {0, 0, 0}, false, false};
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t first = block.first[axis], last = block.last[axis];
    if (first < 1 || last > grid.cells[axis] + 1) box.touches_border = true;
    if (first < 1) first = 1;
    if (last > grid.cells[axis] + 1) last = grid.cells[axis] + 1;
    if (first > last) box.empty = true;
    box.lower[axis] = lattice_coordinate(grid, axis, first);
    box.upper[axis] = lattice_coordinate(grid, axis, last);
  }
  return box;
}

struct SquareRange {
  double least, most;  // Å²
};

// The least and the largest squared distance from c to a point of the box. They are computed with
// the operations of squared_distance(). Rounding keeps the order of numbers, so each of these
// operations is monotone even when it rounds, and the bounds also hold for the rounded squared
// distances of the nodes.
VDWMESH_HD inline SquareRange square_range(const BlockBox& box, const Vec3d& c) {
  double near[3], far[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double a = box.lower[axis] - c[axis], b = box.upper[axis] - c[axis];
    const double outside = a > -b ? a : -b;
    near[axis] = outside > 0 ? outside : 0;
    far[axis] = -a > b ? -a : b;
  }
  return {std::fma(near[0], near[0], std::fma(near[1], near[1], near[2] * near[2])),
          std::fma(far[0], far[0], std::fma(far[1], far[1], far[2] * far[2]))};
}

// Union of balls: returns false if no ball touches the box, or if one ball holds all of it and no
// node of the block is virtual; then no surface crosses the block. visit_near(visit) calls
// visit(place) with the list place of each ball of some superset of the balls that touch the box,
// until visit() returns true.
template <class VisitNear>
VDWMESH_HD bool union_may_cross(const CellListView& list, const BlockBox& box,
                                VisitNear&& visit_near) {
  double largest = 0;
  for (int l = 0; l < list.level_count; ++l) {
    largest = list.levels[l].reach > largest ? list.levels[l].reach : largest;
  }
  // `largest` is at least the largest radius. A ball that holds the box is at least as wide as the
  // box. If no ball is that wide, none can hold it, and the first ball that touches the box decides
  // that the surface may cross.
  const bool coverable = box.upper.x - box.lower.x <= 2 * largest;
  bool touched = false, covered = false;
  visit_near([&](ListPlace place) {
    const Sphere& ball = list.spheres[place];
    const SquareRange d2 = square_range(box, ball.center);
    const double r2 = ball.radius * ball.radius;
    touched |= d2.least <= r2;
    covered |= d2.most <= r2;
    return covered || (touched && !coverable);
  });
  return touched && (!covered || box.touches_border);
}

VDWMESH_HD inline bool union_may_cross(const CellListView& list, const BlockBox& box) {
  return union_may_cross(list, box,
                         [&](auto&& visit) { visit_near_box(list, box.lower, box.upper, visit); });
}

// Whether the sub-grid of an atom has some of a block's nodes (`meets`), and whether it has all of
// them (`holds`). For fields without sub-grids both are true.
struct SubgridOverlap {
  bool meets, holds;
};

VDWMESH_HD inline SubgridOverlap subgrid_overlap(const FieldModel& m, const LatticeBlock& block,
                                                 const Vec3d& c) {
  SubgridOverlap o{true, true};
  if (m.truncation != Truncation::subgrid) return o;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t cell = subgrid_cell(m.grid, axis, c[axis]);
    // The sub-grid has the nodes cell - n .. cell + n; lattice indices are larger by 1.
    const std::int64_t low = cell - m.subgrid_cells + 1, high = cell + m.subgrid_cells + 1;
    if (block.last[axis] < low || block.first[axis] > high) o.meets = false;
    if (block.first[axis] < low || block.last[axis] > high) o.holds = false;
  }
  return o;
}

// Bounds on a blended field over a box: sums, over the atoms near the box, of bounds on what each
// atom contributes. There are two pairs of a lower and an upper bound. lower() returns the larger
// of the two lower bounds, and upper() the smaller of the two upper ones.
//
// 1. An atom's contribution f falls with d^2. So f at the point of the box nearest to the atom
//    bounds it from above (`most`), and f at the farthest point from below (`least`).
//
// 2. If f as a function of d^2 is convex, it lies above its tangent at the middle of the box and
//    below its chord between the nearest and the farthest point. Write m for the vector from the
//    atom to the middle of the box, y for the vector from the middle to a point of the box, and
//    half for the vector from the middle to the box's upper corner. Then
//
//   d^2 = |m|^2 + 2 m y + |y|^2   with   0 <= |y|^2 <= |half|^2.
//
// Tangent and chord are linear in d^2 with a slope of at most 0. So the chord does not get smaller
// if |y|^2 is replaced by 0, nor the tangent larger if |y|^2 is replaced by |half|^2. Both remain
// bounds and are linear in y. Their sums over the atoms (`chords`, `tangents`, with their
// gradients) are linear in y too, and have their extremes at corners of the box. The error of this
// pair falls with the square of the box's size, and the error of the first pair with the size.
//
// The bounds must hold for the float32 values at the nodes, not for the exact field alone. An
// atom's float32 value at a node has three errors:
// - It errs by some units of its own size, 2^-24 relative. kMargin covers them.
// - Near the end of the window, the root u = 1 - k q is a difference of two numbers near 1. It errs
//   by up to e = 4e-7, however small u is. Therefore the squares of the nearest and the farthest
//   distance are made smaller and larger by their share kWiden = 1/512. With k q near 1 this moves
//   u by about 1/512 = 2e-3, much more than e, so f at the widened distances bounds the float32
//   value. It also makes kMargin sufficient for the second pair: margin() takes a share of `most`,
//   in which u is larger by 2e-3, and 1e-3 (u + 2e-3)^2 > 2 u e + e^2, the error of u^2, for every
//   u >= 0.
// - Some kinds have an absolute error too, absolute_rounding(). It is added to each atom's upper
//   bounds and subtracted from its lower bounds.
// The sum over n atoms adds an error of up to n units of 2^-24, both in the values at the nodes
// and, if T is float, in the sums here; margin() covers it.
template <class T>
struct FieldBounds {
  T least = 0, most = 0;                         // sums of f at the farthest and nearest points
  T tangents = 0, chords = 0;                    // sums of tangents and chords at y = 0
  T tangent_slope[3] = {}, chord_slope[3] = {};  // the gradients of these sums in y, 1/Å
  T atoms = 0;                                   // how many atoms were added

  // Adds an atom. `m` leads from the atom to the middle of the box and `half` is half the box's
  // size along each axis, both in Å. `scale` is inverse_square_scale() of the atom, and `overlap`
  // is subgrid_overlap() of the atom and the block.
  template <BlendedKind Kind>
  VDWMESH_HD void add(const ShapeParameters<T>& shape, T scale, const T (&m)[3], const T (&half)[3],
                      const SubgridOverlap& overlap) {
    if (!overlap.meets) return;
    // Squares: nearest, middle and farthest distance, and |half|.
    T near = 0, middle = 0, far = 0, extent = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const T away = m[axis] < 0 ? -m[axis] : m[axis];
      // The gap between atom and box is away - half. If it is much smaller than these two numbers,
      // cancellation leaves few correct digits. So the box is widened by four units of float32 in
      // the sum of both, more than the difference can err by. `reach` is half the widened box.
      const T error_bound = kUnit * (away + half[axis]), reach = half[axis] + error_bound;
      const T gap = away > reach ? away - reach : T(0);
      near = std::fma(gap, gap, near);
      middle = std::fma(away, away, middle);
      far = std::fma(away + reach, away + reach, far);
      extent = std::fma(half[axis], half[axis], extent);
    }
    near *= 1 - kWiden;
    far *= 1 + kWiden;
    const T at_near = Kind::value(shape, near, scale);
    const T at_far = Kind::value(shape, far, scale);
    const T rounding = at_near > 0 ? Kind::absolute_rounding(shape) : T(0);
    // Over a short interval, the slope of the chord would consist of rounding errors. If there is
    // no usable chord, its slope is 0 here: `chords` then gets at_near, the bound of the first
    // pair.
    const bool convex = Kind::is_convex_beyond(shape, near) && far - near > kShort * far;
    const T chord = convex ? (at_far - at_near) / (far - near) : T(0);
    atoms += 1;
    most += at_near + rounding;
    chords += std::fma(chord, middle - near, at_near) + rounding;
    for (int axis = 0; axis < 3; ++axis) {
      chord_slope[axis] = std::fma(2 * chord, m[axis], chord_slope[axis]);
    }
    // Some nodes lie outside the sub-grid, and f is 0 there. So the lower bounds of both pairs are
    // 0, less the rounding error, which may have either sign at the other nodes.
    if (!overlap.holds) {
      least -= rounding;
      tangents -= rounding;
      return;
    }
    least += at_far - rounding;
    if (!convex) {
      tangents += at_far - rounding;
      return;
    }
    const ValueAndSlope<T> f = Kind::value_and_slope(shape, middle, scale);
    tangents += std::fma(f.slope, extent, f.value) - rounding;
    for (int axis = 0; axis < 3; ++axis) {
      tangent_slope[axis] = std::fma(2 * f.slope, m[axis], tangent_slope[axis]);
    }
  }

  // Bounds on the float32 values of all nodes in the box. Precondition: all atoms near the box have
  // been added. A linear function over a box has its extremes at corners, where it differs from its
  // value in the middle by |slope| * half along each axis.
  VDWMESH_HD T lower(const T (&half)[3]) const {
    T bound = tangents;
    for (int axis = 0; axis < 3; ++axis) bound -= half[axis] * std::fabs(tangent_slope[axis]);
    return (bound > least ? bound : least) - margin();
  }
  VDWMESH_HD T upper(const T (&half)[3]) const {
    T bound = chords;
    for (int axis = 0; axis < 3; ++axis) bound += half[axis] * std::fabs(chord_slope[axis]);
    return (bound < most ? bound : most) + margin();
  }

 private:
  VDWMESH_HD T margin() const { return (kMargin + kUnit * atoms) * most; }

  // Relative margin for the error of an atom's float32 value. The largest such error is Blinn's:
  // some 1300 units of 2^-24, or 8e-5, for the largest steepness allowed, B = 50, at the end of the
  // window, q = 6.25 (tests/unit/extract/node_terms_test.cpp).
  static constexpr T kMargin = T(1e-3);
  static constexpr T kUnit = T(4) / (1 << 23);  // four units in the last place of float32
  static constexpr T kWiden = T(1) / (1 << 9);  // the share by which each d^2 is moved outwards
  // An interval near .. far is short if it is at most this share of far. Widening alone makes every
  // interval about 2 kWiden = 1/256 of d^2 long; kShort is twice that.
  static constexpr T kShort = T(1) / (1 << 7);
};

// Middle and half sizes of a box, Å.
template <class T>
struct BoxFrame {
  Vec3d middle;
  T half[3];
};

template <class T>
VDWMESH_HD inline BoxFrame<T> box_frame(const Vec3d& lower, const Vec3d& upper) {
  BoxFrame<T> f{};
  for (int axis = 0; axis < 3; ++axis) {
    f.middle[axis] = 0.5 * (lower[axis] + upper[axis]);
    f.half[axis] = static_cast<T>(0.5 * (upper[axis] - lower[axis]));
  }
  return f;
}

// Blended fields: returns false if the bounds prove that no node of the block is inside, or that
// all nodes are inside and none is virtual.
template <BlendedKind Kind>
VDWMESH_HD bool field_may_cross(const CellListView& list, const FieldModel& m,
                                const LatticeBlock& block, const BlockBox& box) {
  const ShapeParameters<double> shape = shape_parameters<double>(m);
  const BoxFrame<double> frame = box_frame<double>(box.lower, box.upper);
  FieldBounds<double> bounds;
  const bool stopped_early = visit_near_box(list, box.lower, box.upper, [&](ListPlace place) {
    const Sphere& ball = list.spheres[place];
    const Vec3d from = frame.middle - ball.center;
    const double to_middle[3] = {from.x, from.y, from.z};
    bounds.add<Kind>(shape, inverse_square_scale(m, ball.radius), to_middle, frame.half,
                     subgrid_overlap(m, block, ball.center));
    // Early exit for large blocks. `most` only grows, and as soon as it is at or above the
    // isovalue, the block most likely holds surface; visiting its many other atoms would be
    // expensive. The block is kept and its children are tested. If `least` is above 0, some
    // atom contributes everywhere in the block: the visit goes on, because the block may prove to
    // be inside. Blocks of levels 0 to 2 have few atoms and always visit all of them.
    return block.level > 2 && bounds.most >= m.isovalue && bounds.least <= 0;
  });
  // After an early exit the sums lack atoms, so upper() is no bound.
  if (stopped_early) return true;
  return bounds.upper(frame.half) >= m.isovalue &&
         (bounds.lower(frame.half) < m.isovalue || box.touches_border);
}

// Whether a block may hold surface. The test is one-sided: false only if the block holds none, but
// true also for some blocks without surface.
VDWMESH_HD inline bool may_hold_surface(const CellListView& list, const FieldModel& m,
                                        const LatticeBlock& block) {
  const BlockBox box = block_box(m.grid, block);
  if (box.empty) return false;
  if (m.kind == FieldKind::vdw) return union_may_cross(list, box);
  return with_blended(m.kind,
                      [&]<class Kind>(Kind) { return field_may_cross<Kind>(list, m, block, box); });
}

}  // namespace vdwmesh
