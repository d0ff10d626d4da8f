// excluded_distance_bounds(): branch and bound in rounds. In each round the middles of all cells
// are measured, and the cells that may still have a farther point are divided.
//
// Let p be the probe's radius, D the signed distance to the surface, d the distance to the nearest
// accessible point. Of a triangle let m be the middle, r the largest distance of a corner from it.
//  - D(m) + r and -D(m) + r bound D and -D: distances change by no more than the way.
//  - -D is at most d - p, and d is at most the distance to any one accessible point f. That is
//    convex, so it is largest at a corner: -D <= max |corner - f| - p with the f of the middle.
//  - d² - |x|² is the least of linear functions, so it is concave, and in the triangle at least the
//    mean of its values at the corners. Hence d² >= min d(corner)² - r².
//  - D is p - d or the distance C to the nearest crease or cusp (excluded_finder.hpp). Where C is
//    larger than p - d in the whole triangle, D is the same one of the two everywhere, because both
//    and D are continuous. If it is p - d in the middle, D <= p - √(min d(corner)² - r²).
// Of a piece of the surface, the distance to the mesh is at most that of its middle and its radius.
#include "excluded/excluded_bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "analysis/distances/distances_plan.hpp"
#include "analysis/distances/mesh_finder.hpp"
#include "core/errors.hpp"
#include "core/fixed_blocks.hpp"
#include "excluded/distances/excluded_finder.hpp"
#include "excluded/distances/surface_cells.hpp"
#include "excluded/excluded_distances.hpp"

namespace vdwmesh {
namespace {

using excluded::CellBall;
using excluded::ExcludedFinder;
using excluded::JudgedPoint;
using excluded::JudgedSurface;
using excluded::SurfaceCell;
using excluded::SurfaceCells;

constexpr std::size_t kCellsPerBlock = 1024;
// Cells of one round: enough for all cores; their parts, and the parts of those, take some 15 MiB.
constexpr std::size_t kTogether = std::size_t{1} << 14;
constexpr std::uint64_t kBytesPerCell = 112;
// Creases are looked for beyond a cell's width by this share of the probe's radius, at most by
// kCreaseReach (Å): farther ones do not matter to a mesh that is nearer to the surface.
constexpr double kCreaseShare = 0.25, kCreaseReach = 0.5;

// A triangle of the mesh, or a part of one.
struct MeshCell {
  std::array<Vec3d, 3> corner;
  std::array<double, 3> depth;  // of the corners, as JudgedPoint's
};

// What is known of a cell: the distance of one of its points, 0 if that is none, and of all.
struct CellBounds {
  double lower = 0, upper = 0;
};

Vec3d middle_of(const MeshCell& cell) {
  return (1.0 / 3) * (cell.corner[0] + cell.corner[1] + cell.corner[2]);
}

double radius_of(const MeshCell& cell, const Vec3d& middle) {
  double radius = 0;
  for (const Vec3d& corner : cell.corner) radius = std::max(radius, norm(corner - middle));
  return radius;
}

CellBounds bounds_of(const MeshCell& cell, double radius, const JudgedPoint& middle, double probe) {
  double above = middle.distance + radius, below = -middle.distance + radius;
  if (middle.foot) {
    double most = 0;
    for (const Vec3d& corner : cell.corner) most = std::max(most, norm(corner - *middle.foot));
    below = std::min(below, most - probe);
  }
  const double depth = *std::ranges::min_element(cell.depth);
  const double squared = depth * depth - radius * radius;
  if (squared > 0 && !middle.by_curve) {
    const double most = probe - std::sqrt(squared);
    if (middle.to_curves - radius > most) above = std::min(above, most);
  }
  return {std::abs(middle.distance), std::max({above, below, 0.0})};
}

double reach_of(double radius, double probe) {
  return 2 * radius + std::min(kCreaseShare * probe, kCreaseReach);
}

// Divides cells as the header says, the last ones first, so that there are never many. measure(
// cells, bounds) bounds each, divide(cell, parts) adds its parts. `lower` is the distance of some
// point.
template <class Cell, class Measure, class Divide>
DistanceBounds close_in(std::vector<Cell> left, double lower, const Measure& measure,
                        const Divide& divide, const DistanceBoundOptions& options,
                        std::uint64_t& points) {
  DistanceBounds found{lower, lower};
  std::uint64_t measured = 0;
  while (!left.empty()) {
    const auto first = left.end() - static_cast<std::ptrdiff_t>(std::min(left.size(), kTogether));
    const std::vector<Cell> cells(first, left.end());
    left.erase(first, left.end());
    std::vector<CellBounds> bounds(cells.size());
    measure(cells, bounds);
    measured += cells.size();
    for (const CellBounds& b : bounds) found.lower = std::max(found.lower, b.lower);
    const double enough = found.lower * (1 + options.gap);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (bounds[i].upper > enough && measured < options.most_points) {
        divide(cells[i], left);
      } else {
        found.upper = std::max(found.upper, bounds[i].upper);
      }
    }
  }
  points += measured;
  found.upper = std::max(found.upper, found.lower);
  return found;
}

// Calls body(first, end) for blocks of so many cells.
template <class Body>
void for_cells(std::size_t count, const Body& body, Monitor* monitor) {
  for_each_block(
      count, kCellsPerBlock,
      [&](std::size_t, std::size_t first, std::size_t end) {
        advance(monitor, 0);
        body(first, end);
      },
      nullptr);
}

class MeshSide {
 public:
  MeshSide(const ExcludedFinder& finder, double probe, Monitor* monitor)
      : finder_(finder), probe_(probe), monitor_(monitor) {}

