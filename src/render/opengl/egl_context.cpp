// Opens an OpenGL context through EGL.
//
// Steps: (1) list the displays that need no window: one per EGL device (EGL_EXT_platform_device),
// then Mesa's surfaceless platform. (2) Take the first display on which an OpenGL 3.3 core context
// without a surface can be made current. Drivers differ in what they advertise, so extension
// functions are looked up by name, and after a failure the next display is tried. If all displays
// fail, the error lists the reason of each.
#include "render/opengl/egl_context.hpp"

#include <dlfcn.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <string_view>
#include <utility>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// Returns whether a list of extensions, separated by spaces, contains a name. `extensions` may be
// null, which is an empty list. The spaces around both make sure that only whole names match.
bool lists(const char* extensions, std::string_view name) {
  const std::string padded = fmt::format(" {} ", extensions ? extensions : "");
  return padded.find(fmt::format(" {} ", name)) != std::string::npos;
}

// Looks up an extension function; null if it is missing. epoxy's own wrappers would end the program
// in this case.
template <class Function>
Function address_of(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool has_library(const char* name) {
  void* library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
  if (library != nullptr) dlclose(library);
  return library != nullptr;
}

// epoxy opens the libraries at the first call of a function of theirs, and ends the program if
// there are none: so they are looked for before. The message names three packages, because there is
// no single one that brings them all.
void require_libraries() {
  constexpr const char* kPackages =
      "Debian's packages libegl1, libopengl0 and libgl1-mesa-dri draw without a GPU";
  if (!epoxy_has_egl()) {
    throw BackendUnavailable(fmt::format("no pictures: there is no libEGL.so.1; {}", kPackages));
  }
  if (!has_library("libOpenGL.so.0") && !has_library("libGL.so.1")) {
    throw BackendUnavailable(
        fmt::format("no pictures: there is neither libOpenGL.so.0 nor libGL.so.1; {}", kPackages));
  }
}

using NamedDisplay = std::pair<EGLDisplay, std::string>;

// Returns one display per EGL device, in the order of EGL; none if the extensions are missing. Mesa
// lists hardware before its software rasterizer. Some drivers advertise only EGL_EXT_device_base,
// which includes EGL_EXT_device_enumeration.
std::vector<NamedDisplay> device_displays(const char* extensions) {
  const bool devices =
      lists(extensions, "EGL_EXT_device_base") || lists(extensions, "EGL_EXT_device_enumeration");
  const auto query = address_of<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto get = address_of<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  EGLint count = 0;
  if (!devices || !query || !get || !query(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> found(static_cast<std::size_t>(count));
  if (!query(count, found.data(), &count)) return {};
  std::vector<NamedDisplay> displays;
  displays.reserve(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    displays.emplace_back(get(EGL_PLATFORM_DEVICE_EXT, found[i], nullptr),
                          fmt::format("EGL device {}", i));
  }
  return displays;
}

// All displays to be tried, in order.
std::vector<NamedDisplay> displays_without_window() {
  const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
  std::vector<NamedDisplay> displays = device_displays(extensions);
  const auto get = address_of<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  if (get && lists(extensions, "EGL_MESA_platform_surfaceless")) {
    displays.emplace_back(get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
                          "surfaceless platform");
  }
  return displays;
}

// Throws BackendUnavailable with the name of the function that failed and EGL's error.
[[noreturn]] void fail(const char* what) {
  throw BackendUnavailable(
      fmt::format("{} failed (EGL error {:#x})", what, static_cast<unsigned>(eglGetError())));
}

// Returns the first configuration with desktop OpenGL. EGL_SURFACE_TYPE is 0, because no EGL
// surface is needed; by default EGL chooses only configurations that support windows.
EGLConfig choose_config(EGLDisplay display) {
  const EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig config{};
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, &config, 1, &count)) fail("eglChooseConfig");
  if (count == 0) throw BackendUnavailable("no configuration with desktop OpenGL");
  return config;
}

}  // namespace

EglContext::EglContext() {
  require_libraries();
  std::string reasons;
  for (const auto& [display, name] : displays_without_window()) {
    if (try_open(display, name, reasons)) return;
  }
  throw BackendUnavailable(fmt::format(
      "no pictures: EGL gives no OpenGL 3.3 context without a display ({}); Debian's software "
      "driver is in libegl-mesa0 and libgl1-mesa-dri",
      reasons.empty() ? "no device and no surfaceless platform" : reasons));
}

EglContext::~EglContext() { close(); }

// Opens a display, or appends the reason why this failed to `reasons`.
bool EglContext::try_open(EGLDisplay display, const std::string& name, std::string& reasons) {
  try {
    open(display);
    return true;
  } catch (const BackendUnavailable& error) {
    close();
    reasons += fmt::format("{}{}: {}", reasons.empty() ? "" : "; ", name, error.what());
    return false;
  }
}

void EglContext::open(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY) fail("eglGetPlatformDisplayEXT");
  if (!eglInitialize(display, nullptr, nullptr)) fail("eglInitialize");
  display_ = display;
  const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
  if (!lists(extensions, "EGL_KHR_surfaceless_context")) {
    throw BackendUnavailable("no EGL_KHR_surfaceless_context");
  }
  if (!eglBindAPI(EGL_OPENGL_API)) fail("eglBindAPI");
  const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION_KHR,
                               3,
                               EGL_CONTEXT_MINOR_VERSION_KHR,
                               3,
                               EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR,
                               EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR,
                               EGL_NONE};
  context_ = eglCreateContext(display, choose_config(display), EGL_NO_CONTEXT, attributes);
  if (context_ == EGL_NO_CONTEXT) fail("eglCreateContext");
  const Use use(*this);
  const auto text = [](GLenum name) { return reinterpret_cast<const char*>(glGetString(name)); };
  device_ = fmt::format("{}, OpenGL {}", text(GL_RENDERER), text(GL_VERSION));
}

void EglContext::close() {
  if (display_ == EGL_NO_DISPLAY) return;
  if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
  // A display belongs to the whole process, and other code may use it. So it is not terminated.
  context_ = EGL_NO_CONTEXT;
  display_ = EGL_NO_DISPLAY;
}

EglContext::Use::Use(const EglContext& context) : display_(context.display_) {
  // Each thread has its own bound API, and this thread may not be the one that opened the context.
  eglBindAPI(EGL_OPENGL_API);
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_)) {
    fail("eglMakeCurrent");
  }
}

EglContext::Use::~Use() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

}  // namespace vdwmesh
