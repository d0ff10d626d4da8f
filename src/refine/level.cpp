// Midpoint subdivision (every triangle becomes four) with one projection per new vertex.
//
// subdivide() makes a finer mesh from a mesh, its parent. It numbers the parent's edges, copies the
// parent's vertices to the front of the new arrays, writes the four children of each triangle,
// makes one midpoint per edge, and takes bad moves back. A move of a vertex is bad if it turns a
// triangle against its atom's outward normal or makes two triangles cross
// (refine/crossings/bad_moves.hpp). If triangles are labelled with their spheres, no move is taken
// back: a midpoint is put on the spheres of the two triangles at its edge
// (constrained_midpoints.hpp). project_given() does the projection and the taking back for the
// vertices of the given mesh.
//
// The code that takes moves back sees all cases through views, Given, Midpoints and
// DividedMidpoints, which refer to the meshes and own nothing (refine/level_view.hpp). All loops
// are parallel. Each turn of a loop writes array entries of its own, and the counts are exact sums,
// so the result does not depend on the number of threads. cuda/refine/refine_on_device.cu takes the
// same steps on a device.
#include "refine/level.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <optional>

#include "core/blocks.hpp"
#include "refine/children.hpp"
#include "refine/crossings/bad_moves.hpp"
#include "refine/crossings/constrained_midpoints.hpp"
#include "refine/crossings/constraint_formulas.hpp"
#include "refine/crossings/vertex_moves.hpp"
#include "refine/half_edges.hpp"
#include "refine/subdivision_formulas.hpp"

namespace vdwmesh {
namespace {

// What constrained_midpoints.hpp asks of a Constraint, for a mesh whose triangles are labelled with
// a sphere each. The pieces of the surface at an edge are the spheres of its two triangles: two, or
// one if they are the same. These spheres are also the label of the edge's midpoint.
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
  // Called only if the mesh has normals. A mesh that is projected has none until refine() has made
  // its last level, and computes them from the surface then.
  static Vec3f normal(const Pieces&, const Midpoints& level, std::size_t h, const Vec3d&) {
    return level.mean_normal(h);
  }
  double residual(const Pieces& pieces, const Vec3d& p) const {
    return sphere_residual(spheres_, pieces, p);
  }

 private:
  const Sphere* spheres_;
  bool projects_;
};

// The ends of the parent's half-edge h.
EdgeEnds ends_of(const Midpoints& level, std::size_t h) {
  const IndexedMesh& parent = level.parent;
  const std::uint32_t a = level.start_of(h), b = level.end_of(h);
  return {parent.positions[a], parent.positions[b], parent.vertex_spheres.atoms[a],
          parent.vertex_spheres.atoms[b]};
}

// Gives vertex v of the mesh its place, and returns what has become of it.
MoveState put(const PlacedVertex& placed, std::size_t v, IndexedMesh& mesh) {
  mesh.positions[v] = placed.position;
  mesh.vertex_spheres.set(v, placed.label);
  return placed.state;
}

// Makes all midpoints of a mesh without triangle labels: projects them and takes bad moves back.
ProjectionStats project_midpoints(const SphereSet& spheres, const SurfaceView& surface,
                                  const Midpoints& level, ParentOrigin origin, IndexedMesh& mesh,
                                  const RefineOptions& options) {
  // These numbers and this position are used below:
  //   h, an item of `level`    a half-edge of the parent
  //   handled_by_item(h)       its edge, if h is the lower half-edge of it; otherwise nothing
  //   midpoint_of(h)           the vertex at the middle of the edge
  //   middle_of(h)             a position: the middle between the edge's ends
  const Sphere* balls = spheres.spheres().data();
  Buffer<MoveState> move_states(level.items() / 2);  // by edge: two half-edges each
  ProjectionStats stats =
      tally(level.items(), options.monitor, [&](std::size_t h, ProjectionStats& total) {
        const std::optional<std::size_t> i = level.handled_by_item(h);
        if (!i) return;  // h is the upper half-edge of its edge; the lower one makes the midpoint
        // Only a mesh that is not projected has normals: prepare_mesh() removes the others.
        if (!mesh.normals.empty()) mesh.normals[level.midpoint_of(h)] = level.mean_normal(h);
        move_states[*i] = put(place_midpoint(surface, balls, ends_of(level, h), total),
                              level.midpoint_of(h), mesh);
      });
  if (surface.projection == Projection::none) return stats;
  const auto restore = [&](std::size_t h) {
    const std::uint32_t v = level.midpoint_of(h);
    mesh.positions[v] = level.middle_of(h);
    mesh.vertex_spheres.set(v, ends_of(level, h).unprojected_label(balls));
  };
  stats.undone =
      origin == ParentOrigin::given
          ? take_back_bad_moves(spheres, level, move_states, options, restore)
          : take_back_bad_moves(spheres, DividedMidpoints{level}, move_states, options, restore);
  // A vertex that was put back had moved, so it had converged and was counted as projected.
  stats.projected -= stats.undone;
  return stats;
}

}  // namespace