  DistanceBounds run(const IndexedMesh& mesh, const DistanceBoundOptions& options,
                     std::uint64_t& points) const {
    const std::span<const Vec3d> vertices(mesh.positions.data(), mesh.vertex_count());
    std::vector<JudgedPoint> judged(vertices.size());
    for_cells(
        vertices.size(),
        [&](std::size_t first, std::size_t end) {
          const std::vector<double> none(end - first, 0.0);
          finder_.judge(vertices.subspan(first, end - first), none, judged.data() + first);
        },
        monitor_);
    std::vector<MeshCell> cells;
    double farthest = 0;
    for (const Triangle& t : mesh.triangles) {
      MeshCell& cell = cells.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        cell.corner[k] = vertices[t[k]];
        cell.depth[k] = judged[t[k]].depth;
        farthest = std::max(farthest, std::abs(judged[t[k]].distance));
      }
    }
    points += vertices.size();
    return close_in(
        std::move(cells), farthest, [&](const auto& some, auto& bounds) { measure(some, bounds); },
        [&](const MeshCell& cell, auto& parts) { divide(cell, parts); }, options, points);
  }

 private:
  void measure(const std::vector<MeshCell>& cells, std::vector<CellBounds>& bounds) const {
    for_cells(
        cells.size(),
        [&](std::size_t first, std::size_t end) {
          std::vector<Vec3d> middles;
          std::vector<double> radii, reach;
          for (std::size_t i = first; i < end; ++i) {
            middles.push_back(middle_of(cells[i]));
            radii.push_back(radius_of(cells[i], middles.back()));
            reach.push_back(reach_of(radii.back(), probe_));
          }
          std::vector<JudgedPoint> judged(middles.size());
          finder_.judge(middles, reach, judged.data());
          for (std::size_t i = first; i < end; ++i) {
            bounds[i] = bounds_of(cells[i], radii[i - first], judged[i - first], probe_);
          }
        },
        monitor_);
  }

  // Into four; the depths of the new corners are measured.
  void divide(const MeshCell& cell, std::vector<MeshCell>& parts) const {
    const auto& [a, b, c] = cell.corner;
    const std::array<Vec3d, 3> middle{0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)};
    std::array<JudgedPoint, 3> judged;
    finder_.judge(middle, std::array<double, 3>{}, judged.data());
    const std::array<double, 3> depth{judged[0].depth, judged[1].depth, judged[2].depth};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t before = (k + 2) % 3;
      parts.push_back(
          {{cell.corner[k], middle[k], middle[before]}, {cell.depth[k], depth[k], depth[before]}});
    }
    parts.push_back({middle, depth});
  }

  const ExcludedFinder& finder_;
  double probe_;
  Monitor* monitor_;
};

