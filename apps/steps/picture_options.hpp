// How pictures are drawn, and how the command line says it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/renderer.hpp"

namespace vdwmesh::apps {

// The kind of patch and the curvatures are those of --surface ses. `residue` is the kind of
// residue, `hydropathy` Kyte and Doolittle's, `exposure` the relative accessible area of the
// residue.
enum class ColorBy {
  element,
  chain,
  residue,
  hydropathy,
  exposure,
  b_factor,
  distance,
  angle,
  kind,
  mean_curvature,
  gaussian_curvature,
  plain,
};

constexpr bool is_of_patches(ColorBy color) {
  return color == ColorBy::kind || color == ColorBy::mean_curvature ||
         color == ColorBy::gaussian_curvature;
}

// What atoms alone know, which mesh files do not have.
constexpr bool is_of_atoms(ColorBy color) { return color <= ColorBy::b_factor; }

// The width of --outline: 2 pixels of 900.
inline constexpr double kUsualOutline = 1.0 / 450;

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
  bool ambient_occlusion = false;     // else light from one side, and an even rest
};

// Each reads the text of one option into its place in the options. They throw InvalidInput that
// names the option, what was given and what would be accepted.

// A side of the molecule, an axis of the file, or a direction X,Y,Z. All but directions have names.
std::vector<std::string_view> names_of_views();
void read_view(std::string_view option, const std::string& text, PictureOptions& options);
// "1200x900", in pixels.
void read_size(std::string_view option, const std::string& text, PictureOptions& options);
// "transparent", "white", "black", "grey" or "#rrggbb".
void read_background(std::string_view option, const std::string& text, PictureOptions& options);
// A share from 0 to below 1, or percent with the sign.
void read_transparency(std::string_view option, const std::string& text, PictureOptions& options);
// What colours show, or one colour.
void read_color(std::string_view option, const std::string& text, PictureOptions& options);
// "LOWER,UPPER".
void read_color_range(std::string_view option, const std::string& text, PictureOptions& options);

}  // namespace vdwmesh::apps
