// refine_patches(): the levels of a mesh whose triangles know their patches.
//
// A level numbers the parent's edges, makes the children (children.hpp), and puts each midpoint on
// the patches of the two triangles at its edge (constrained_midpoints.hpp). The patch of a triangle
// is that of its forefather among the given triangles: triangle t of level l descends from triangle
// t / 4^l. So only the finished mesh gets an array of patches.
#include "refine/patch_refiner.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <utility>

#include "core/blocks.hpp"
#include "core/errors.hpp"
#include "refine/children.hpp"
#include "refine/crossings/constrained_midpoints.hpp"
#include "refine/crossings/patch_formulas.hpp"
#include "refine/crossings/preparation.hpp"
#include "refine/half_edges.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

// The Constraint (constrained_midpoints.hpp) of a PatchedMesh at some level: its pieces are
// patches.
class PatchConstraint {
 public:
  PatchConstraint(const SphereSet& atoms, const std::vector<SurfacePatch>& patches,
                  const std::vector<std::uint32_t>& given, int level)
      : atoms_(atoms.spheres().data()), patches_(patches), given_(given), shift_(2 * level) {}

  using Pieces = std::array<std::uint32_t, 2>;  // twice the same inside of a patch
  std::uint32_t patch_of(std::size_t t) const { return given_[t >> shift_]; }

  static bool projects() { return true; }
  Pieces pieces(const IndexedMesh&, std::size_t t, std::size_t other) const {
    return {patch_of(t), patch_of(other)};
  }
  Vec3d midpoint(const Pieces& at, const Vec3d& u, const Vec3d& v) const {
    const Vec3d middle = vdwmesh::midpoint(u, v);
    const FoundPoint found = at[0] == at[1]
                                 ? inner_midpoint(patches_[at[0]], u, v)
                                 : curve_midpoint(patches_[at[0]], patches_[at[1]], u, v);
    return found.found ? found.position : middle;
  }
  double residual(const Pieces& at, const Vec3d& p) const {
    return std::max(patch_residual(patches_[at[0]], p), patch_residual(patches_[at[1]], p));
  }
  VertexSpheres label(const Pieces& at, const Vec3d& p) const {
    SphereId nearest = kNoSphere;
    for (const std::uint32_t patch : at) {
      for (const SphereId id : patches_[patch].atoms) {
        nearest = nearer_sphere(atoms_, nearest, id, p);
      }
    }
    return on_sphere(nearest);
  }
  // Patches agree on a curve that is no crease. There the one that is no saddle is asked, because a
  // saddle's normal is not well determined near its axis.
  Vec3f normal(const Pieces& at, const Midpoints&, std::size_t, const Vec3d& p) const {
    const SurfacePatch &a = patches_[at[0]], &b = patches_[at[1]];
    if (a.kind == PatchKind::saddle) return unit_normal(patch_normal(b, p));
    if (b.kind == PatchKind::saddle || at[0] == at[1]) return unit_normal(patch_normal(a, p));
    const Vec3d sum = patch_normal(a, p) + patch_normal(b, p);
    return unit_normal(squared_norm(sum) > 1e-12 ? sum : patch_normal(a, p));
  }

  // Whether a triangle faces against the outward normal of its patch at its centroid.
  bool is_turned(const IndexedMesh& mesh, std::size_t t) const {
    const Triangle& v = mesh.triangles[t];
    const Vec3d &a = mesh.positions[v[0]], &b = mesh.positions[v[1]], &c = mesh.positions[v[2]];
    const Vec3d out = patch_normal(patches_[patch_of(t)], (1.0 / 3) * ((a + b) + c));
    return dot(cross(b - a, c - a), out) < 0;
  }

 private:
  const Sphere* atoms_;
  const std::vector<SurfacePatch>& patches_;
  const std::vector<std::uint32_t>& given_;  // by given triangle: its patch
  const int shift_;
};

std::uint64_t count_turned(const PatchConstraint& constraint, const IndexedMesh& mesh) {
  return sum_all(mesh.triangle_count(),
                 [&](std::size_t t, std::uint64_t& n) { n += constraint.is_turned(mesh, t); });
}

