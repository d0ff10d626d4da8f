// An OpenGL context without a window.
#pragma once

#include <epoxy/egl.h>

#include <memory>
#include <optional>
#include <string>

namespace vdwmesh {

class EglContext {
 public:
  // Throws BackendUnavailable with the reason of every way that was tried.
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  // Current on this thread while one of these lives.
  class Use {
   public:
    explicit Use(const EglContext& context);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    EGLDisplay display_;
  };

  const std::string& device() const { return device_; }
  // See Renderer::cuda_device().
  std::optional<int> cuda_device() const { return cuda_device_; }

 private:
  void open(EGLDisplay display);
  bool try_open(EGLDisplay display, const std::string& name, std::string& reasons);
  void close();

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string device_;
  std::optional<int> cuda_device_;
};

}  // namespace vdwmesh
