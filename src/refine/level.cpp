// Midpoint subdivision (every triangle becomes four) with one projection per new vertex.
//
// subdivide() makes a finer mesh from a mesh, its parent. It numbers the parent's edges, copies the
// parent's vertices to the front of the new arrays, writes the four children of each triangle,
// makes one midpoint per edge, and takes bad moves back. A move of a vertex is bad if it turns a
// triangle against its atom's outward normal or makes two triangles cross (refine/bad_moves.hpp).
// project_given() does the projection and the taking back for the vertices of the given mesh.
//
// The code that takes moves back sees both cases through views, Midpoints and Given, which refer to
// the meshes and own nothing (refine/level_view.hpp). All loops are parallel. Each turn of a loop
// writes array entries of its own, and the counts are exact sums, so the result does not depend on
// the number of threads. cuda/refine/refine_on_device.cu takes the same steps on a device.
#include "refine/level.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "core/blocks.hpp"
#include "refine/bad_moves.hpp"
#include "refine/children.hpp"
#include "refine/constrained_midpoints.hpp"
#include "refine/constraint_formulas.hpp"
#include "refine/half_edges.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

void count_outcome(const ProjectedPoint& p, ProjectionStats& stats) {
  stats.iterations_max = std::max(stats.iterations_max, p.steps);
  switch (p.outcome) {
    case ProjectionOutcome::converged:
      ++stats.projected;
      stats.residual_max = std::max(stats.residual_max, p.residual);
      break;
    case ProjectionOutcome::unconverged:
      ++stats.unconverged;
      break;
    case ProjectionOutcome::out_of_reach:
      ++stats.out_of_reach;
      break;
  }
}

VertexSpheres label_of(const ProjectedPoint& p) {
  return {p.spheres[0], p.spheres[1], p.spheres[2]};
}

// The number of triangles that do not face outward, as facing() judges them: against the normal of
// their own sphere if triangles are labelled, and otherwise against the normals of the atoms of
// their corners. ProjectionStats::turned reports it.
std::uint64_t count_turned(const SphereSet& spheres, const IndexedMesh& mesh) {
  const bool labelled = mesh.triangle_labels() == TriangleLabels::spheres;
  const auto count = [&](std::size_t t, std::uint64_t& n) {
    std::array<Vec3d, 3> p;
    std::array<SphereId, 3> atom;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = mesh.positions[mesh.triangles[t][k]];
      atom[k] =
          labelled ? mesh.triangle_spheres[t] : mesh.vertex_spheres.atoms[mesh.triangles[t][k]];
    }
    n += facing(spheres.spheres().data(), p.data(), atom.data()) != Facing::outward;
  };
  return sum_all(mesh.triangle_count(), count);
}

// For each vertex, the square of the length (Å) of its longest edge, as the bits of a double. Bits
// of doubles >= 0, read as integers, have the same order as the doubles. So an atomic maximum of
// integers finds the largest square, and it does not depend on the order of the threads.
Buffer<std::uint64_t> longest_edge_squares(const IndexedMesh& mesh) {
  Buffer<std::uint64_t> square(mesh.vertex_count());
  for_all(square.size(), [&](std::size_t v) { square[v] = 0; });
  const auto raise = [&](std::uint32_t v, std::uint64_t bits) {
    std::atomic_ref slot(square[v]);
    std::uint64_t old = slot.load(std::memory_order_relaxed);
    // A failed exchange reloads `old`, so the loop body is empty.
    while (old < bits && !slot.compare_exchange_weak(old, bits, std::memory_order_relaxed)) {
    }
  };
  for_all(mesh.triangle_count(), [&](std::size_t t) {
    const Triangle& v = mesh.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      const double s = squared_distance(mesh.positions[a], mesh.positions[b]);
      raise(a, std::bit_cast<std::uint64_t>(s));
      raise(b, std::bit_cast<std::uint64_t>(s));
    }
  });
  return square;
}

// The surface of a mesh whose triangles are labelled with their spheres, as
// constrained_midpoints.hpp wants it. The pieces at an edge are the label of its midpoint.
class SphereConstraint {
 public:
  SphereConstraint(const SphereSet& spheres, Projection projection)
      : spheres_(spheres.spheres().data()), projects_(projection != Projection::none) {}

  using Pieces = VertexSpheres;
  bool projects() const { return projects_; }
  static Pieces pieces(const IndexedMesh& parent, std::size_t t, std::size_t other) {
    return edge_label(parent.triangle_spheres[t], parent.triangle_spheres[other]);
  }
  Vec3d midpoint(const Pieces& pieces, const Vec3d& u, const Vec3d& v) const {
    return constrained_midpoint(spheres_, pieces.data(), u, v);
  }
  static VertexSpheres label(const Pieces& pieces, const Vec3d&) { return pieces; }
  // Only a mesh that is not projected has normals here; the others get theirs at the end.
  static Vec3f normal(const Pieces&, const Midpoints& level, std::size_t h, const Vec3d&) {
    return level.mean_normal(h);
  }
  // Infinite if the label names no sphere.
  double residual(const Pieces& pieces, const Vec3d& p) const {
    if (pieces[0] == kNoSphere) return std::numeric_limits<double>::infinity();
    return label_residual(spheres_, pieces.data(), p);
  }

 private:
  const Sphere* spheres_;
  bool projects_;
};