ProjectionStats project_given(const SphereSet& spheres, const SurfaceView& surface,
                              IndexedMesh& mesh, const RefineOptions& options) {
  ProjectionStats stats;
  const bool constrained = mesh.triangle_labels() == TriangleLabels::spheres;
  if (constrained && surface.projection != Projection::none) {
    // The given vertices of a mesh with labelled triangles stay where they are.
    const SphereConstraint constraint(spheres, surface.projection);
    stats = tally(mesh.vertex_count(), options.monitor, [&](std::size_t v, ProjectionStats& total) {
      count_residual(constraint.residual(mesh.vertex_spheres[v], mesh.positions[v]), total);
    });
  } else if (surface.projection != Projection::none) {
    // Copies, from which vertices are put back.
    const Buffer<Vec3d> positions = mesh.positions;
    const VertexLabels labels = mesh.vertex_spheres;
    Buffer<MoveState> move_states(mesh.vertex_count());
    const Buffer<std::uint64_t> squares = longest_edge_squares(mesh);
    stats = tally(mesh.vertex_count(), options.monitor, [&](std::size_t v, ProjectionStats& total) {
      // A vertex may move by at most the length of its longest edge. The squares are bits of
      // doubles, of which threads take the maximum as integers (vertex_moves.hpp).
      const double reach = std::sqrt(std::bit_cast<double>(squares[v]));
      move_states[v] = put(place_given(surface, positions[v], labels[v], reach, total), v, mesh);
    });
    const Given level{positions, mesh};
    stats.undone = take_back_bad_moves(spheres, level, move_states, options, [&](std::size_t v) {
      mesh.positions[v] = positions[v];
      mesh.vertex_spheres.set(v, labels[v]);
    });
    stats.projected -= stats.undone;
  }
  stats.turned = count_turned(spheres.spheres().data(), mesh, mesh.triangle_count());
  return stats;
}

SubdividedMesh subdivide(const SphereSet& spheres, const SurfaceView& surface,
                         const IndexedMesh& parent, ParentOrigin origin, Connectivity connectivity,
                         const RefineOptions& options) {
  const Buffer<std::uint32_t> edge = number_edges(parent.opposite);
  SubdividedMesh child;  // the finer mesh
  IndexedMesh& mesh = child.mesh;
  const Midpoints level{parent, edge, mesh};
  make_children(level, connectivity, mesh);
  child.stats = parent.triangle_labels() == TriangleLabels::spheres
                    ? constrain_midpoints(SphereConstraint(spheres, surface.projection), level,
                                          mesh, options.monitor)
                    : project_midpoints(spheres, surface, level, origin, mesh, options);
  child.stats.turned = count_turned(spheres.spheres().data(), mesh, mesh.triangle_count());
  return child;
}

}  // namespace vdwmesh
