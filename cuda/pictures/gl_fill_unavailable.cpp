// Replaces gl_fill.cu in a build without a CUDA compiler or without OpenGL: the reason is always
// the same.
#include "cuda/pictures/gl_fill.hpp"

namespace vdwmesh {

std::string fill_with_cuda(const SurfaceArrays&, const SurfaceTarget&, const Vec3d&, int) {
  return "this build has no CUDA-OpenGL interoperation";
}

}  // namespace vdwmesh