DistanceBounds surface_side(const SurfaceCells& surface, const MeshFinder& finder,
                            const DistanceBoundOptions& options, std::uint64_t& points) {
  const auto measure = [&](const std::vector<SurfaceCell>& cells, std::vector<CellBounds>& bounds) {
    for_cells(
        cells.size(),
        [&](std::size_t first, std::size_t end) {
          std::vector<CellBall> balls;
          std::vector<Vec3d> middles;
          for (std::size_t i = first; i < end; ++i) {
            balls.push_back(surface.ball_of(cells[i]));
            if (balls.back().may_meet) middles.push_back(balls.back().middle);
          }
          std::vector<double> found(middles.size());
          finder.find(middles, found.data());
          std::size_t next = 0;
          for (std::size_t i = first; i < end; ++i) {
            const CellBall& ball = balls[i - first];
            if (!ball.may_meet) continue;
            const double distance = found[next++];
            bounds[i] = {ball.on_surface ? distance : 0, distance + ball.radius};
          }
        },
        options.monitor);
  };
  return close_in(
      surface.all(), 0, measure,
      [&](const SurfaceCell& cell, auto& parts) { surface.divide(cell, parts); }, options, points);
}

// Around all balls, and all spheres of probes that touch them, and the mesh.
Box world_around(const SphereSet& grown, double probe, const IndexedMesh& mesh) {
  const Box box = box_around(bounding_box(grown), {mesh.positions.data(), mesh.vertex_count()});
  const Vec3d margin{probe, probe, probe};
  return {box.lower - margin, box.upper + margin};
}

void check_bound_options(const IndexedMesh& mesh, const SphereSet& atoms,
                         const DistanceBoundOptions& options) {
  if (!(options.gap > 0)) {
    throw InvalidInput(fmt::format("the gap of bounds must be positive, not {}", options.gap));
  }
  const std::uint64_t need =
      indexed_mesh_bytes(mesh) +
      excluded_distances_bytes({mesh.vertex_count(), mesh.triangle_count()}, atoms.size()) +
      kBytesPerCell * (mesh.triangle_count() + 8 * kTogether);
  if (need <= options.memory_limit) return;
  throw LimitExceeded(fmt::format(
      "bounds of the distances of {} triangles need {} bytes with the mesh, {} are allowed: choose "
      "a higher memory limit or no distances",
      mesh.triangle_count(), need, options.memory_limit));
}

}  // namespace

double HausdorffBounds::lower() const {
  return std::max(mesh_to_surface.lower, surface_to_mesh.lower);
}
double HausdorffBounds::upper() const {
  return std::max(mesh_to_surface.upper, surface_to_mesh.upper);
}

HausdorffBounds excluded_distance_bounds(const IndexedMesh& mesh, const SphereSet& atoms,
                                         double probe, const DistanceBoundOptions& options,
                                         ExcludedPart part) {
  const SphereSet grown = excluded::grown_by(atoms, probe);
  plan_distances(mesh, grown, {.monitor = options.monitor});
  check_bound_options(mesh, atoms, options);
  begin_stage(options.monitor, "bounds of distances", 1);
  const JudgedSurface surface(atoms, probe, part, options.monitor);
  const ExposedSurface accessible(grown, options.monitor);
  const Box world = world_around(grown, probe, mesh);
  HausdorffBounds found;
  const ExcludedFinder finder(accessible, surface, probe, world);
  found.mesh_to_surface = MeshSide(finder, probe, options.monitor).run(mesh, options, found.points);
  found.surface_to_mesh = surface_side(SurfaceCells(surface, accessible, probe),
                                       MeshFinder(mesh, world), options, found.points);
  // The exact point may be that much farther than the one that was found.
  found.mesh_to_surface.upper += finder.tolerance();
  found.surface_to_mesh.upper += finder.tolerance();
  return found;
}

}  // namespace vdwmesh
