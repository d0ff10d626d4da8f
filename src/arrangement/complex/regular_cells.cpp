// regular_cells(): incremental insertion into CGAL's regular triangulation, flattened into arrays.
//
// 1. Four auxiliary points, then all balls in a biased randomized order, are inserted.
// 2. The finite cells (CGAL also keeps infinite ones, beyond the hull) that the caller takes are
//    numbered and copied, with their vertices in canonical order.
// The power test is our own predicate (power_predicates.hpp), which squares radii exactly. CGAL's
// own test takes weights, that is, squared radii that were rounded to double.
#include "arrangement/complex/regular_cells.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/tss.h>

namespace vdwmesh {

// Returns `variable`, in a way that hides from the compiler that it is local to the thread. So its
// address is looked up once and then stands in a register. What that is for is said below.
template <class T>
T& with_known_address(T& variable) {
  T* address = &variable;
  asm("" : "+r"(address));
  return *address;
}

}  // namespace vdwmesh

// CGAL keeps a map for each thread, with which a new vertex's cells find their neighbours. Code of
// a shared library, such as the package for Python, asks the loader where that is, and would do so
// at each access: a million times for the 4,384 atoms of haemoglobin. So the macro that declares
// the map makes a reference to it, which is looked up once for each vertex.
#pragma push_macro("CGAL_STATIC_THREAD_LOCAL_VARIABLE_0")
#undef CGAL_STATIC_THREAD_LOCAL_VARIABLE_0
#define CGAL_STATIC_THREAD_LOCAL_VARIABLE_0(TYPE, VAR) \
  static thread_local TYPE VAR##_of_this_thread;       \
  TYPE& VAR = vdwmesh::with_known_address(VAR##_of_this_thread)
#include <CGAL/Regular_triangulation_3.h>
#pragma pop_macro("CGAL_STATIC_THREAD_LOCAL_VARIABLE_0")
#include <CGAL/Triangulation_ds_cell_base_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "arrangement/complex/insertion_order.hpp"
#include "arrangement/complex/power_predicates.hpp"
#include "arrangement/complex/power_triangulation.hpp"
#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// The geometric traits of the triangulation. A weighted point carries the radius as its weight, and
// the power test squares it exactly.
struct PowerTraits : CGAL::Epick {
  struct Power_side_of_oriented_power_sphere_3 {
    using result_type = CGAL::Oriented_side;
    using P = Weighted_point_3;

    static Sphere sphere(const P& p) { return {{p.x(), p.y(), p.z()}, p.weight()}; }

    result_type operator()(const P& p, const P& q, const P& r, const P& s, const P& t) const {
      return static_cast<result_type>(
          power_side(sphere(p), sphere(q), sphere(r), sphere(s), sphere(t)));
    }
    // Tests among two to four points in a lower dimension. The auxiliary points come first and make
    // the triangulation three-dimensional, so these tests are never asked for.
    result_type operator()(const P&, const P&) const { return unreachable(); }
    result_type operator()(const P&, const P&, const P&) const { return unreachable(); }
    result_type operator()(const P&, const P&, const P&, const P&) const { return unreachable(); }

    static result_type unreachable() {
      assert(!"a degenerate power test cannot occur");
      return CGAL::ON_ORIENTED_BOUNDARY;
    }
  };
  Power_side_of_oriented_power_sphere_3 power_side_of_oriented_power_sphere_3_object() const {
    return {};
  }
};

}  // namespace
}  // namespace vdwmesh

// Lets CGAL locate points by a walk with inexact tests first, and exact tests from its end on, as
// it does for its own kernels.
template <>
struct CGAL::Triangulation_structural_filtering_traits<vdwmesh::PowerTraits> {
  using Use_structural_filtering_tag = Tag_true;
};

namespace vdwmesh {
namespace {

using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<
    std::uint32_t, PowerTraits, CGAL::Regular_triangulation_vertex_base_3<PowerTraits>>;
// A cell with a number. It is a model of CGAL's concept RegularTriangulationCellBase_3 that does
// not keep the list of points hidden in the cell, which makes the triangulation smaller.
template <class Base = CGAL::Triangulation_ds_cell_base_3<>>
struct NumberedCell : Base {
  template <class Tds>
  struct Rebind_TDS {
    using Other = NumberedCell<typename Base::template Rebind_TDS<Tds>::Other>;
  };
  using Base::Base;

