// FootOracle: candidates come from a grid of the patches; a second grid of the grown atoms tells
// which feet are covered.
#include "remesh/foot_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spheres/box.hpp"

namespace vdwmesh::remesh {
namespace {

// Å: a foot that deep inside of a grown atom is not covered yet. Coordinates of a foot are rounded
// to some 1e-13 Å, and the feet of arcs lie on two spheres, those of probes on three.
constexpr double kCoverSlack = 1e-10;
constexpr int kMostSteps = 8;  // of a projection; beside a crease each gains some digits
// Widths of cells, so that lists stay short: for atoms as a share of the largest grown radius, for
// patches in Å.
constexpr double kAtomCells = 1.0 / 3, kPatchCell = 0.7;

Box grown_box(Box box, double by) {
  const Vec3d all{by, by, by};
  return {box.lower - all, box.upper + all};
}

Box box_of_mesh(const IndexedMesh& mesh) {
  Box box = empty_box();
  for (const Vec3d& p : mesh.positions) include(box, p);
  return box;
}

std::vector<Sphere> grown_by_probe(const SphereSet& atoms, double probe) {
  std::vector<Sphere> grown(atoms.spheres().begin(), atoms.spheres().end());
  for (Sphere& s : grown) s.radius += probe;
  return grown;
}

Box box_of_balls(const std::vector<Sphere>& balls) {
  Box box = empty_box();
  for (const Sphere& ball : balls) include(box, box_of(ball));
  return box;
}

double largest_radius(const std::vector<Sphere>& balls) {
  return std::ranges::max(balls, {}, &Sphere::radius).radius;
}

// The point of a patch's accessible counterpart (sphere of the grown atom, circle, probe's centre)
// that is nearest to x.
Vec3d foot_on(const SurfacePatch& patch, double probe, const Vec3d& x) {
  const Vec3d from = x - patch.center;
  if (patch.kind == PatchKind::concave) return patch.center;
  if (patch.kind == PatchKind::contact) {
    const double length = norm(from);
    return length > 0 ? patch.center + ((patch.radius + probe) / length) * from : x;
  }
  const Vec3d radial = from - dot(from, patch.axis) * patch.axis;
  const double length = norm(radial);
  return length > 0 ? patch.center + (patch.ring_radius / length) * radial : x;
}

}  // namespace

FootOracle::FootOracle(const PatchedMesh& surface, const SphereSet& atoms, double probe,
                       double reach)
    : patches_(surface.patches),
      grown_(grown_by_probe(atoms, probe)),
      probe_(probe),
      reach_(reach),
      near_(grown_box(box_of_mesh(surface.mesh), 2 * reach), std::max(kPatchCell, reach)),
      covers_(box_of_balls(grown_), kAtomCells * largest_radius(grown_)) {
  list_patches(surface);
  list_atoms();
}

void FootOracle::list_patches(const PatchedMesh& surface) {
  std::vector<std::vector<std::uint32_t>> triangles(patches_.size());
  for (std::uint32_t t = 0; t < surface.triangle_patch.size(); ++t) {
    triangles[surface.triangle_patch[t]].push_back(t);
  }
  near_.fill([&](const auto& add) {
    for (std::uint32_t patch = 0; patch < triangles.size(); ++patch) {
      for (const std::uint32_t t : triangles[patch]) {
        Box box = empty_box();
        for (const std::uint32_t v : surface.mesh.triangles[t]) {
          include(box, surface.mesh.positions[v]);
        }
        near_.visit_cells(grown_box(box, reach_),
                          [&](std::size_t cell, const Box&) { add(cell, patch); });
      }
    }
  });
}

// Most cells inside the molecule are covered by one atom; they need no list.
void FootOracle::list_atoms() {
  all_covered_.assign(covers_.cell_count(), 0);
  const auto squared_distances = [](const Vec3d& center, const Box& cell) {
    double least = 0, most = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double below = cell.lower[axis] - center[axis], above = center[axis] - cell.upper[axis];
      const double near = std::max({below, above, 0.0});
      const double far = std::max(std::abs(below), std::abs(above));
      least += near * near, most += far * far;
    }
    return std::pair(least, most);
  };
  const auto visit = [&](std::uint32_t atom, const auto& take) {
    const Sphere& ball = grown_[atom];
    covers_.visit_cells(box_of(ball), [&](std::size_t cell, const Box& box) {
      const auto [least, most] = squared_distances(ball.center, box);
      take(cell, least, most);
    });
  };
  for (std::uint32_t atom = 0; atom < grown_.size(); ++atom) {
    const double inner = grown_[atom].radius - kCoverSlack;
    visit(atom, [&](std::size_t cell, double, double most) {
      if (most < inner * inner) all_covered_[cell] = 1;
    });
  }
  covers_.fill([&](const auto& add) {
    for (std::uint32_t atom = 0; atom < grown_.size(); ++atom) {
      const double radius = grown_[atom].radius;
      visit(atom, [&](std::size_t cell, double least, double) {
        if (all_covered_[cell] == 0 && least < radius * radius) add(cell, atom);
      });
    }
  });
}

bool FootOracle::is_covered(const Vec3d& x) const {
  const std::size_t cell = covers_.cell_of(x);
  if (cell == covers_.cell_count()) return false;
  if (all_covered_[cell] != 0) return true;
  return std::ranges::any_of(covers_.at(cell), [&](std::uint32_t atom) {
    const Sphere& ball = grown_[atom];
    const double inner = ball.radius - kCoverSlack;
    return squared_norm(x - ball.center) < inner * inner;
  });
}

// A point that no grown atom covers is a place of a probe itself, more than the probe's radius
// above the surface: it is seen from the other side of its foot.
std::optional<Foot> FootOracle::nearest(const Vec3d& x, const Vec3d* hint) const {
  const std::size_t cell = near_.cell_of(x);
  if (cell == near_.cell_count()) return std::nullopt;
  const double side = probe_ < reach_ && !is_covered(x) ? -1 : 1;
  double least = std::numeric_limits<double>::infinity();
  std::optional<Foot> found;
  for (const std::uint32_t patch : near_.at(cell)) {
    const Vec3d foot = foot_on(patches_[patch], probe_, x);
    const Vec3d up = side * (foot - x);
    const double length = norm(up);
    if (!(length < least) || !(length > 0)) continue;
    if (hint && !(dot(up, *hint) > 0)) continue;
    if (patches_[patch].kind != PatchKind::concave && is_covered(foot)) continue;
    least = length;
    const Vec3d normal = (1 / length) * up;
    found = Foot{foot - probe_ * normal, normal, probe_ - side * length, patch};
  }
  return found;
}

std::optional<Foot> FootOracle::project(const Vec3d& x, const Vec3d& hint) const {
  std::optional<Foot> foot = nearest(x, &hint);
  for (int step = 0; foot && step < kMostSteps; ++step) {
    const std::optional<Foot> judged = nearest(foot->point, nullptr);
    if (!judged) return std::nullopt;
    if (std::abs(judged->height) <= kOnSurface) return foot;
    foot = nearest(foot->point, &hint);
  }
  return std::nullopt;
}

bool FootOracle::is_on_surface(const Vec3d& x) const {
  const std::optional<Foot> foot = nearest(x, nullptr);
  return foot && std::abs(foot->height) <= kOnSurface;
}

}  // namespace vdwmesh::remesh