// Bits of doubles >= 0, read as integers, have the same order as the doubles. So an atomic maximum
// of integers finds the largest residual of a vertex, whatever the order of the threads.
ProjectionStats count_given(const PatchConstraint& constraint, const IndexedMesh& mesh,
                            Monitor* monitor) {
  Buffer<std::uint64_t> most(mesh.vertex_count());
  for_all(most.size(), [&](std::size_t v) { most[v] = 0; });
  for_all(mesh.triangle_count(), [&](std::size_t t) {
    for (const std::uint32_t v : mesh.triangles[t]) {
      const std::uint32_t patch = constraint.patch_of(t);
      const auto bits =
          std::bit_cast<std::uint64_t>(constraint.residual({patch, patch}, mesh.positions[v]));
      std::atomic_ref slot(most[v]);
      std::uint64_t old = slot.load(std::memory_order_relaxed);
      // A failed exchange reloads `old`, so the loop body is empty.
      while (old < bits && !slot.compare_exchange_weak(old, bits, std::memory_order_relaxed)) {
      }
    }
  });
  ProjectionStats stats = tally(most.size(), monitor, [&](std::size_t v, ProjectionStats& total) {
    count_residual(std::bit_cast<double>(most[v]), total);
  });
  stats.turned = count_turned(constraint, mesh);
  return stats;
}

void check(const SphereSet& atoms, const PatchedMesh& mesh, const RefineOptions& options) {
  check_refinement_size(atoms.size(), mesh.mesh.vertex_count(), mesh.mesh.triangle_count(), options,
                        TriangleLabels::spheres);
  check_mesh(atoms, mesh.mesh);
  check_patches(mesh);
  if (!mesh.vertex_patch.empty()) {
    throw InvalidInput("a mesh that does not follow the curves between patches is not refined");
  }
  for (const SurfacePatch& patch : mesh.patches) {
    for (const SphereId id : patch.atoms) {
      if (id == kNoSphere || id < atoms.size()) continue;
      throw InvalidInput(
          fmt::format("a patch names sphere {}, but the set has {}", id, atoms.size()));
    }
  }
}

IndexedMesh subdivide(const PatchConstraint& constraint, const IndexedMesh& parent,
                      Monitor* monitor, ProjectionStats& stats) {
  const Buffer<std::uint32_t> edge = number_edges(parent.opposite);
  IndexedMesh mesh;
  const Midpoints level{parent, edge, mesh};
  make_children(level, Connectivity::half_edges, mesh);
  stats = constrain_midpoints(constraint, level, mesh, monitor);
  return mesh;
}

std::vector<std::uint32_t> patches_of_children(const PatchConstraint& constraint,
                                               std::size_t triangles) {
  std::vector<std::uint32_t> patches(triangles);
  for_all(triangles, [&](std::size_t t) { patches[t] = constraint.patch_of(t); });
  return patches;
}

}  // namespace

PatchRefineResult refine_patches(const SphereSet& atoms, PatchedMesh&& given,
                                 const PatchRefineOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  RefineOptions sizes;
  sizes.subdivisions = options.subdivisions;
  sizes.memory_limit = options.memory_limit;
  check(atoms, given, sizes);
  begin_stage(options.monitor, "refine", static_cast<std::uint64_t>(options.subdivisions) + 1);
  const auto constraint_of = [&](int level) {
    return PatchConstraint(atoms, given.patches, given.triangle_patch, level);
  };
  PatchRefineResult result;
  IndexedMesh& mesh = result.mesh.mesh = std::move(given.mesh);
  if (options.subdivisions > 0) mesh.opposite = find_opposite(mesh);
  if (mesh.vertex_spheres.empty()) {
    mesh.vertex_spheres.assign(mesh.vertex_count(), on_sphere(kNoSphere));
  }
  std::chrono::steady_clock::duration observed{};
  const auto observe = [&](int level) {
    if (!options.on_level) return;
    const auto start = std::chrono::steady_clock::now();
    options.on_level(level, mesh);
    observed += std::chrono::steady_clock::now() - start;
  };
  observe(0);
  result.levels.push_back(count_given(constraint_of(0), mesh, options.monitor));
  advance(options.monitor, 1);
  for (int l = 1; l <= options.subdivisions; ++l) {
    ProjectionStats stats;
    mesh = subdivide(constraint_of(l - 1), mesh, options.monitor, stats);
    stats.turned = count_turned(constraint_of(l), mesh);
    result.levels.push_back(stats);
    observe(l);
    advance(options.monitor, 1);
  }
  result.mesh.triangle_patch =
      patches_of_children(constraint_of(options.subdivisions), mesh.triangle_count());
  result.mesh.patches = std::move(given.patches);
  const auto end = std::chrono::steady_clock::now();
  result.seconds = std::chrono::duration<double>(end - begin - observed).count();
  return result;
}

}  // namespace vdwmesh
