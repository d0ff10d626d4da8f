// Pictures whose content mathematics says.
#include "render/renderer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer_fixture.hpp"
#include "support/test_meshes.hpp"

namespace vdwmesh {
namespace {

using namespace testing;
using Drawing = testing::DrawingTest;

constexpr Rgb kGrey{0.5f, 0.5f, 0.5f};
constexpr double kPixelsAcross = 300;

// A sphere of 20480 triangles, square, seen along z with the light from the viewer.
RenderOptions sphere_options() {
  RenderOptions options;
  options.width = options.height = static_cast<int>(kPixelsAcross);
  options.margin = 0.04;
  options.background.reset();
  options.light = {0, 0, 1};
  return options;
}
constexpr double kSphereRadius = (1 - 2 * 0.04) * kPixelsAcross / 2;  // pixels

double covered_area(const Picture& picture) {
  double sum = 0;
  for (const Rgba8& pixel : picture.pixels) sum += pixel[3] / 255.0;
  return sum;
}

constexpr double kDiscArea = std::numbers::pi * kSphereRadius * kSphereRadius;  // square pixels

// A sample speaks for a square of side s around it, so the count errs by no more than the squares
// that the outline passes through: about its length times their diagonal, over 2. The longest edge
// e of the mesh, seen edge-on, cuts e²/8 off the radius; the 20480 edges differ by a third.
double disc_tolerance(const RenderOptions& options) {
  const double s = 1.0 / options.samples_per_axis;
  const double sampling = 2 * std::numbers::pi * kSphereRadius * s * std::sqrt(2) / 2;
  const double edge = 1.33 * std::sqrt(4 * std::numbers::pi / 20480 * 4 / std::sqrt(3));
  return sampling + kDiscArea * 2 * edge * edge / 8;
}

TEST_F(Drawing, SilhouetteOfASphereHasTheAreaOfItsDisc) {
  const RenderOptions options = sphere_options();
  EXPECT_NEAR(covered_area(draw(icosphere(5), kGrey, options)), kDiscArea, disc_tolerance(options));
  EXPECT_LT(disc_tolerance(options), 0.005 * kDiscArea);
}

// Framing makes the outline reach the margin whatever the distance, but by vertices, which are up
// to half an edge beside the outline.
TEST_F(Drawing, SilhouetteInPerspectiveIsADiscAsWell) {
  RenderOptions options = sphere_options();
  options.projection = CameraProjection::perspective;
  EXPECT_NEAR(covered_area(draw(icosphere(5), kGrey, options)), kDiscArea,
              2 * disc_tolerance(options));
}

double srgb(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}
double linear(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

// Blinn's model where light, viewer and half vector are the same: all depends on the cosine c.
double expected_level(double c, const Material& m, double channel) {
  const double ambient = m.ambient * (0.5 + 0.5 * c);
  const double light =
      (ambient + m.diffuse * c) * linear(channel) + m.specular * std::pow(c, m.shininess);
  return 255 * std::clamp(srgb(light), 0.0, 1.0);
}

// Of a byte: rounding of colour and result, and normals bent by the triangles' size.
constexpr double kLevels = 3;

TEST_F(Drawing, LightOnASphereFollowsTheModel) {
  IndexedMesh sphere = icosphere(5);
  for (const Vec3d& p : sphere.positions) sphere.normals.push_back(cast<float>(p));
  const RenderOptions options = sphere_options();
  const Picture picture = draw(sphere, kGrey, options);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double dx = x + 0.5 - kPixelsAcross / 2, dy = y + 0.5 - kPixelsAcross / 2;
      const double sine = std::hypot(dx, dy) / kSphereRadius;
      if (sine > 0.97) continue;  // beyond it a pixel spans too many angles
      const double c = std::sqrt(1 - sine * sine);
      ASSERT_NEAR(picture.at(x, y)[0], expected_level(c, options.material, 0.5), kLevels)
          << x << ' ' << y;
    }
  }
}

TEST_F(Drawing, LightFromTheViewerIsSymmetric) {
  for (const Shading shading : {Shading::gouraud, Shading::per_pixel}) {
    RenderOptions options = sphere_options();
    options.shading = shading;
    const Picture p = draw(icosphere(5), kGrey, options);
    const int last = p.width - 1;
    for (int y = 0; y <= last; ++y) {
      for (int x = 0; x <= last; ++x) {
        if (p.at(x, y)[3] < 255 || p.at(last - x, y)[3] < 255) continue;
        ASSERT_NEAR(p.at(x, y)[0], p.at(last - x, y)[0], kLevels) << x << ' ' << y;
        if (p.at(x, last - y)[3] < 255) continue;
        ASSERT_NEAR(p.at(x, y)[0], p.at(x, last - y)[0], kLevels) << x << ' ' << y;
      }
    }
  }
}

TEST_F(Drawing, LightComesFromWhereItIsSaid) {
  RenderOptions options = sphere_options();
  const auto brightness = [&](const Vec3f& light, int x, int y) {
    options.light = light;
    return int{draw(icosphere(4), kGrey, options).at(x, y)[0]};
  };
  const int low = static_cast<int>(kPixelsAcross / 4),
            high = static_cast<int>(3 * kPixelsAcross / 4);
  const int middle = static_cast<int>(kPixelsAcross / 2);
  EXPECT_GT(brightness({1, 0, 0.3f}, high, middle), brightness({1, 0, 0.3f}, low, middle) + 40);
  EXPECT_GT(brightness({0, 1, 0.3f}, middle, low), brightness({0, 1, 0.3f}, middle, high) + 40);
}

TEST_F(Drawing, BackgroundIsAsAskedAndTheMiddleIsNot) {
  RenderOptions options = sphere_options();
  options.background = Rgb{1, 128.0f / 255, 0};
  const Picture on_orange = draw(icosphere(3), kGrey, options);
  EXPECT_EQ(on_orange.at(0, 0), (Rgba8{255, 128, 0, 255}));
  EXPECT_EQ(on_orange.at(299, 299), (Rgba8{255, 128, 0, 255}));
  options.background.reset();
  const Picture on_nothing = draw(icosphere(3), kGrey, options);
  EXPECT_EQ(on_nothing.at(0, 0)[3], 0);
  EXPECT_EQ(on_nothing.at(150, 150)[3], 255);
  EXPECT_EQ(on_nothing.at(150, 150), on_orange.at(150, 150));
}

TEST_F(Drawing, TheSamePictureTwiceIsIdentical) {
  RenderOptions options;
  options.width = 400, options.height = 300;
  const IndexedMesh mesh = torus(64, 32);
  std::vector<float> values(mesh.vertex_count());
  for (std::size_t v = 0; v < values.size(); ++v)
    values[v] = static_cast<float>(mesh.positions[v].x);
  const Paint paint = VertexValues{values, {ColorMap::viridis, -1, 1, "x, Å"}};
  const Picture first = draw(mesh, paint, options);
  const Renderer another;
  EXPECT_EQ(first.pixels, draw(mesh, paint, options).pixels);
  EXPECT_EQ(first.pixels, another.draw(MeshSource(mesh, paint), options).pixels);
  EXPECT_EQ(encode_png(first), encode_png(first));
}

// A flat square that faces the light: its colour comes back whole, without a highlight.
IndexedMesh square() {
  return make_mesh({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
}
RenderOptions flat_options() {
  RenderOptions options = sphere_options();
  options.view.frame = ViewFrame::coordinates;
  options.margin = 0;
  options.material = {0, 1, 0, 1};
  return options;
}

void expect_color(const Rgba8& pixel, const Rgb& color) {
  const auto bytes = to_bytes(color);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], bytes[c], 1);  // two roundings
}

TEST_F(Drawing, ColoursComeBackAsTheyWere) {
  const Rgb colors[] = {{1, 0, 0}, {0.2f, 0.6f, 0.9f}, {0.01f, 0.02f, 0.5f}};
  for (const Rgb& color : colors) {
    expect_color(draw(square(), color, flat_options()).at(150, 150), color);
  }
}

TEST_F(Drawing, ValuesOfTrianglesHaveTheirColours) {
  const ColorScale scale{ColorMap::cool_warm, -2, 2, "v"};
  for (const double value : {-2.0, -0.7, 0.0, 1.3, 2.0, 5.0}) {
    const Picture picture =
        draw(square(), TriangleValues{{static_cast<float>(value), -2}, scale}, flat_options());
    expect_color(picture.at(200, 180), color_at(scale.map, (value + 2) / 4));
    expect_color(picture.at(100, 60), color_at(scale.map, 0));
  }
}

// Between a vertex of -1 and one of 1 the colours of the map are run through, grey in the middle:
// not the mean of blue and red.
TEST_F(Drawing, ValuesAreInterpolatedBeforeTheyAreColoured) {
  const ColorScale scale{ColorMap::cool_warm, -1, 1, "x"};
  const Picture picture = draw(square(), VertexValues{{-1, 1, 1, -1}, scale}, flat_options());
  int first = picture.width, last = 0;
  for (int x = 0; x < picture.width; ++x) {
    if (picture.at(x, 120)[3] < 255) continue;
    first = std::min(first, x), last = std::max(last, x);
  }
  for (int x = first; x <= last; ++x) {
    expect_color(picture.at(x, 120), color_at(scale.map, (x - first + 0.5) / (last - first + 1)));
  }
}

TEST_F(Drawing, ValuesThatAreNoNumbersAreGrey) {
  const ColorScale scale{ColorMap::viridis, 0, 1, "v"};
  const float nan = std::nanf("");
  const Picture picture = draw(square(), TriangleValues{{nan, nan}, scale}, flat_options());
  expect_color(picture.at(200, 180), kGrey);
}

// The inside of an open surface, and a surface wound the wrong way round, are lit as well.
TEST_F(Drawing, BackFacesAreNotBlack) {
  for (const Shading shading : {Shading::gouraud, Shading::per_pixel}) {
    RenderOptions options = flat_options();
    options.shading = shading;
    expect_color(draw(reversed(square()), kGrey, options).at(150, 150), kGrey);
  }
}

TEST_F(Drawing, MissingAndBrokenNormalsAreComputed) {
  IndexedMesh mesh = square();
  const Picture without = draw(mesh, kGrey, flat_options());
  mesh.normals.assign(4, Vec3f{0, 0, std::nanf("")});
  EXPECT_EQ(draw(mesh, kGrey, flat_options()).pixels, without.pixels);
  mesh.normals.assign(4, Vec3f{0, 0, 0});
  EXPECT_EQ(draw(mesh, kGrey, flat_options()).pixels, without.pixels);
  expect_color(without.at(150, 150), kGrey);
}

TEST_F(Drawing, NearTrianglesHideFarOnes) {
  const IndexedMesh near_first = together(translated(scaled(square(), 0.5), {0, 0, 1}), square());
  const IndexedMesh far_first = together(square(), translated(scaled(square(), 0.5), {0, 0, 1}));
  const Rgb red{1, 0, 0}, blue{0, 0, 1};
  const VertexColors near_red{{red, red, red, red, blue, blue, blue, blue}};
  const VertexColors far_blue{{blue, blue, blue, blue, red, red, red, red}};
  expect_color(draw(near_first, near_red, flat_options()).at(150, 150), red);
  expect_color(draw(far_first, far_blue, flat_options()).at(150, 150), red);
  expect_color(draw(far_first, far_blue, flat_options()).at(20, 20), blue);
}

// Three squares, one behind the other: red, green and blue from the viewer on.
IndexedMesh three_squares() {
  return together(together(translated(square(), {0, 0, -1}), translated(square(), {0, 0, 1})),
                  square());
}
const VertexColors kBlueRedGreen{{{0, 0, 1},
                                  {0, 0, 1},
                                  {0, 0, 1},
                                  {0, 0, 1},
                                  {1, 0, 0},
                                  {1, 0, 0},
                                  {1, 0, 0},
                                  {1, 0, 0},
                                  {0, 1, 0},
                                  {0, 1, 0},
                                  {0, 1, 0},
                                  {0, 1, 0}}};

// A layer sends the share a of its light and lets 1 - a through, whichever was drawn first.
TEST_F(Drawing, LayersOfATransparentSurfaceAreSeenThroughThoseInFront) {
  const IndexedMesh mesh = three_squares();
  for (const double a : {0.2, 0.5, 0.9}) {
    RenderOptions options = flat_options();
    options.opacity = a;
    options.background = Rgb{1, 1, 1};
    const double rest = std::pow(1 - a, 3);
    const auto byte = [&](double light) { return 255 * srgb(light); };
    const Rgba8 pixel = draw(mesh, kBlueRedGreen, options).at(150, 150);
    EXPECT_NEAR(pixel[0], byte(a + rest), 1);
    EXPECT_NEAR(pixel[1], byte(a * (1 - a) + rest), 1);
    EXPECT_NEAR(pixel[2], byte(a * (1 - a) * (1 - a) + rest), 1);
    options.background.reset();
    EXPECT_NEAR(draw(mesh, kBlueRedGreen, options).at(150, 150)[3], 255 * (1 - rest), 0.5);
  }
}

// A transparent ball has two layers inside its disc, and none beside it.
TEST_F(Drawing, ATransparentBallHasAFrontAndABack) {
  RenderOptions options = sphere_options();
  options.opacity = 0.4;
  const double layers = 1 - 0.6 * 0.6;
  EXPECT_NEAR(covered_area(draw(icosphere(5), kGrey, options)), layers * kDiscArea,
              layers * disc_tolerance(options));
}

double ink_area(const Picture& picture) {
  double sum = 0;
  for (const Rgba8& pixel : picture.pixels) {
    if (std::max({pixel[0], pixel[1], pixel[2]}) < 40) sum += pixel[3] / 255.0;
  }
  return sum;
}

// The line is as wide as asked for, and half of it lies outside. It follows samples, so that each
// of its borders may be one beside its place; a pixel that it covers in part counts for neither.
TEST_F(Drawing, AnOutlineRunsAroundABall) {
  RenderOptions options = sphere_options();
  options.outline = 0.04;
  const Picture picture = draw(icosphere(5), kGrey, options);
  const double width = 0.04 * kPixelsAcross, around = 2 * std::numbers::pi * kSphereRadius;
  const double outer = kSphereRadius + width / 2;
  EXPECT_NEAR(covered_area(picture), std::numbers::pi * outer * outer,
              disc_tolerance(options) + around / options.samples_per_axis);
  EXPECT_NEAR(ink_area(picture), around * width, around * (1 + 2.0 / options.samples_per_axis));
  EXPECT_EQ(ink_area(draw(icosphere(5), kGrey, sphere_options())), 0);
}

// The small square in front stands out by 10 % or 2 % of the depth of the whole, which is 10.
TEST_F(Drawing, AnOutlineNeedsAJumpInDepth) {
  for (const double height : {1.0, 0.2}) {
    const IndexedMesh near = together(translated(scaled(square(), 0.5), {0, 0, height}), square());
    const IndexedMesh mesh = together(near, translated(scaled(square(), 0.1), {0, 0, height - 10}));
    RenderOptions options = flat_options();
    options.outline = 0.02;
    const Picture picture = draw(mesh, kGrey, options);
    EXPECT_EQ(picture.at(75, 150)[0] < 10, height == 1.0) << height;
    EXPECT_GT(picture.at(60, 150)[0], 100);
    EXPECT_GT(picture.at(90, 150)[0], 100);
  }
}

// A line hides what is behind it, whatever the surface lets through; on black it is white.
TEST_F(Drawing, AnOutlineIsOpaqueAndStandsOutFromTheBackground) {
  RenderOptions options = flat_options();
  options.margin = 0.1, options.outline = 0.02, options.opacity = 0.3;
  EXPECT_EQ(draw(square(), kGrey, options).at(30, 150), (Rgba8{0, 0, 0, 255}));
  options.background = Rgb{0, 0, 0};
  EXPECT_EQ(draw(square(), kGrey, options).at(30, 150), (Rgba8{255, 255, 255, 255}));
}

// A wall stands on the left side of the square, on edge in the picture. The middle of the square is
// on the edge between two of its corners, and has the mean of the light that the sky sends there.
TEST_F(Drawing, ShadedSurfacesHaveTheLightOfTheSkyTheySee) {
  const IndexedMesh wall =
      make_mesh({{-1, -1, 0}, {-1, 1, 0}, {-1, 1, 2}, {-1, -1, 2}}, {{0, 1, 2}, {0, 2, 3}});
  const IndexedMesh mesh = together(square(), wall);
  MeshSource source(mesh, kGrey);
  RenderOptions options = flat_options();
  const Renderer renderer;
  expect_color(renderer.draw(source, options).at(150, 150), kGrey);
  source.shade();
  const Buffer<Vec3f> normals = vertex_normals(mesh);
  const std::vector<float> sky = visible_sky(mesh, {normals.data(), normals.size()}, source);
  const double mean = (sky[0] + sky[2]) / 2;
  EXPECT_LT(mean, 0.95);
  const auto level = static_cast<float>(srgb(mean * linear(0.5)));
  expect_color(renderer.draw(source, options).at(150, 150), {level, level, level});
}

TEST_F(Drawing, APictureThatWouldBeEmptyIsRefused) {
  RenderOptions edge_on = flat_options();
  edge_on.view.toward_viewer = {1, 0, 0};
  edge_on.view.up = {0, 1, 0};
  EXPECT_THROW(draw(square(), kGrey, edge_on), InvalidInput);
}

TEST_F(Drawing, OptionsOutOfRangeAreRefused) {
  const auto refused = [&](auto change) {
    RenderOptions options = flat_options();
    change(options);
    EXPECT_THROW(draw(square(), kGrey, options), InvalidInput);
  };
  refused([](RenderOptions& o) { o.width = 0; });
  refused([](RenderOptions& o) { o.height = kMaxPictureSide + 1; });
  refused([](RenderOptions& o) { o.samples_per_axis = 0; });
  refused([](RenderOptions& o) { o.margin = 0.5; });
  refused([](RenderOptions& o) { o.light = {0, 0, 0}; });
  refused([](RenderOptions& o) { o.opacity = 0; });
  refused([](RenderOptions& o) { o.opacity = 1.5; });
  refused([](RenderOptions& o) { o.outline = 0.5; });
}

TEST_F(Drawing, LimitsAreCheckedBeforeMemoryIsTaken) {
  RenderOptions options = flat_options();
  options.memory_limit = 1000;
  EXPECT_THROW(draw(square(), kGrey, options), LimitExceeded);
  options.memory_limit = ~std::uint64_t{0};
  options.width = kMaxPictureSide;
  options.samples_per_axis = 8;  // 131072 samples across: more than any device draws
  EXPECT_THROW(draw(square(), kGrey, options), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh
