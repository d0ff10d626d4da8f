// Where the vertices of a level go.
#pragma once

#include "cuda/refine/bad_moves.cuh"

namespace vdwmesh {

// Projects the given vertices of a mesh without labels of triangles, and takes bad moves back.
// Where the mesh has normals they are those of the surface afterwards. Returns how many moves went
// back.
std::uint64_t project_given_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                                      Crossings crossings, Monitor* monitor, DeviceStats* stats,
                                      const Stream& stream);

// Counts how far vertices are from the spheres that they must lie on.
void count_constrained_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                                 DeviceStats* stats, const Stream& stream);

// Makes the midpoints of a level, projected where that succeeds: positions, labels, fates, and
// normals where the mesh has them: of the surface, or interpolated without one.
void make_midpoints_on_device(const SurfaceView& surface, const MidpointLevel& level, Fate* fates,
                              DeviceStats* stats, const Stream& stream);

// The same on the spheres of the triangles on both sides; nothing moves freely.
void make_constrained_midpoints_on_device(const SurfaceView& surface, const MidpointLevel& level,
                                          DeviceStats* stats, const Stream& stream);

// Normals of all vertices, of the surface.
void compute_normals_on_device(const SurfaceView& surface, const DeviceMeshView& mesh,
                               const Stream& stream);

}  // namespace vdwmesh
