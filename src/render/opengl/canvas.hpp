// The framebuffer into which a picture is drawn, layer by layer, and what is read from it.
#pragma once

#include <optional>
#include <vector>

#include "render/opengl/gl_objects.hpp"
#include "render/opengl/samples.hpp"

namespace vdwmesh {

// A framebuffer of 8-bit colour and float depth, which stays bound. Its context must be current in
// every call.
class Canvas {
 public:
  // Sizes are in samples. Throws LimitExceeded if the device has not enough memory.
  Canvas(int width, int height);

  // Begins a layer: clears colours and depths. From the second layer on, the depths of the layer
  // before are kept in texture unit 2, for a program that draws only what is farther (depth
  // peeling; C. Everitt, "Interactive Order-Independent Transparency", NVIDIA 2001). The cleared
  // samples have alpha 0, which marks them as not covered.
  void begin_layer();
  // The colours of the layer, in place of what `samples` held.
  void read_colors(PixelSamples& samples) const;
  // The depths of the layer, row by row from the bottom: from 0 at the near plane to 1 at the far
  // plane, and 1 in samples that are not covered.
  std::vector<float> read_depths() const;

 private:
  void make_depths(const GlObject& texture) const;

  int width_, height_, layers_ = 0;
  GlObject frame_{GlKind::framebuffer};
  GlObject color_{GlKind::renderbuffer}, even_depths_{GlKind::texture};
  std::optional<GlObject> odd_depths_;  // from the second layer on
};

}  // namespace vdwmesh
