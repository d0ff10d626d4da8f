// Filling OpenGL buffers with CUDA; gl_fill_unavailable.cpp stands in where it is not built.
#pragma once

#include <string>

#include "render/surface_source.hpp"

namespace vdwmesh {

// Fills the buffers of `target`, whose context on this thread draws on the CUDA device `gl_device`.
// Returns an empty string, or why the buffers cannot be shared; they are untouched then. Throws
// CudaError for what fails afterwards.
std::string fill_with_cuda(const SurfaceArrays& arrays, const SurfaceTarget& target,
                           const Vec3d& origin, int gl_device);

}  // namespace vdwmesh
