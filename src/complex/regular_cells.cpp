// regular_cells(): incremental insertion into a regular triangulation (Bowyer 1981, Watson 1981;
// for balls H. Edelsbrunner and N. R. Shah 1996, "Incremental topological flipping works for
// regular triangulations"), whose cells are rows of arrays.
//
// Lifted to (x, |x|² - r²), the balls are points in four dimensions, and the regular triangulation
// is the lower hull of these. A ball is in conflict with a cell if it lies below the hyperplane
// through the cell's four. Each ball is inserted in these steps:
// 1. locate() walks from the cell made last to one that contains the ball's centre, in double. If
//    rounding led it astray, and the cell is not in conflict, locate_exactly() walks on with exact
//    signs. If the cell that contains the centre is not in conflict, the ball is hidden.
// 2. find_hole() collects the cells in conflict, which are connected, and the facets around them.
// 3. fill_hole() makes a cell of the ball and each of these facets, and link_cells() links those
//    that share a facet at the ball, by a turn about their common edge through the hole.
//
// Why this is exact. All signs of conflicts are exact, and none is zero: conflict_side() decides
// ties as if every lifted point had been raised by an amount of its own, which depends on the
// ball's centre alone. So the hull is that of points in general position, the order of insertion
// does not matter, and a subset of the balls is decided as the whole is. No new cell is flat: in
// the plane of a facet the hyperplanes of the two cells at it are equal, so a ball whose centre is
// in this plane is in conflict with both or with none.
//
// An exact sign is rarely needed, because in_conflict() has a form whose coefficients are computed
// once for each cell, four cells at a time.
#include "complex/regular_cells.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "complex/insertion_order.hpp"
#include "complex/power_predicates.hpp"
#include "complex/power_triangulation.hpp"
#include "core/errors.hpp"
#include "core/lanes/lanes.hpp"
#include "core/lanes/multiversion.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {
namespace {

using FourIndices = std::array<std::uint32_t, 4>;

// Beyond the hull: a cell without vertices, which is in conflict with no ball.
constexpr std::uint32_t kBeyond = 0;

struct alignas(32) FlatCell {
  FourIndices vertices;   // positively oriented; vertices[0] is kNoIndex in a cell that was removed
  FourIndices neighbors;  // neighbors[k] is opposite to vertices[k]
};

// For each vertex k the others in an order in which k and they are an even permutation of 0 to 3.
constexpr std::array<std::array<std::uint8_t, 3>, 4> kOthers{
    {{1, 2, 3}, {0, 3, 2}, {3, 0, 1}, {2, 1, 0}}};

// What decides about conflicts with a cell, of which a ball a is the origin. With the vectors ab,
// ac, ad from there to its other balls, D = det(ab, ac, ad) > 0, w_b = |ab|² + r_a² - r_b² and so
// on, n = w_b ac×ad + w_c ad×ab + w_d ab×ac, a ball t is in conflict exactly if
//   D w_t - n·at < 0.
// On the way to a term there are at most 19 roundings: 1 to a difference of coordinates, 5 to a
// product of two components of a cross product, 9 to D, 6 to w, 14 to n, 17 to a product with
// either, 19 to the difference. So the error is below 20 u times the sum of the absolute values of
// all terms. With |.| for the sum of the absolute values of components, and radii of at most 1,
// that sum is at most
//   |ab| |ac| |ad| (at² + 1) + ((ab² + 1) |ac| |ad| + (ac² + 1) |ab| |ad| + (ad² + 1) |ab| |ac|)
//   |at|
// Its factors are kept, multiplied by 32 u, which exceeds 20 u by more than their own roundings.
struct alignas(64) ConflictForm {
  double coefficients[4];                  // n and D
  double determinant_error, normal_error;  // factors of at² + 1 and |at|
  std::uint32_t origin;
};
constexpr double kErrorFactor = 32 * (std::numeric_limits<double>::epsilon() / 2);
// A smaller bound may itself have lost digits to underflow.
constexpr double kTinyError = 1e-280;

// Lane i gets lane i + kBy, counted in a circle.
template <int kBy>
VDWMESH_INLINE Lanes turned_lanes(const Lanes& lanes) {
  return __builtin_shufflevector(lanes, lanes, kBy, (kBy + 1) % 4, (kBy + 2) % 4, (kBy + 3) % 4);
}
VDWMESH_INLINE Lanes size_of_lanes(const Lanes& lanes) { return lanes < 0 ? -lanes : lanes; }

void check_numbers(std::uint64_t cells) {
  if (cells >= kNoIndex) throw LimitExceeded("the triangulation has more than 2^32 cells");
}

// The triangulation of a list of balls so far. The first four are the auxiliary points.
class FlatTriangulation {
 public:
  explicit FlatTriangulation(const std::vector<Sphere>& balls);