// Projects vertex v of the given mesh, which may move it by at most `reach` (Å), and counts the
// outcome. Returns `moved` if the position has changed. A vertex that is on the surface already
// (`steps` is 0) keeps its position, and also its label, if it lies on all the spheres that the
// label names. A vertex whose projection fails keeps both.
MoveState project_vertex(const TargetSurface& surface, std::size_t v, double reach,
                         IndexedMesh& mesh, ProjectionStats& stats) {
  const ProjectedPoint p = surface.project(mesh.positions[v], reach);
  count_outcome(p, stats);
  if (p.outcome != ProjectionOutcome::converged) return MoveState::stayed;
  mesh.positions[v] = p.position;
  const bool keeps_label = p.steps == 0 && surface.on_label(p.position, mesh.vertex_spheres[v]);
  if (!keeps_label) mesh.vertex_spheres.set(v, label_of(p));
  return p.steps > 0 ? MoveState::moved : MoveState::stayed;
}

// Makes the midpoint of half-edge h, for a mesh without triangle labels, and counts the outcome. If
// the projection fails, or there is none, the midpoint stays in the middle of its edge. It is then
// labelled with one of the atoms of the edge's ends, the atom whose sphere is nearer to it.
MoveState make_midpoint(const SphereSet& spheres, const TargetSurface& surface,
                        const Midpoints& level, std::size_t h, IndexedMesh& mesh,
                        ProjectionStats& stats) {
  const std::uint32_t v = level.midpoint_of(h);
  const Vec3d start = level.start(h);
  if (surface.projection() != Projection::none) {
    const ProjectedPoint p =
        surface.project(start, midpoint_reach(level.parent.positions[level.start_of(h)],
                                              level.parent.positions[level.end_of(h)]));
    count_outcome(p, stats);
    if (p.outcome == ProjectionOutcome::converged) {
      mesh.positions[v] = p.position;
      mesh.vertex_spheres.set(v, label_of(p));
      return p.steps > 0 ? MoveState::moved : MoveState::stayed;
    }
  }
  mesh.positions[v] = start;
  mesh.vertex_spheres.set(v, level.unprojected_label(spheres.spheres().data(), h));
  return MoveState::stayed;
}

// Makes all midpoints of a mesh without triangle labels: projects them and takes bad moves back.
ProjectionStats project_midpoints(const SphereSet& spheres, const TargetSurface& surface,
                                  const Midpoints& level, IndexedMesh& mesh,
                                  const RefineOptions& options) {
  Buffer<MoveState> move_states(level.items() / 2);  // by edge: two half-edges each
  ProjectionStats stats =
      tally(level.items(), options.monitor, [&](std::size_t h, ProjectionStats& total) {
        const std::optional<std::size_t> i = level.handled_by_item(h);
        if (!i) return;  // the opposite half-edge stands for the midpoint
        // Only a mesh that is not projected has normals: prepare_mesh() removes the others.
        if (!mesh.normals.empty()) mesh.normals[level.midpoint_of(h)] = level.mean_normal(h);
        move_states[*i] = make_midpoint(spheres, surface, level, h, mesh, total);
      });
  if (surface.projection() == Projection::none) return stats;
  stats.undone = take_back_bad_moves(spheres, level, move_states, options, [&](std::size_t h) {
    const std::uint32_t v = level.midpoint_of(h);
    mesh.positions[v] = level.start(h);
    mesh.vertex_spheres.set(v, level.unprojected_label(spheres.spheres().data(), h));
  });
  // A vertex that was put back had moved, so it had converged and was counted as projected.
  stats.projected -= stats.undone;
  return stats;
}

}  // namespace

ProjectionStats project_given(const SphereSet& spheres, const TargetSurface& surface,
                              IndexedMesh& mesh, const RefineOptions& options) {
  ProjectionStats stats;
  const bool constrained = mesh.triangle_labels() == TriangleLabels::spheres;
  if (constrained && surface.projection() != Projection::none) {
    // The given vertices of a mesh with labelled triangles stay where they are.
    const SphereConstraint constraint(spheres, surface.projection());
    stats = tally(mesh.vertex_count(), options.monitor, [&](std::size_t v, ProjectionStats& total) {
      count_residual(constraint.residual(mesh.vertex_spheres[v], mesh.positions[v]), total);
    });
  } else if (surface.projection() != Projection::none) {
    // Copies, from which vertices are put back.
    const Buffer<Vec3d> positions = mesh.positions;
    const VertexLabels labels = mesh.vertex_spheres;
    Buffer<MoveState> move_states(mesh.vertex_count());
    const Buffer<std::uint64_t> squares = longest_edge_squares(mesh);
    stats = tally(mesh.vertex_count(), options.monitor, [&](std::size_t v, ProjectionStats& total) {
      const double reach = std::sqrt(std::bit_cast<double>(squares[v]));
      move_states[v] = project_vertex(surface, v, reach, mesh, total);
    });
    const Given level{positions, mesh};
    stats.undone = take_back_bad_moves(spheres, level, move_states, options, [&](std::size_t v) {
      mesh.positions[v] = positions[v];
      mesh.vertex_spheres.set(v, labels[v]);
    });
    stats.projected -= stats.undone;
  }
  stats.turned = count_turned(spheres, mesh);
  return stats;
}

SubdividedMesh subdivide(const SphereSet& spheres, const TargetSurface& surface,
                         const IndexedMesh& parent, const RefineOptions& options) {
  const Buffer<std::uint32_t> edge = number_edges(parent.opposite);
  SubdividedMesh child;  // the finer mesh
  IndexedMesh& mesh = child.mesh;
  const Midpoints level{parent, edge, mesh};
  make_children(level, mesh);
  child.stats = parent.triangle_labels() == TriangleLabels::spheres
                    ? constrain_midpoints(SphereConstraint(spheres, surface.projection()), level,
                                          mesh, options.monitor)
                    : project_midpoints(spheres, surface, level, mesh, options);
  child.stats.turned = count_turned(spheres, mesh);
  return child;
}

}  // namespace vdwmesh
