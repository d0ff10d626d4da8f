// Reads the values of the options of pictures: views, sizes, colours and ranges. Views are a table
// of names, two sets of six sides, and directions that are written as three numbers; colours are
// three names and hexadecimal digits.
#include "steps/picture_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "command_line/parse.hpp"
#include "core/errors.hpp"
#include "request/names.hpp"
#include "request/refuse.hpp"

namespace vdwmesh::apps {
namespace {

constexpr View principal(const Vec3d& toward_viewer, const Vec3d& up) {
  return {ViewFrame::principal, toward_viewer, up};
}
constexpr View along(const Vec3d& toward_viewer, const Vec3d& up) {
  return {ViewFrame::coordinates, toward_viewer, up};
}

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
  refuse_if(values.size() != count, "{} {}: needs {} numbers with commas between, for example {}",
            option, text, count, example);
  return values;
}

// A direction may be of any length. Up is along z, but for those who look along z.
View view_of(std::string_view option, const std::string& text) {
  for (const NamedView& named : kViews) {
    if (named.name == text) return named.view;
  }
  if (text.find(',') == std::string::npos) {
    std::vector<std::string_view> names = names_of_views();
    names.push_back("a direction X,Y,Z");
    throw_unknown_name(option, text, names);
  }
  const std::vector<double> d = numbers(option, text, 3, "1,1,0.5");
  const Vec3d toward_viewer{d[0], d[1], d[2]};
  refuse_if(!(norm(toward_viewer) > 0), "{} {}: is no direction", option, text);
  const bool along_z = d[0] == 0 && d[1] == 0;
  return along(toward_viewer, along_z ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1});
}

// "white", "black", "grey" or "#rrggbb".
std::optional<Rgb> color_of(std::string_view text) {
  if (text == "white") return Rgb{1, 1, 1};
  if (text == "black") return Rgb{0, 0, 0};
  if (text == "grey" || text == "gray") return Rgb{0.5f, 0.5f, 0.5f};
  if (text.size() != 7 || text[0] != '#') return std::nullopt;
  unsigned digits = 0;
  const char *begin = text.data() + 1, *end = begin + 6;
  if (std::from_chars(begin, end, digits, 16).ptr != end) return std::nullopt;
  const auto channel = [&](int shift) { return static_cast<float>(digits >> shift & 255) / 255; };
  return Rgb{channel(16), channel(8), channel(0)};
}

}  // namespace

std::vector<std::string_view> names_of_views() {
  std::vector<std::string_view> names;
  for (const NamedView& named : kViews) names.push_back(named.name);
  return names;
}

void read_view(std::string_view option, const std::string& text, PictureOptions& options) {
  options.view = text;
  options.render.view = view_of(option, text);
}

void read_size(std::string_view option, const std::string& text, PictureOptions& options) {
  const std::size_t cross = std::min(text.find('x'), text.size());
  refuse_if(cross == text.size(), "{} {}: needs width x height in pixels, for example 1200x900",
            option, text);
  const auto side = [&](std::string_view digits) {
    return static_cast<int>(parse_integer(option, digits, 1, kMaxPictureSide));
  };
  options.render.width = side(std::string_view(text).substr(0, cross));
  options.render.height = side(std::string_view(text).substr(cross + 1));
}

void read_background(std::string_view option, const std::string& text, PictureOptions& options) {
  options.render.background = color_of(text);
  if (options.render.background || text == "transparent") return;
  refuse("{} {}: needs transparent, white, black, grey or #rrggbb", option, text);
}

void read_transparency(std::string_view option, const std::string& text, PictureOptions& options) {
  const bool is_percent = text.ends_with('%');
  const std::string_view digits = std::string_view(text).substr(0, text.size() - is_percent);
  const double given = parse_number(option, digits, Range::non_negative, "0.5");
  const double transparency = is_percent ? given / 100 : given;
  refuse_if(transparency >= 1 && !is_percent && given <= 100,
            "{} {}: is a share from 0 to below 1; in percent it is {}%", option, text, digits);
  refuse_if(transparency >= 1, "{} {}: needs less than 1, which is invisible", option, text);
  options.render.opacity = 1 - transparency;
}

void read_color(std::string_view option, const std::string& text, PictureOptions& options) {
  constexpr std::string_view kKnown[] = {
      "element",  "chain", "residue", "hydropathy",     "exposure",           "b-factor",
      "distance", "angle", "kind",    "mean-curvature", "gaussian-curvature", "white",
      "black",    "grey",  "#rrggbb"};
  constexpr ColorBy kColorings[] = {
      ColorBy::element,  ColorBy::chain,          ColorBy::residue,           ColorBy::hydropathy,
      ColorBy::exposure, ColorBy::b_factor,       ColorBy::distance,          ColorBy::angle,
      ColorBy::kind,     ColorBy::mean_curvature, ColorBy::gaussian_curvature};
  const std::string name = text == "hydrophobicity" ? "hydropathy" : text;
  const auto named = std::ranges::find(kKnown, name) - std::begin(kKnown);
  const std::optional<Rgb> plain = color_of(text);
  if (plain) options.plain = *plain;
  if (!plain && named >= std::ssize(kColorings)) throw_unknown_name(option, text, kKnown);
  options.color = plain ? ColorBy::plain : kColorings[named];
}

// Both bounds are finite, and still their distance may not be.
void read_color_range(std::string_view option, const std::string& text, PictureOptions& options) {
  const std::vector<double> bounds = numbers(option, text, 2, "-0.2,0.2");
  refuse_if(!std::isfinite(bounds[1] - bounds[0]), "{} {}: is too wide to be divided", option,
            text);
  refuse_if(!(bounds[0] < bounds[1]), "{} {}: needs the lower bound first", option, text);
  options.range = {bounds[0], bounds[1]};
}

}  // namespace vdwmesh::apps
