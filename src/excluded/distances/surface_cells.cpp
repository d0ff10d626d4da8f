// SurfaceCells. A cell of a sphere has a point of the patch only if no cap covers the whole cell:
// heights over a cap's plane differ by at most the chord to the middle.
#include "excluded/distances/surface_cells.hpp"

#include <algorithm>
#include <cmath>

namespace vdwmesh::excluded {
namespace {

Vec3d middle_of(const SurfaceCell& cell) {
  return unit(cell.corner[0] + cell.corner[1] + cell.corner[2]);
}

bool is_covered(const Patch& patch, const Vec3d& middle, double chord) {
  for (std::uint32_t i = 0; i < patch.cover_count; ++i) {
    const arcs::Cap& cap = patch.covers[i].cap;
    if (dot(cap.axis, middle) - chord > cap.cosine + kExposureTolerance) return true;
  }
  return false;
}

// Distance of the points of a profile from the axis, at most.
double largest_girth(double ring, double p, const ProfileAngles& range) {
  return ring - p * std::min(std::cos(range.from), std::cos(range.to));
}

}  // namespace

SurfaceCells::SurfaceCells(const JudgedSurface& surface, const ExposedSurface& accessible,
                           double probe)
    : surface_(surface), sphere_of_(accessible.list().id), probe_(probe) {
  for (Patch patch : accessible.patches()) {
    patch.ball.radius -= probe;
    spheres_.push_back(patch);
  }
  contacts_ = spheres_.size();
  const AccessibleSurface& s = surface.grown.surface;
  covers_.reserve(s.probes.size());
  for (std::uint32_t i = 0; i < s.probes.size(); ++i) {
    if (surface.included[s.probes[i].component] == 0) continue;
    const std::vector<Cover>& covers = covers_.emplace_back(surface.covers_of(i));
    spheres_.push_back({.ball = {surface.in_angstrom(s.probes[i].center), probe},
                        .place = kNoPlace,
                        .circles = 0,
                        .cover_count = static_cast<std::uint32_t>(covers.size()),
                        .corner_count = 0,
                        .covers = covers.data(),
                        .corners = nullptr});
  }
  for (std::uint32_t i = 0; i < s.arcs.size(); ++i) {
    if (s.arcs[i].dropped || !surface.includes(s.arcs[i])) continue;
    for (const ProfileAngles& range : profile_ranges(s.arcs[i])) {
      if (range.from < range.to) saddles_.push_back({i, range});
    }
  }
}

// The faces of an octahedron on each sphere.
std::vector<SurfaceCell> SurfaceCells::all() const {
  std::vector<SurfaceCell> cells;
  const auto spheres = static_cast<std::uint32_t>(spheres_.size());
  for (std::uint32_t i = 0; i < spheres; ++i) {
    for (const double x : {-1.0, 1.0}) {
      for (const double y : {-1.0, 1.0}) {
        for (const double z : {-1.0, 1.0}) {
          cells.push_back({i, {Vec3d{x, 0, 0}, Vec3d{0, y, 0}, Vec3d{0, 0, z}}});
        }
      }
    }
  }
  for (std::uint32_t i = 0; i < saddles_.size(); ++i) {
    const ProfileAngles& range = saddles_[i].profile;
    const double turn = surface_.grown.surface.arcs[saddles_[i].arc].angle;
    cells.push_back({spheres + i, {Vec3d{0, range.from, 0}, Vec3d{turn, range.to, 0}, Vec3d{}}});
  }
  return cells;
}

CellBall SurfaceCells::on_sphere(const SurfaceCell& cell) const {
  const Patch& patch = spheres_[cell.element];
  const Vec3d middle = middle_of(cell);
  double chord = 0;
  for (const Vec3d& corner : cell.corner) chord = std::max(chord, norm(corner - middle));
  CellBall ball{.middle = patch.ball.center + patch.ball.radius * middle,
                .radius = patch.ball.radius * chord,
                .on_surface = is_exposed(patch, middle)};
  ball.may_meet = ball.on_surface || !is_covered(patch, middle, chord);
  if (cell.element >= contacts_ || surface_.includes_all() || !ball.may_meet) return ball;
  // Which pieces of a ball count is told on the accessible surface.
  const double grown = patch.ball.radius + probe_;
  const Vec3d foot = patch.ball.center + grown * middle;
  const SphereId sphere = sphere_of_[patch.place];
  ball.on_surface = ball.on_surface && surface_.includes_point(sphere, foot);
  ball.may_meet = surface_.may_include(sphere, foot, grown * chord);
  return ball;
}

CellBall SurfaceCells::on_saddle(const SurfaceCell& cell) const {
  const RolledArc& arc = surface_.grown.surface.arcs[saddles_[cell.element - spheres_.size()].arc];
  const auto& [from, to, unused] = cell.corner;
  const double p = surface_.grown.surface.probe_radius;
  const double girth = largest_girth(arc.circle_radius, p, {from.y, to.y});
  return {.middle = surface_.on_saddle(arc, 0.5 * (from.x + to.x), 0.5 * (from.y + to.y)),
          .radius = surface_.unit * 0.5 * (girth * (to.x - from.x) + p * (to.y - from.y)),
          .on_surface = true};
}

CellBall SurfaceCells::ball_of(const SurfaceCell& cell) const {
  return is_sphere(cell) ? on_sphere(cell) : on_saddle(cell);
}

// A spherical triangle into four, a range of a saddle across its longer side.
void SurfaceCells::divide(const SurfaceCell& cell, std::vector<SurfaceCell>& parts) const {
  if (is_sphere(cell)) {
    const auto& [a, b, c] = cell.corner;
    const Vec3d ab = unit(a + b), bc = unit(b + c), ca = unit(c + a);
    for (const std::array<Vec3d, 3>& part : std::array<std::array<Vec3d, 3>, 4>{
             {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}}}) {
      parts.push_back({cell.element, part});
    }
    return;
  }
  const RolledArc& arc = surface_.grown.surface.arcs[saddles_[cell.element - spheres_.size()].arc];
  const double p = surface_.grown.surface.probe_radius;
  SurfaceCell first = cell, second = cell;
  Vec3d &end = first.corner[1], &start = second.corner[0];
  const Vec3d size = end - start;
  const double girth = largest_girth(arc.circle_radius, p, {cell.corner[0].y, cell.corner[1].y});
  if (girth * size.x > p * size.y) {
    end.x = start.x = 0.5 * (start.x + end.x);
  } else {
    end.y = start.y = 0.5 * (start.y + end.y);
  }
  parts.push_back(first);
  parts.push_back(second);
}

}  // namespace vdwmesh::excluded
