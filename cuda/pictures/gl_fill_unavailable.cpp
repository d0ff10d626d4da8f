// Of a build without a CUDA compiler or without OpenGL.
#include "cuda/pictures/gl_fill.hpp"

namespace vdwmesh {

std::string fill_with_cuda(const SurfaceArrays&, const SurfaceTarget&, const Vec3d&, int) {
  return "this build has no CUDA-OpenGL interoperation";
}

}  // namespace vdwmesh
