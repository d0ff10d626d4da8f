// Makes the framebuffer and reads it back. Depths are textures, of which two take turns when there
// are several layers: one is drawn into while the shader compares with the other.
#include "render/opengl/canvas.hpp"

namespace vdwmesh {

Canvas::Canvas(int width, int height) : width_(width), height_(height) {
  glBindFramebuffer(GL_FRAMEBUFFER, frame_.name());
  glBindRenderbuffer(GL_RENDERBUFFER, color_.name());
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_.name());
  check_gl("the picture");
  make_depths(even_depths_);
}

void Canvas::make_depths(const GlObject& texture) const {
  glActiveTexture(GL_TEXTURE2);
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, width_, height_, 0, GL_DEPTH_COMPONENT,
               GL_FLOAT, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  }
  check_gl("the depths of the picture");
}

void Canvas::begin_layer() {
  if (layers_ == 1) make_depths(odd_depths_.emplace(GlKind::texture));
  const bool is_odd = layers_ % 2 == 1;
  const GlObject& depths = is_odd ? *odd_depths_ : even_depths_;
  glActiveTexture(GL_TEXTURE2);
  // A texture that is drawn into must not be bound for reading.
  glBindTexture(GL_TEXTURE_2D, layers_ == 0 ? 0
                               : is_odd     ? even_depths_.name()
                                            : odd_depths_->name());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depths.name(), 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw Error("the OpenGL device cannot draw into 8-bit colour with float depth");
  }
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  ++layers_;
}

void Canvas::read_colors(PixelSamples& samples) const {
  samples.values.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, samples.values.data());
  check_gl("reading the picture");
}

std::vector<float> Canvas::read_depths() const {
  std::vector<float> depths(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  glReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  check_gl("reading the depths");
  return depths;
}

}  // namespace vdwmesh