  // Inserts the next ball. Throws LimitExceeded if there are too many cells.
  void insert(std::uint32_t ball);

  // How many cells were looked at or made so far.
  std::uint64_t steps() const { return steps_; }
  const Buffer<FlatCell>& cells() const { return cells_; }

 private:
  struct HoleFacet {
    std::uint32_t cell, slot;  // of the cell that is removed; opposite to that vertex
    std::uint32_t made;        // the new cell at the facet
  };
  // The balls of the form of a cell in this order: origin, b, c, d.
  struct FormBalls {
    std::uint32_t cell;
    std::array<std::uint32_t, 3> others;
  };

  std::uint32_t locate(const Sphere& ball, std::uint32_t start) const;
  std::uint32_t locate_exactly(const Sphere& ball, std::uint32_t start) const;
  bool in_conflict(std::uint32_t cell, const Sphere& ball) const;
  void find_hole(std::uint32_t start, const Sphere& ball);
  void make_room(std::size_t cells, std::size_t facets);
  void fill_hole(std::uint32_t ball);
  void link_cells();
  void make_forms(std::uint32_t origin);
  void free_hole();

  std::uint64_t steps_ = 0;
  const std::vector<Sphere>& balls_;
  Buffer<FlatCell> cells_;
  Buffer<ConflictForm> forms_;  // by cell
  // By cell: stamp_ if it is in conflict with the ball that is inserted, stamp_ + 1 if it is known
  // not to be, less if it was not asked.
  std::vector<std::uint32_t> marks_;
  std::uint32_t stamp_ = 0;
  std::uint32_t last_ = 1;           // the cell made last
  std::vector<std::uint32_t> free_;  // removed cells
  // The cells in conflict, the facets around them, and the balls of the new cells at these. All
  // have more elements than are in use.
  Buffer<std::uint32_t> hole_;
  Buffer<HoleFacet> facets_;
  Buffer<FormBalls> form_balls_;
  std::size_t hole_size_ = 0, facet_count_ = 0;
};

FlatTriangulation::FlatTriangulation(const std::vector<Sphere>& balls) : balls_(balls) {
  // There are hardly seven cells a ball.
  cells_.reserve(8 * balls.size());
  forms_.reserve(8 * balls.size());
  marks_.reserve(8 * balls.size());
  cells_.resize(2);
  forms_.resize(2);
  marks_.resize(2);
  cells_[kBeyond] = {{kNoIndex, kNoIndex, kNoIndex, kNoIndex}, {}};
  cells_[1] = {{0, 1, 2, 3}, {kBeyond, kBeyond, kBeyond, kBeyond}};
  if (orientation_sign(balls[0], balls[1], balls[2], balls[3]) == Sign::negative) {
    std::swap(cells_[1].vertices[2], cells_[1].vertices[3]);
  }
  const FourIndices& v = cells_[1].vertices;
  form_balls_.assign(1, {1, {v[1], v[2], v[3]}});
  facet_count_ = 1;
  make_forms(v[0]);
}

// Walks through the facet that the centre lies farthest beyond, until it lies beyond none. With the
// vectors from the centre to the vertices, lane k has the determinant of the three vectors other
// than k, in the cyclic order that begins behind k: six times the volume of the cell with the
// centre in the place of vertex k, but for the sign of lanes 1 and 3.
VDWMESH_INLINE std::uint32_t FlatTriangulation::locate(const Sphere& ball,
                                                       std::uint32_t start) const {
  constexpr int kMostSteps = 10000;  // rounding might lead in a circle
  static_assert(sizeof(Sphere) == sizeof(Lanes));
  const Sphere* const balls = balls_.data();
  const FlatCell* const cells = cells_.data();
  std::uint32_t current = start, from = kBeyond;
  for (int step = 0; step < kMostSteps; ++step) {
    const FlatCell& cell = cells[current];
    Lanes x = lanes_at(&balls[cell.vertices[0]].center.x),
          y = lanes_at(&balls[cell.vertices[1]].center.x),
          z = lanes_at(&balls[cell.vertices[2]].center.x),
          unused = lanes_at(&balls[cell.vertices[3]].center.x);
    transpose(x, y, z, unused);
    x -= all_lanes(ball.center.x);
    y -= all_lanes(ball.center.y);
    z -= all_lanes(ball.center.z);
    const Lanes x1 = turned_lanes<1>(x), x2 = turned_lanes<2>(x), x3 = turned_lanes<3>(x),
                y1 = turned_lanes<1>(y), y2 = turned_lanes<2>(y), y3 = turned_lanes<3>(y);
    const Lanes m12 = x1 * y2 - x2 * y1, m13 = x1 * y3 - x3 * y1, m23 = turned_lanes<1>(m12);
    const Lanes volumes =
        turned_lanes<1>(z) * m23 - turned_lanes<2>(z) * m13 + turned_lanes<3>(z) * m12;
    const double v0 = volumes[0], v1 = -volumes[1], v2 = volumes[2], v3 = -volumes[3];
    const std::uint32_t low = v1 < v0 ? 1 : 0, high = v3 < v2 ? 3 : 2;
    const double least_low = v1 < v0 ? v1 : v0, least_high = v3 < v2 ? v3 : v2;
    const double least = least_high < least_low ? least_high : least_low;
    if (!(least < 0)) return current;
    const std::uint32_t next = cell.neighbors[least_high < least_low ? high : low];
    if (next == from || next == kBeyond) return current;
    from = current;
    current = next;
  }
  return current;
}

// A walk through facets that the centre lies beyond ends, whichever of them it takes, because in
// regular triangulations cells are never in front of each other in a circle (H. Edelsbrunner 1990,
// "An acyclicity theorem for cell complexes in d dimensions").
inline std::uint32_t FlatTriangulation::locate_exactly(const Sphere& ball,
                                                       std::uint32_t start) const {
  std::uint32_t current = start;
  const auto is_beyond = [&](std::uint32_t k) {
    std::array<const Sphere*, 4> four;
    for (std::size_t i = 0; i < 4; ++i) four[i] = &balls_[cells_[current].vertices[i]];
    four[k] = &ball;
    return orientation_sign(*four[0], *four[1], *four[2], *four[3]) == Sign::negative;
  };
  for (std::uint32_t k = 0; k < 4;) {
    const bool beyond = is_beyond(k);
    if (beyond) current = cells_[current].neighbors[k];
    k = beyond ? 0 : k + 1;
  }
  return current;
}

VDWMESH_INLINE bool FlatTriangulation::in_conflict(std::uint32_t cell, const Sphere& ball) const {
  const ConflictForm& form = forms_[cell];
  const Sphere& origin = balls_[form.origin];
  const double x = ball.center.x - origin.center.x, y = ball.center.y - origin.center.y,
               z = ball.center.z - origin.center.z;
  const double squared = x * x + y * y + z * z,
               w = squared + (origin.radius - ball.radius) * (origin.radius + ball.radius);
  const double* const n = form.coefficients;
  const double value = n[3] * w - (n[0] * x + n[1] * y + n[2] * z);
  const double error = form.determinant_error * (squared + 1) +
                       form.normal_error * (std::abs(x) + std::abs(y) + std::abs(z));
  // Overflow anywhere makes the value infinite or not a number, though its bound may be finite.
  const double size = std::abs(value);
  if (error > kTinyError && size > error && size < std::numeric_limits<double>::infinity())
      [[likely]] {
    return value < 0;
  }
  const FourIndices& v = cells_[cell].vertices;
  return conflict_side({&balls_[v[0]], &balls_[v[1]], &balls_[v[2]], &balls_[v[3]]}, ball) ==
         Sign::positive;
}

// Fills hole_ and facets_, from a cell in conflict on.
VDWMESH_INLINE void FlatTriangulation::find_hole(std::uint32_t start, const Sphere& ball) {
  stamp_ += 2;
  // Known to the compiler as unchanged by what is written to arrays.
  const std::uint32_t stamp = stamp_;
  const FlatCell* const cells = cells_.data();
  std::uint32_t* const marks = marks_.data();
  std::size_t size = 1, count = 0;
  make_room(size, count);
  marks[kBeyond] = stamp + 1;
  marks[start] = stamp;
  hole_[0] = start;
  for (std::size_t i = 0; i < size; ++i) {
    make_room(size, count);
    std::uint32_t* const hole = hole_.data();
    HoleFacet* const facets = facets_.data();
    const std::uint32_t cell = hole[i];
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t next = cells[cell].neighbors[k];
      std::uint32_t mark = marks[next];
      if (mark < stamp) {
        mark = stamp + !in_conflict(next, ball);
        marks[next] = mark;
        hole[size] = next;
        size += mark == stamp;
      }
      facets[count] = {cell, k, 0};
      count += mark != stamp;
    }
  }
  hole_size_ = size;
  facet_count_ = count;
  steps_ += size + count;
}

