// Surfaces for drawing, whose vertex buffers CUDA fills in the memory of the device that draws.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/surface_source.hpp"

namespace vdwmesh {

// Shows what a MeshSource shows, which must outlive it. If OpenGL draws on the device on which CUDA
// computes, the mesh's arrays are uploaded as they are, and a kernel makes vertices of them in the
// buffers that CUDA shares with OpenGL. Otherwise, or if the driver does not share its buffers, or
// if the device has no memory for the arrays, the MeshSource fills the buffers. The bytes are the
// same either way.
class CudaSource final : public SurfaceSource {
 public:
  // `gl_device` is Renderer::cuda_device() of the renderer that draws: CUDA's number of OpenGL's
  // device, empty if that is not a CUDA device.
  CudaSource(const MeshSource& host, std::optional<int> gl_device)
      : host_(host), gl_device_(gl_device) {}

  std::vector<double> support(std::span<const Vec3d> directions) const override {
    return host_.support(directions);
  }
  Moments moments() const override { return host_.moments(); }
  std::uint64_t vertex_count() const override { return host_.vertex_count(); }
  std::uint64_t triangle_count() const override { return host_.triangle_count(); }
  PaintKind paint() const override { return host_.paint(); }
  const ColorScale* scale() const override { return host_.scale(); }
  // Throws CudaError for failures after the buffers are shared.
  void fill(SurfaceTarget& target, const Vec3d& origin) const override;

  // Why the host filled the buffers in the last fill(); empty if CUDA did.
  const std::string& obstacle() const { return obstacle_; }

 private:
  const MeshSource& host_;
  std::optional<int> gl_device_;
  mutable std::string obstacle_;
};

}  // namespace vdwmesh
