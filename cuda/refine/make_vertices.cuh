// Launches of the kernels that compute positions, labels and normals of vertices, by projection or
// under the constraints of labelled triangles. refine_on_device() calls them level by level.
#pragma once

#include "cuda/refine/bad_moves.cuh"

namespace vdwmesh {

// Level 0 of a mesh without triangle labels: projects its vertices in place and takes bad moves
// back. If the mesh has an array of normals, fills it with the surface's normals. Adds the outcomes
// to `stats` and returns the number of moves taken back; `stats` still counts their vertices as
// projected.
std::uint64_t project_given_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                                      const RefineOptions& options, std::uint64_t pairs_at_once,
                                      DeviceStats* stats, const Stream& stream);

// Level 0 of a mesh with labelled triangles: moves nothing, and counts which vertices lie on all
// the spheres of their labels.
void count_constrained_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                                 DeviceStats* stats, const Stream& stream);

// Makes the midpoints of a level of a mesh without triangle labels: positions, labels and
// move_states (by edge number), and the regular marks of PatchMarks if they are kept. A midpoint
// whose projection fails stays in the middle of its edge. If the mesh has normals, midpoints get
// the surface's normals; with Projection::none they get the mean normals of their edges' ends.
void make_midpoints_on_device(const SurfaceView& surface, const MidpointLevel& level,
                              MoveState* move_states, DeviceStats* stats, const Stream& stream);

// The same for a mesh with labelled triangles: each midpoint goes to the sphere or circle of the
// two triangles at its edge (refine/crossings/constraint_formulas.hpp). No move of such a midpoint
// is taken back, so it has no state.
void make_constrained_midpoints_on_device(const SurfaceView& surface, const MidpointLevel& level,
                                          DeviceStats* stats, const Stream& stream);

// Fills mesh.normals with the surface's normals at all vertices. Precondition: mesh.normals is not
// null.
void compute_normals_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                               const Stream& stream);

}  // namespace vdwmesh
