// Whether a block of lattice nodes can hold surface, from bounds on the field. Host and device.
#pragma once

#include "core/host_device.hpp"
#include "extract/blended/field_formulas.hpp"
#include "extract/bricks/brick.hpp"
#include "extract/field_kinds.hpp"
#include "spheres/cell_list.hpp"

namespace vdwmesh {

// Lattice nodes [first, last] along each axis of a block of 2^level bricks, both ends included.
struct LatticeBlock {
  std::int64_t first[3], last[3];
  int level;
};

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

// The box of a block's grid nodes; empty where the block has none.
struct BlockBox {
  Vec3d lower, upper;
  bool empty;
  bool touches_border;  // some nodes are virtual
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
  double least, most;
};

// Squared distances from c to the points of the box. Rounded like squared_distance(), which is
// monotone in each difference, so the bounds hold for the rounded distances of the nodes too.
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

// Union of balls: no ball touches the box, or one ball holds all of it -> no surface.
// visit_near(visit) calls visit(place) for any superset of the balls that touch the box, until it
// returns true.
template <class VisitNear>
VDWMESH_HD bool union_may_cross(const CellListView& list, const BlockBox& box,
                                VisitNear&& visit_near) {
  double largest = 0;
  for (int l = 0; l < list.level_count; ++l) {
    largest = list.levels[l].reach > largest ? list.levels[l].reach : largest;
  }
  const bool coverable = box.upper.x - box.lower.x <= 2 * largest;
  bool touched = false, covered = false;
  visit_near([&](std::uint32_t place) {
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

// Sub-grid against a block: whether the atom's box meets the block, and whether it holds it.
struct SubgridOverlap {
  bool meets, holds;
};

VDWMESH_HD inline SubgridOverlap subgrid_overlap(const FieldModel& m, const LatticeBlock& block,
                                                 const Vec3d& c) {
  SubgridOverlap o{true, true};
  if (m.truncation != Truncation::subgrid) return o;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t cell = subgrid_cell(m.grid, axis, c[axis]);
    const std::int64_t low = cell - m.subgrid_cells + 1, high = cell + m.subgrid_cells + 1;
    if (block.last[axis] < low || block.first[axis] > high) o.meets = false;
    if (block.first[axis] < low || block.last[axis] > high) o.holds = false;
  }
  return o;
}

// Bounds on a blended field over a box. Every f falls with d^2, so its values at the nearest and
// the farthest point bound it; and where its kind says that it is convex in d^2 (a product of
// falling convex functions is), it lies above its tangent at the middle of the box and below its
// chord. With d^2 = |m|^2 + 2 m (x - middle) + |x - middle|^2, where m leads from
// the atom to the middle, the sums of tangents and of chords are linear in x but for a term that
// is at most 0 and at least slope * |half|^2: second order in the size of the box.
//
// The bounds must hold for the float32 values of the nodes, not for the field alone. An atom's
// value at a node errs in three ways.
// - By a few units of its own size. kMargin covers them.
// - Where the window ends, its square root is a difference of numbers about 1 and errs by up to
//   4e-7, whatever is left of it. So the nearest and the farthest point are taken nearer and
//   farther by kWiden of d^2: that moves the root there by at least 4e-4, and the margin of the
//   value found exceeds the square of the error.
// - By what the kind names as its absolute rounding, above or below.
// The sum over n atoms errs by n units more, at the nodes and, with T = float, here.
template <class T>
struct FieldBounds {
  T least = 0, most = 0;                         // sums of values
  T tangents = 0, chords = 0;                    // sums at the middle
  T tangent_slope[3] = {}, chord_slope[3] = {};  // 1/Å
  T atoms = 0;

  // An atom whose box `overlap`s that of the nodes; `m` leads from it to the middle, Å.
  template <BlendedKind Kind>
  VDWMESH_HD void add(const ShapeParameters<T>& shape, T scale, const T (&m)[3], const T (&half)[3],
                      const SubgridOverlap& overlap) {
    if (!overlap.meets) return;
    T near = 0, middle = 0, far = 0, extent = 0;  // squares
    for (int axis = 0; axis < 3; ++axis) {
      const T away = m[axis] < 0 ? -m[axis] : m[axis];
      // A gap much smaller than the block is a difference that has lost its digits.
      const T doubt = kUnit * (away + half[axis]), reach = half[axis] + doubt;
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
    // The slope of a chord over a short interval would be that of its rounding.
    const bool convex = Kind::is_convex_beyond(shape, near) && far - near > kShort * far;
    const T chord = convex ? (at_far - at_near) / (far - near) : T(0);
    atoms += 1;
    most += at_near + rounding;
    chords += std::fma(chord, middle - near, at_near) + rounding;
    for (int axis = 0; axis < 3; ++axis) {
      chord_slope[axis] = std::fma(2 * chord, m[axis], chord_slope[axis]);
    }
    if (!overlap.holds) {
      // Its rounding alone can make it less than 0.
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

  // What no node of the box is below, or above, once all atoms near it have been added.
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

  static constexpr T kMargin = T(1e-3);
  static constexpr T kUnit = T(4) / (1 << 23);  // four units of float32
  static constexpr T kWiden = T(1) / (1 << 9);  // of d^2
  static constexpr T kShort = T(1) / (1 << 7);  // of d^2; more than 2 kWiden
};

// Middle and half sizes of a box.
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

template <BlendedKind Kind>
VDWMESH_HD bool field_may_cross(const CellListView& list, const FieldModel& m,
                                const LatticeBlock& block, const BlockBox& box) {
  const ShapeParameters<double> shape = shape_parameters<double>(m);
  const BoxFrame<double> frame = box_frame<double>(box.lower, box.upper);
  FieldBounds<double> bounds;
  const bool settled = visit_near_box(list, box.lower, box.upper, [&](std::uint32_t place) {
    const Sphere& ball = list.spheres[place];
    const Vec3d from = frame.middle - ball.center;
    const double to_middle[3] = {from.x, from.y, from.z};
    bounds.add<Kind>(shape, inverse_square_scale(m, ball.radius), to_middle, frame.half,
                     subgrid_overlap(m, block, ball.center));
    // A large block most likely holds surface as soon as these sums admit it, and costs many atoms
    // to know better: its children are asked instead.
    return block.level > 2 && bounds.most >= m.isovalue && bounds.least <= 0;
  });
  // The sums are then of some atoms only, and a bound from above that lacks an atom is none.
  if (settled) return true;
  return bounds.upper(frame.half) >= m.isovalue &&
         (bounds.lower(frame.half) < m.isovalue || box.touches_border);
}

VDWMESH_HD inline bool may_hold_surface(const CellListView& list, const FieldModel& m,
                                        const LatticeBlock& block) {
  const BlockBox box = block_box(m.grid, block);
  if (box.empty) return false;
  if (m.kind == FieldKind::vdw) return union_may_cross(list, box);
  return with_blended(m.kind,
                      [&]<class Kind>(Kind) { return field_may_cross<Kind>(list, m, block, box); });
}

}  // namespace vdwmesh
