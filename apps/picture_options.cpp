#include "picture_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/errors.hpp"
#include "parse.hpp"

namespace vdwmesh::apps {
namespace {

constexpr View principal(const Vec3d& toward_viewer, const Vec3d& up) {
  return {ViewFrame::principal, toward_viewer, up};
}
constexpr View along(const Vec3d& toward_viewer, const Vec3d& up) {
  return {ViewFrame::coordinates, toward_viewer, up};
}

constexpr Choice<CameraProjection> kCameras[] = {{"orthographic", CameraProjection::orthographic},
                                                 {"perspective", CameraProjection::perspective}};
constexpr Choice<Shading> kShadings[] = {{"pixel", Shading::per_pixel},
                                         {"gouraud", Shading::gouraud}};
constexpr Choice<ColorMap> kColorMaps[] = {{"viridis", ColorMap::viridis},
                                           {"cividis", ColorMap::cividis},
                                           {"cool-warm", ColorMap::cool_warm}};
constexpr Choice<ColorBy> kColorings[] = {
    {"element", ColorBy::element}, {"distance", ColorBy::distance}, {"angle", ColorBy::angle}};

struct NamedView {
  std::string_view name;
  View view;
};
// Sides of the box along the principal axes, then the axes of the file.
const NamedView kViews[] = {
    {"front", principal({0, 0, 1}, {0, 1, 0})}, {"back", principal({0, 0, -1}, {0, 1, 0})},
    {"right", principal({1, 0, 0}, {0, 1, 0})}, {"left", principal({-1, 0, 0}, {0, 1, 0})},
    {"top", principal({0, 1, 0}, {0, 0, -1})},  {"bottom", principal({0, -1, 0}, {0, 0, 1})},
    {"x", along({1, 0, 0}, {0, 0, 1})},         {"-x", along({-1, 0, 0}, {0, 0, 1})},
    {"y", along({0, 1, 0}, {0, 0, 1})},         {"-y", along({0, -1, 0}, {0, 0, 1})},
    {"z", along({0, 0, 1}, {0, 1, 0})},         {"-z", along({0, 0, -1}, {0, 1, 0})},
};

// The numbers of "1,2,3"; nothing where there are not `count` of them.
std::vector<double> numbers(std::string_view option, std::string_view text, std::size_t count,
                            const char* example) {
  std::vector<double> values;
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t end = std::min(text.find(',', first), text.size());
    values.push_back(parse_number(option, text.substr(first, end - first), Range::finite, example));
    first = end + 1;
  }
  if (values.size() != count) {
    throw InvalidInput(fmt::format("{} {}: needs {} numbers with commas between, for example {}",
                                   option, text, count, example));
  }
  return values;
}

View parse_view(const std::string& text) {
  for (const NamedView& named : kViews) {
    if (named.name == text) return named.view;
  }
  if (text.find(',') == std::string::npos) {
    std::vector<std::string_view> names;
    for (const NamedView& named : kViews) names.push_back(named.name);
    names.push_back("a direction X,Y,Z");
    throw_unknown_name("--view", text, names);
  }
  const std::vector<double> d = numbers("--view", text, 3, "1,1,0.5");
  const Vec3d toward_viewer{d[0], d[1], d[2]};
  if (!(norm(toward_viewer) > 0)) {
    throw InvalidInput(fmt::format("--view {}: is no direction", text));
  }
  const bool along_z = d[0] == 0 && d[1] == 0;
  return along(toward_viewer, along_z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
}

void parse_size(const std::string& text, RenderOptions& render) {
  const std::size_t cross = std::min(text.find('x'), text.size());
  if (cross == text.size()) {
    throw InvalidInput(
        fmt::format("--size {}: needs width x height in pixels, for example 1200x900", text));
  }
  const auto side = [&](std::string_view digits) {
    return static_cast<int>(parse_integer("--size", digits, 1, kMaxPictureSide));
  };
  render.width = side(std::string_view(text).substr(0, cross));
  render.height = side(std::string_view(text).substr(cross + 1));
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// "white", "black", "grey" or "#rrggbb".
std::optional<Rgb> read_color(std::string_view text) {
  if (text == "white") return Rgb{1, 1, 1};
  if (text == "black") return Rgb{0, 0, 0};
  if (text == "grey" || text == "gray") return Rgb{0.5f, 0.5f, 0.5f};
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  float channels[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const int high = hex_digit(text[1 + 2 * i]), low = hex_digit(text[2 + 2 * i]);
    if (high < 0 || low < 0) return std::nullopt;
    channels[i] = static_cast<float>(16 * high + low) / 255;
  }
  return Rgb{channels[0], channels[1], channels[2]};
}

std::optional<Rgb> parse_background(const std::string& text) {
  if (text == "transparent") return std::nullopt;
  const std::optional<Rgb> color = read_color(text);
  if (color) return color;
  throw InvalidInput(
      fmt::format("--background {}: needs transparent, white, black, grey or #rrggbb", text));
}

ColorRange parse_range(const std::string& text) {
  const std::vector<double> bounds = numbers("--color-range", text, 2, "-0.2,0.2");
  if (!std::isfinite(bounds[1] - bounds[0])) {
    throw InvalidInput(fmt::format("--color-range {}: is too wide to be divided", text));
  }
  if (bounds[0] < bounds[1]) return {bounds[0], bounds[1]};
  throw InvalidInput(fmt::format("--color-range {}: needs the lower bound first", text));
}

void check_png(const char* option, const std::string& path, NamedFiles& files) {
  if (std::filesystem::path(path).extension() != ".png") {
    throw InvalidInput(fmt::format("{} {}: pictures are PNG; name a .png file", option, path));
  }
  files.add_output(option, path);
}

}  // namespace

std::string_view color_map_name(ColorMap map) { return name_of(map, kColorMaps); }

void PictureFlags::add_picture_to(CLI::App& verb) {
  verb.add_option("--picture", path_,
                  "PNG of the mesh, triangles coloured by the distance of their centres to the "
                  "exact surface");
  add_style_to(verb);
}

void PictureFlags::add_render_to(CLI::App& verb) {
  file_option_ = "-o";
  verb.add_option("-o,--output", path_, "the picture: .png");
  add_style_to(verb);
  verb.add_option("--color", color_,
                  "element, distance (of triangle centres to the exact surface), angle (smallest "
                  "of each triangle), or one colour: white, black, grey, #rrggbb [element; of a "
                  "MESH: grey]");
}

void PictureFlags::add_style_to(CLI::App& verb) {
  verb.add_option("--view", view_,
                  "from where: front back right left top bottom (along the principal axes), x -x y "
                  "-y z -z (along the file's), or a direction X,Y,Z [front: the broadest side]");
  verb.add_option("--size", size_, "pixels, width x height [1200x900]");
  verb.add_option("--background", background_, "transparent, white, black, grey, #rrggbb [white]");
  verb.add_option("--camera", camera_, "orthographic or perspective [orthographic]");
  verb.add_option("--shading", shading_, "pixel or gouraud [pixel]");
  verb.add_option("--antialias", antialias_, "samples along each side of a pixel, 1 to 8 [3]");
  verb.add_option("--color-map", color_map_,
                  "viridis, cividis or cool-warm [cool-warm for distances, else viridis]");
  verb.add_option("--color-range", color_range_,
                  "values at the ends of the colour map, LOWER,UPPER [what holds 99 % of them]");
}

std::string PictureFlags::option_without_picture() const {
  const std::pair<const char*, const std::optional<std::string>*> given[] = {
      {"--view", &view_},
      {"--size", &size_},
      {"--background", &background_},
      {"--camera", &camera_},
      {"--shading", &shading_},
      {"--antialias", &antialias_},
      {"--color-map", &color_map_},
      {"--color-range", &color_range_}};
  for (const auto& [name, value] : given) {
    if (*value) return name;
  }
  return {};
}

void PictureFlags::resolve_style(PictureOptions& options) const {
  RenderOptions& render = options.render;
  if (view_) {
    options.view = *view_;
    render.view = parse_view(*view_);
  }
  if (size_) parse_size(*size_, render);
  if (background_) render.background = parse_background(*background_);
  if (camera_) render.projection = choose("--camera", *camera_, kCameras);
  if (shading_) render.shading = choose("--shading", *shading_, kShadings);
  if (antialias_) {
    render.samples_per_axis = static_cast<int>(parse_integer("--antialias", *antialias_, 1, 8));
  }
}

void PictureFlags::resolve_color(PictureOptions& options) const {
  if (color_map_) options.color_map = choose("--color-map", *color_map_, kColorMaps);
  if (color_range_) options.range = parse_range(*color_range_);
  if (!color_) return;
  if (const std::optional<Rgb> plain = read_color(*color_)) {
    options.color = ColorBy::plain;
    options.plain = *plain;
    return;
  }
  for (const auto& [name, by] : kColorings) {
    if (name == *color_) options.color = by;
  }
  if (!options.color) {
    const std::string_view known[] = {"element", "distance", "angle",  "white",
                                      "black",   "grey",     "#rrggbb"};
    throw_unknown_name("--color", *color_, known);
  }
}

PictureOptions PictureFlags::resolve(NamedFiles& files) const {
  PictureOptions options;
  options.path = path_;
  if (path_.empty()) {
    const std::string orphan = option_without_picture();
    if (orphan.empty()) return options;
    throw InvalidInput(
        fmt::format("{}: says how {} FILE is drawn, and needs it", orphan, file_option_));
  }
  check_png(file_option_, path_, files);
  resolve_style(options);
  resolve_color(options);
  const Renderer available;
  return options;
}

}  // namespace vdwmesh::apps