  using Point = PowerTraits::Weighted_point_3;
  using Point_iterator = const Point*;
  using Point_const_iterator = const Point*;
  Point_iterator hidden_points_begin() const { return nullptr; }
  Point_iterator hidden_points_end() const { return nullptr; }
  void hide_point(const Point&) {}

  std::uint32_t& info() { return number_; }
  std::uint32_t info() const { return number_; }

 private:
  std::uint32_t number_ = kNoIndex;
};
using Triangulation =
    CGAL::Regular_triangulation_3<PowerTraits,
                                  CGAL::Triangulation_data_structure_3<VertexBase, NumberedCell<>>>;
using WeightedPoint = PowerTraits::Weighted_point_3;
using Point = PowerTraits::Point_3;

// Inserts the auxiliary points, then the balls. Every search begins where the last one ended, which
// is near because the order is spatial. A ball that others hide is not inserted: insert() returns
// an empty handle. A ball that a later one hides loses its vertex.
void insert_all(Triangulation& triangulation, const std::vector<Sphere>& balls,
                const std::array<Vec3d, 4>& auxiliary, std::span<const std::uint32_t> indices,
                std::uint64_t memory_limit, Monitor* monitor) {
  Triangulation::Cell_handle hint;
  const auto insert = [&](const Vec3d& c, double radius, std::size_t index) {
    Triangulation::Locate_type type;
    int i, j;
    const WeightedPoint point(Point(c.x, c.y, c.z), radius);
    // Sets `type`, i and j, which say where in `cell` the point lies.
    const auto cell = triangulation.locate(point, type, i, j, hint);
    const auto vertex = triangulation.insert(point, type, cell, i, j);
    hint = cell;
    if (vertex == Triangulation::Vertex_handle()) return;
    vertex->info() = static_cast<std::uint32_t>(index);
    hint = vertex->cell();
  };
  for (std::size_t k = 0; k < auxiliary.size(); ++k) insert(auxiliary[k], 0, balls.size() + k);
  // The monitor is asked for cancellation once in so many balls.
  constexpr std::size_t kBallsPerCancellationCheck = 256;
  std::size_t inserted = 0;
  for (const std::uint32_t place : insertion_order(indices.size())) {
    const std::uint32_t i = indices[place];
    // Throws Cancelled on request; 0 steps are reported as done.
    if (++inserted % kBallsPerCancellationCheck == 0) {
      advance(monitor, 0);
      check_cells(triangulation.number_of_cells(), indices.size(), memory_limit);
    }
    insert(balls[i].center, balls[i].radius, i);
  }
}

// CGAL's order is positively oriented.
CellVertices vertices_of(const Triangulation::Cell& cell) {
  return canonical({cell.vertex(0)->info(), cell.vertex(1)->info(), cell.vertex(2)->info(),
                    cell.vertex(3)->info()});
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
  Triangulation triangulation;
  insert_all(triangulation, balls, auxiliary, indices, memory_limit, monitor);
  for (const auto vertex : triangulation.finite_vertex_handles()) {
    if (vertex->info() < balls.size()) has_vertex[vertex->info()] = 1;
  }
  const std::size_t count = triangulation.number_of_finite_cells();
  if (count >= kNoIndex) throw LimitExceeded("the triangulation has more than 2^32 cells");
  check_cells(count, indices.size(), memory_limit);
  RegularCells out;
  out.cells.reserve(count);
  for (const auto cell : triangulation.all_cell_handles()) cell->info() = kNoIndex;
  for (const auto cell : triangulation.finite_cell_handles()) {
    const CellVertices vertices = vertices_of(*cell);
    if (!takes(vertices)) continue;
    cell->info() = static_cast<std::uint32_t>(out.cells.size());
    out.cells.push_back(vertices);
  }
  out.neighbors.resize(out.cells.size());
  for (const auto cell : triangulation.finite_cell_handles()) {
    if (cell->info() == kNoIndex) continue;
    const CellVertices& vertices = out.cells[cell->info()];
    for (int k = 0; k < 4; ++k) {
      const auto slot = std::ranges::find(vertices, cell->vertex(k)->info()) - vertices.begin();
      out.neighbors[cell->info()][static_cast<std::size_t>(slot)] = cell->neighbor(k)->info();
    }
  }
  return out;
}

}  // namespace vdwmesh
