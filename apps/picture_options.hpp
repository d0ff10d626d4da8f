// How pictures are drawn, as the command line says it.
#pragma once

#include <optional>
#include <string>

#include "named_files.hpp"
#include "render/renderer.hpp"

namespace CLI {
class App;
}

namespace vdwmesh::apps {

enum class ColorBy { element, distance, angle, plain };

// Bounds of a colour scale.
struct ColorRange {
  double lower, upper;
};

struct PictureOptions {
  std::string path;  // empty: none
  RenderOptions render;
  std::string view = "front";         // as named on the command line
  std::optional<ColorBy> color;       // none: by element where atoms are known, else plain
  Rgb plain{0.80f, 0.80f, 0.78f};     // of ColorBy::plain
  std::optional<ColorMap> color_map;  // none: the one that suits the values
  std::optional<ColorRange> range;    // none: from the values
};

std::string_view color_map_name(ColorMap map);

class PictureFlags {
 public:
  // --picture FILE, always by distance.
  void add_picture_to(CLI::App& verb);
  // -o FILE, and --color.
  void add_render_to(CLI::App& verb);
  // Checks that the file can be made, and that a picture can be drawn at all.
  PictureOptions resolve(NamedFiles& files) const;

 private:
  void add_style_to(CLI::App& verb);
  std::string option_without_picture() const;
  void resolve_style(PictureOptions& options) const;
  void resolve_color(PictureOptions& options) const;

  const char* file_option_ = "--picture";
  std::string path_;
  std::optional<std::string> view_, size_, background_, camera_, shading_, antialias_;
  std::optional<std::string> color_, color_map_, color_range_;
};

}  // namespace vdwmesh::apps
