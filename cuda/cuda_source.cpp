// CudaSource lets fill_with_cuda() fill the buffers. If that returns an obstacle, the MeshSource
// fills them.
#include "cuda/cuda_source.hpp"

#include "cuda/pictures/gl_fill.hpp"

namespace vdwmesh {

void CudaSource::fill(SurfaceTarget& target, const Vec3d& origin) const {
  obstacle_ = gl_device_ ? fill_with_cuda(host_.arrays(), target, origin, *gl_device_)
                         : "the OpenGL device is not a CUDA device";
  if (!obstacle_.empty()) host_.fill(target, origin);
}

}  // namespace vdwmesh
