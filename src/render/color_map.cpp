// The three colour maps. viridis and cividis are tables with linear interpolation between the
// entries. cool_warm is computed: it interpolates between two colours in the Msh space of Moreland
// 2009, and converts the result through CIELAB and XYZ to sRGB.
#include "render/color_map.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/errors.hpp"

namespace vdwmesh {
namespace {

// Every fifth colour of the 256 of viridis (S. Smith and N. van der Walt, "A Better Default
// Colormap for Matplotlib", SciPy 2015; CC0) and of cividis (J. R. Nuñez, C. R. Anderton and R. S.
// Renslow, "Optimizing colormaps with consideration for color vision deficiency", PLoS ONE 13,
// 2018), as 0xrrggbb. Colours between them are interpolated linearly. The result differs from the
// whole table by at most 1/255 for viridis and 4/255 for cividis.
constexpr int kKnots = 52;
constexpr std::uint32_t kViridis[kKnots] = {
    0x440154, 0x46085c, 0x471063, 0x481769, 0x481d6f, 0x482475, 0x472a7a, 0x46307e, 0x453781,
    0x433d84, 0x414287, 0x3f4889, 0x3d4e8a, 0x3a538b, 0x38598c, 0x355e8d, 0x33638d, 0x31688e,
    0x2e6d8e, 0x2c718e, 0x2a768e, 0x297b8e, 0x27808e, 0x25848e, 0x23898e, 0x218e8d, 0x20928c,
    0x1f978b, 0x1e9c89, 0x1fa188, 0x21a585, 0x24aa83, 0x28ae80, 0x2eb37c, 0x35b779, 0x3dbc74,
    0x46c06f, 0x50c46a, 0x5ac864, 0x65cb5e, 0x70cf57, 0x7cd250, 0x89d548, 0x95d840, 0xa2da37,
    0xb0dd2f, 0xbddf26, 0xcae11f, 0xd8e219, 0xe5e419, 0xf1e51d, 0xfde725};
constexpr std::uint32_t kCividis[kKnots] = {
    0x00224e, 0x002656, 0x002a5f, 0x002d68, 0x003070, 0x083370, 0x163770, 0x203a6f, 0x273e6e,
    0x2e416d, 0x34456c, 0x3a486c, 0x3f4c6c, 0x444f6c, 0x49536c, 0x4e566c, 0x535a6d, 0x575d6d,
    0x5c616e, 0x60646f, 0x656870, 0x696b71, 0x6d6f72, 0x727274, 0x767676, 0x7a7a78, 0x7e7d78,
    0x838179, 0x888578, 0x8d8878, 0x928c78, 0x969077, 0x9b9476, 0xa09875, 0xa59c74, 0xaaa073,
    0xafa471, 0xb5a86f, 0xbaac6d, 0xbfb06b, 0xc4b468, 0xc9b965, 0xcfbd62, 0xd4c15f, 0xdac65b,
    0xdfca57, 0xe5cf52, 0xead34c, 0xf0d846, 0xf6dd3f, 0xfce236, 0xfee838};

// Returns the colour of a number 0xrrggbb.
Rgb from_hex(std::uint32_t hex) {
  const auto channel = [&](int shift) { return static_cast<float>((hex >> shift) & 255u) / 255; };
  return {channel(16), channel(8), channel(0)};
}

Rgb mix(const Rgb& a, const Rgb& b, float t) {
  return {std::lerp(a.r, b.r, t), std::lerp(a.g, b.g, t), std::lerp(a.b, b.b, t)};
}

// Returns the colour at t in [0, 1] by linear interpolation in a table. The last interval includes
// its upper end, t = 1.
Rgb between_knots(std::span<const std::uint32_t, kKnots> knots, double t) {
  const double x = t * (kKnots - 1);
  const auto lower = std::min(static_cast<std::size_t>(x), std::size_t{kKnots - 2});
  return mix(from_hex(knots[lower]), from_hex(knots[lower + 1]),
             static_cast<float>(x - static_cast<double>(lower)));
}

// A colour in Msh space, which is CIELAB in polar coordinates: magnitude m, saturation s and hue h,
// the latter two as angles (K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC
// 2009, equation 1).
struct Msh {
  double m, s, h;
};

// The two ends of the paper's map, and its middle as each half of the map approaches it. The middle
// is a light grey (saturation 0), "white" in the names. It has no hue of its own, so each half may
// approach it with any hue. The paper turns this hue away from the hue of the end, which makes the
// change of lightness look even.
constexpr Msh kCool{80, 1.08, -1.1}, kCoolWhite{88, 0, -1.661};
constexpr Msh kWarm{80, 1.08, 0.5}, kWarmWhite{88, 0, 1.061};

// The sRGB encoding of linear light (IEC 61966-2-1), clamped to [0, 1].
float gamma_encoded(double linear) {
  const double v = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<float>(std::clamp(v, 0.0, 1.0));
}

// The inverse of the function f in the definition of CIELAB.
double lab_inverse(double f) {
  return f > 6.0 / 29 ? f * f * f : 3 * (6.0 / 29) * (6.0 / 29) * (f - 4.0 / 29);
}

// Converts Msh to CIELAB, then to XYZ with the white point D65, then to sRGB with the matrix of IEC
// 61966-2-1.
Rgb to_rgb(const Msh& c) {
  const double lightness = c.m * std::cos(c.s);
  const double a = c.m * std::sin(c.s) * std::cos(c.h), b = c.m * std::sin(c.s) * std::sin(c.h);
  const double fy = (lightness + 16) / 116;
  const double x = 0.95047 * lab_inverse(fy + a / 500);
  const double y = lab_inverse(fy);
  const double z = 1.08883 * lab_inverse(fy - b / 200);
  return {gamma_encoded(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
          gamma_encoded(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
          gamma_encoded(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

// Returns the colour of the map at t in [0, 1]. Each half of the map runs from white, at t = 1/2,
// to its end; u is the share of this way, from 0 to 1.
Rgb cool_warm(double t) {
  const bool warm = t > 0.5;
  const Msh& end = warm ? kWarm : kCool;
  const Msh& white = warm ? kWarmWhite : kCoolWhite;
  const double u = 2 * std::abs(t - 0.5);
  return to_rgb(
      {std::lerp(white.m, end.m, u), std::lerp(white.s, end.s, u), std::lerp(white.h, end.h, u)});
}

}  // namespace

Rgb color_at(ColorMap map, double t) {
  if (std::isnan(t)) throw InvalidInput("a colour map has no colour for NaN");
  const double clamped = std::clamp(t, 0.0, 1.0);
  switch (map) {
    case ColorMap::viridis:
      return between_knots(kViridis, clamped);
    case ColorMap::cividis:
      return between_knots(kCividis, clamped);
    case ColorMap::cool_warm:
      return cool_warm(clamped);
  }
  throw InvalidInput("unknown colour map");
}

}  // namespace vdwmesh
