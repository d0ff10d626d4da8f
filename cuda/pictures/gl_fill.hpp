// Filling OpenGL buffers with CUDA; gl_fill_unavailable.cpp stands in where it is not built.
#pragma once

#include <string>

#include "render/surface_source.hpp"

namespace vdwmesh {

// Fills the buffers of `target`, whose context on this thread draws on the CUDA device `gl_device`.
// Returns an empty string, or why CUDA cannot fill them: they cannot be shared, or the device has
// no memory for what is on its way into them. Their content is undefined then, and they are
// OpenGL's again. Throws CudaError for what else fails once they are shared.
std::string fill_with_cuda(const SurfaceArrays& arrays, const SurfaceTarget& target,
                           const Vec3d& origin, int gl_device);

}  // namespace vdwmesh