// Makes room for what four neighbours may add to that many cells and facets.
VDWMESH_INLINE void FlatTriangulation::make_room(std::size_t cells, std::size_t facets) {
  if (hole_.size() < cells + 4) hole_.resize(2 * cells + 64);
  if (facets_.size() < facets + 4) facets_.resize(2 * facets + 64);
}

// Makes the new cells, as yet linked to the cells outside of the hole only. The removed cells are
// still read by link_cells(); where they had a neighbour outside, they get the new cell.
VDWMESH_INLINE void FlatTriangulation::fill_hole(std::uint32_t ball) {
  const std::size_t count = facet_count_, reused = std::min(free_.size(), count),
                    fresh = count - reused;
  auto next = static_cast<std::uint32_t>(cells_.size());
  check_numbers(cells_.size() + fresh);
  cells_.resize(cells_.size() + fresh);
  forms_.resize(cells_.size());
  marks_.resize(cells_.size(), 0);
  if (form_balls_.size() < count) form_balls_.resize(2 * count);
  FlatCell* const cells = cells_.data();
  const std::uint32_t* const free = free_.data();
  const std::size_t free_count = free_.size();
  for (std::size_t i = 0; i < count; ++i) {
    HoleFacet& facet = facets_[i];
    facet.made = i < reused ? free[free_count - 1 - i] : next++;
    FlatCell& removed = cells[facet.cell];
    const std::uint32_t outside = removed.neighbors[facet.slot];
    FlatCell& made = cells[facet.made];
    made.vertices = removed.vertices;
    made.vertices[facet.slot] = ball;
    made.neighbors.fill(kNoIndex);
    made.neighbors[facet.slot] = outside;
    FourIndices& back = cells[outside].neighbors;
    back[slot_of(back, facet.cell)] = facet.made;
    removed.neighbors[facet.slot] = facet.made;
    const auto& others = kOthers[facet.slot];
    form_balls_[i] = {
        facet.made, {made.vertices[others[0]], made.vertices[others[1]], made.vertices[others[2]]}};
  }
  free_.resize(free_.size() - reused);
}

