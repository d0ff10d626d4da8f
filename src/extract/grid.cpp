// make_grid() lays a grid around the box of the spheres: its origin is the lower corner of the box
// less the padding, and along each axis it gets as many cells as the padded box needs. The number
// of cells is computed and checked as a double before it is converted to an integer, because it may
// be too large for one.
#include "extract/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// The product of the three numbers, each increased by `extra`.
std::uint64_t product(const Vec3i& n, std::int64_t extra) {
  return static_cast<std::uint64_t>(n.x + extra) * static_cast<std::uint64_t>(n.y + extra) *
         static_cast<std::uint64_t>(n.z + extra);
}

// Vertices lie on edges of the grid. An edge must have at least so many places in double precision,
// or vertices fall together.
constexpr double kLeastPlaces = 256;

// Throws unless doubles are fine enough for the spacing everywhere in the grid.
void check_precision(const GridSpec& grid) {
  double farthest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double first = grid.origin[axis],
                 last = first + grid.spacing * static_cast<double>(grid.cells[axis]);
    farthest = std::max({farthest, std::abs(first), std::abs(last)});
  }
  const double least = kLeastPlaces * std::numeric_limits<double>::epsilon() * farthest;
  if (grid.spacing >= least) return;
  throw LimitExceeded(fmt::format(
      "a spacing of {:.3g} Å is finer than double precision at coordinates of {:.3g} Å: "
      "choose at least {:.3g} Å or move the spheres towards the origin",
      grid.spacing, farthest, 1.01 * least));
}

void check_options(const GridOptions& options) {
  if (!(options.spacing > 0) || !std::isfinite(options.spacing)) {
    throw InvalidInput(fmt::format("spacing {} Å: must be finite and above 0", options.spacing));
  }
  if (options.padding && !(*options.padding >= 0 && std::isfinite(*options.padding))) {
    throw InvalidInput(
        fmt::format("padding {} Å: must be finite and at least 0", *options.padding));
  }
}

}  // namespace

std::uint64_t GridSpec::cell_count() const { return product(cells, 0); }
std::uint64_t GridSpec::node_count() const { return product(cells, 1); }

void check(const GridSpec& grid) {
  const Vec3d& o = grid.origin;
  if (!(grid.spacing > 0) || !std::isfinite(grid.spacing + o.x + o.y + o.z)) {
    throw InvalidInput(fmt::format(
        "the grid begins at ({}, {}, {}) with a spacing of {} Å: both must be finite, and the "
        "spacing above 0",
        o.x, o.y, o.z, grid.spacing));
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (grid.cells[axis] < 0) {
      throw InvalidInput(fmt::format("the grid has {} cells along {}: it needs 0 or more",
                                     grid.cells[axis], "xyz"[axis]));
    }
    if (grid.cells[axis] > kMaxCellsPerAxis) {
      throw LimitExceeded(fmt::format("the grid has {} cells along {}, at most {} fit",
                                      grid.cells[axis], "xyz"[axis], kMaxCellsPerAxis));
    }
  }
  check_precision(grid);
}

GridSpec make_grid(const SphereSet& spheres, const GridOptions& options) {
  if (spheres.empty()) throw InvalidInput("no spheres: there is nothing to put a grid around");
  if (options.given) return make_grid(Box{}, Box{}, options);  // no box is looked at
  return make_grid(bounding_box(spheres), center_bounding_box(spheres), options);
}

GridSpec make_grid(const Box& balls, const Box& centers, const GridOptions& options) {
  if (options.given) {
    check(*options.given);
    return *options.given;
  }
  check_options(options);
  const Box& box = options.box == GridBox::balls ? balls : centers;
  const double padding = options.padding.value_or(3 * options.spacing);
  GridSpec grid{};
  grid.spacing = options.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = box.lower[axis] - padding;
    const double quotient = (box.upper[axis] - box.lower[axis] + 2 * padding) / options.spacing;
    const double cells = std::max(
        1.0, options.rounding == GridRounding::floor ? std::floor(quotient) : std::ceil(quotient));
    if (!(cells <= static_cast<double>(kMaxCellsPerAxis))) {
      throw LimitExceeded(
          fmt::format("{:.6g} cells along {}, at most {} fit; a spacing of {:.6g} Å would", cells,
                      "xyz"[axis], kMaxCellsPerAxis,
                      options.spacing * cells / static_cast<double>(kMaxCellsPerAxis) * 1.001));
    }
    grid.cells[axis] = static_cast<std::int64_t>(cells);
  }
  check_precision(grid);
  return grid;
}

}  // namespace vdwmesh
