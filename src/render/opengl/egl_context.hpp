// An OpenGL context that needs no window and no display server (EGL).
#pragma once

#include <epoxy/egl.h>

#include <memory>
#include <string>

namespace vdwmesh {

// An OpenGL 3.3 core context without a surface: drawing goes to framebuffer objects. It may be used
// by any thread, but by one at a time.
class EglContext {
 public:
  // Opens the context. Throws BackendUnavailable, with a reason for each way that was tried.
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  // Makes the context current on this thread for its own lifetime.
  class Use {
   public:
    explicit Use(const EglContext& context);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    EGLDisplay display_;
  };

  // Name of the device and version of OpenGL.
  const std::string& device() const { return device_; }

 private:
  void open(EGLDisplay display);
  bool try_open(EGLDisplay display, const std::string& name, std::string& reasons);
  void close();

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string device_;
};

}  // namespace vdwmesh