// Two new cells are neighbours if their facets share an edge. The cells of the hole about the edge
// lead from one of these facets to the other: a cell is left through the facet of the edge and its
// vertex at `pivot`, which is opposite to the vertex at `exit`.
VDWMESH_INLINE void FlatTriangulation::link_cells() {
  FlatCell* const cells = cells_.data();
  const std::uint32_t* const marks = marks_.data();
  const std::uint32_t stamp = stamp_;
  for (const HoleFacet facet : std::span(facets_.data(), facet_count_)) {
    FourIndices& neighbors = cells[facet.made].neighbors;
    for (std::uint32_t side = 0; side < 4; ++side) {
      if (neighbors[side] != kNoIndex) continue;
      std::uint32_t current = facet.cell, exit = side, pivot = facet.slot;
      std::uint32_t next = cells[current].neighbors[exit];
      while (marks[next] == stamp) {
        const std::uint32_t turned = cells[current].vertices[pivot];
        pivot = slot_of(cells[next].neighbors, current);
        exit = slot_of(cells[next].vertices, turned);
        current = next;
        next = cells[current].neighbors[exit];
      }
      neighbors[side] = next;
      cells[next].neighbors[pivot] = facet.made;
    }
  }
}

// Makes the forms of the cells in form_balls_, all of which have the same origin, four at a time.
// At the end of the list the last cell is made several times.
VDWMESH_INLINE void FlatTriangulation::make_forms(std::uint32_t origin) {
  const Sphere& from = balls_[origin];
  const Sphere* const balls = balls_.data();
  const Lanes x0 = all_lanes(from.center.x), y0 = all_lanes(from.center.y),
              z0 = all_lanes(from.center.z), r0 = all_lanes(from.radius), one = all_lanes(1);
  struct VectorLanes {
    Lanes x, y, z, w, size, large;  // a vector, its w, |.|, and its square + 1
  };
  const std::size_t count = facet_count_;
  for (std::size_t first = 0; first < count; first += kLanes) {
    std::array<const FormBalls*, kLanes> rows;
    for (std::size_t i = 0; i < kLanes; ++i)
      rows[i] = &form_balls_[first + i < count ? first + i : count - 1];
    const auto four_at = [&](std::size_t k) {
      VectorLanes v;
      v.x = lanes_at(&balls[rows[0]->others[k]].center.x);
      v.y = lanes_at(&balls[rows[1]->others[k]].center.x);
      v.z = lanes_at(&balls[rows[2]->others[k]].center.x);
      Lanes radius = lanes_at(&balls[rows[3]->others[k]].center.x);
      transpose(v.x, v.y, v.z, radius);
      v.x -= x0;
      v.y -= y0;
      v.z -= z0;
      const Lanes squared = v.x * v.x + v.y * v.y + v.z * v.z;
      v.w = squared + (r0 - radius) * (r0 + radius);
      v.size = size_of_lanes(v.x) + size_of_lanes(v.y) + size_of_lanes(v.z);
      v.large = squared + one;
      return v;
    };
    const VectorLanes b = four_at(0), c = four_at(1), d = four_at(2);
    const Lanes cdx = c.y * d.z - c.z * d.y, cdy = c.z * d.x - c.x * d.z,
                cdz = c.x * d.y - c.y * d.x, dbx = d.y * b.z - d.z * b.y,
                dby = d.z * b.x - d.x * b.z, dbz = d.x * b.y - d.y * b.x,
                bcx = b.y * c.z - b.z * c.y, bcy = b.z * c.x - b.x * c.z,
                bcz = b.x * c.y - b.y * c.x;
    Lanes determinant = b.x * cdx + b.y * cdy + b.z * cdz, nx = b.w * cdx + c.w * dbx + d.w * bcx,
          ny = b.w * cdy + c.w * dby + d.w * bcy, nz = b.w * cdz + c.w * dbz + d.w * bcz;
    const Lanes factor = all_lanes(kErrorFactor), sizes = factor * d.size,
                determinant_error = b.size * c.size * sizes,
                normal_error = (b.large * c.size + c.large * b.size) * sizes +
                               factor * d.large * b.size * c.size;
    transpose(nx, ny, nz, determinant);
    const Lanes form[kLanes] = {nx, ny, nz, determinant};
    for (std::size_t i = 0; i < kLanes; ++i) {
      ConflictForm& out = forms_[rows[i]->cell];
      store_lanes(out.coefficients, form[i]);
      out.determinant_error = determinant_error[i];
      out.normal_error = normal_error[i];
      out.origin = origin;
    }
  }
}

