// Fills OpenGL buffers with CUDA, so that a mesh need not be converted on the host. CudaSource
// calls it. gl_fill_unavailable.cpp replaces gl_fill.cu in builds without a CUDA compiler or
// without OpenGL.
#pragma once

#include <string>

#include "render/surface_source.hpp"

namespace vdwmesh {

// Fills the buffers of `target`. The OpenGL context of `target` must be current on this thread and
// draw on the CUDA device with number `gl_device`. Vertices are written relative to `origin`.
//
// Returns an empty string if the buffers are filled. Otherwise returns why CUDA cannot fill them:
// it cannot share them, or the device lacks memory for the uploads. The buffers then belong to
// OpenGL again, with undefined content, and the caller can fill them in another way. Throws
// CudaError for any other failure after the buffers are shared.
std::string fill_with_cuda(const SurfaceArrays& arrays, const SurfaceTarget& target,
                           const Vec3d& origin, int gl_device);

}  // namespace vdwmesh