VDWMESH_INLINE void FlatTriangulation::free_hole() {
  const std::span removed(hole_.data(), hole_size_);
  for (const std::uint32_t cell : removed) cells_[cell].vertices[0] = kNoIndex;
  free_.insert(free_.end(), removed.begin(), removed.end());
}

VDWMESH_INLINE void FlatTriangulation::insert(std::uint32_t index) {
  const Sphere& ball = balls_[index];
  std::uint32_t start = locate(ball, last_);
  if (!in_conflict(start, ball)) {
    last_ = start = locate_exactly(ball, start);
    if (!in_conflict(start, ball)) return;  // hidden
  }
  find_hole(start, ball);
  fill_hole(index);
  link_cells();
  make_forms(index);
  free_hole();
  last_ = facets_[facet_count_ - 1].made;
}

// Inserts balls from `first` on, until all are or about so many steps were taken. Returns the next.
VDWMESH_MULTIVERSION std::uint32_t insert_balls(FlatTriangulation& triangulation,
                                                std::uint32_t first, std::uint32_t end,
                                                std::uint64_t steps) {
  const std::uint64_t last = triangulation.steps() + steps;
  std::uint32_t ball = first;
  while (ball < end && triangulation.steps() < last) triangulation.insert(ball++);
  return ball;
}

// The cells that the caller takes, with the caller's numbers of balls.
RegularCells taken_cells(const Buffer<FlatCell>& cells, const std::vector<std::uint32_t>& numbers,
                         const TakesCell& takes, std::vector<std::uint8_t>& has_vertex) {
  RegularCells out;
  out.cells.reserve(cells.size());
  Buffer<std::uint32_t> number(cells.size(), kNoIndex);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (cells[c].vertices[0] == kNoIndex) continue;
    CellVertices vertices;
    for (std::size_t k = 0; k < 4; ++k) {
      vertices[k] = numbers[cells[c].vertices[k]];
      if (vertices[k] < has_vertex.size()) has_vertex[vertices[k]] = 1;
    }
    vertices = canonical(vertices);
    if (!takes(vertices)) continue;
    number[c] = static_cast<std::uint32_t>(out.cells.size());
    out.cells.push_back(vertices);
  }
  out.neighbors.resize(out.cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (number[c] == kNoIndex) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t slot = slot_of(out.cells[number[c]], numbers[cells[c].vertices[k]]);
      out.neighbors[number[c]][slot] = number[cells[c].neighbors[k]];
    }
  }
  return out;
}

}  // namespace

// Balls of molecules have some seven cells each, which the estimates of memory know about.
void check_cells(std::uint64_t cells, std::size_t balls, std::uint64_t memory_limit) {
  constexpr std::uint64_t kUsualCells = 8;     // of a ball
  constexpr std::uint64_t kBytesOfCell = 360;  // measured, while arrays grow
  if (cells <= kUsualCells * balls || cells <= memory_limit / kBytesOfCell) return;
  throw LimitExceeded(fmt::format(
      "the triangulation of {} balls has {} cells and more, which need more memory than the limit "
      "of {} bytes: balls on two skew lines have as many cells as there are pairs of them. Measure "
      "fewer balls at once, or raise the memory limit",
      balls, cells, memory_limit));
}

RegularCells regular_cells(const std::vector<Sphere>& balls, const std::array<Vec3d, 4>& auxiliary,
                           std::span<const std::uint32_t> indices, const TakesCell& takes,
                           std::vector<std::uint8_t>& has_vertex, std::uint64_t memory_limit,
                           Monitor* monitor) {
  check_numbers(2 * (indices.size() + 8));  // marks count up by two for each ball
  // In the order of insertion, so that what is near in the triangulation is near in memory.
  std::vector<Sphere> local;
  std::vector<std::uint32_t> numbers;
  local.reserve(indices.size() + 4);
  numbers.reserve(indices.size() + 4);
  for (std::size_t k = 0; k < auxiliary.size(); ++k) {
    local.push_back({auxiliary[k], 0});
    numbers.push_back(static_cast<std::uint32_t>(balls.size() + k));
  }
  for (const std::uint32_t place : insertion_order(indices.size())) {
    local.push_back(balls[indices[place]]);
    numbers.push_back(indices[place]);
  }
  FlatTriangulation triangulation(local);
  constexpr std::uint64_t kStepsPerQuestion = 16384;
  const auto end = static_cast<std::uint32_t>(local.size());
  for (std::uint32_t next = 4; next < end;) {
    advance(monitor, 0);
    next = insert_balls(triangulation, next, end, kStepsPerQuestion);
    check_cells(triangulation.cells().size(), indices.size(), memory_limit);
  }
  return taken_cells(triangulation.cells(), numbers, takes, has_vertex);
}

}  // namespace vdwmesh
