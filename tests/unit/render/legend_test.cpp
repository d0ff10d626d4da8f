// The colour bar, and PNG as libpng reads it back.
#include "render/opengl/legend.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "render/opengl/text.hpp"
#include "render/picture.hpp"

namespace vdwmesh {
namespace {

constexpr int kWidth = 600, kHeight = 400;

Picture blank(int width, int height) {
  Picture picture{width, height, {}};
  picture.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                        {255, 255, 255, 255});
  return picture;
}

// The row through the middle of the bar holds the map's colours from end to end, in order.
TEST(Legend, BarRunsThroughTheMap) {
  const ColorScale scale{ColorMap::viridis, 0, 1, "title, Å"};
  Picture picture = blank(kWidth, kHeight);
  const int top = kHeight - legend_height(kWidth, kHeight);
  draw_legend(scale, top, Rgb{1, 1, 1}, picture);
  const auto is = [&](int x, int y, double t) {
    const auto bytes = to_bytes(color_at(scale.map, t));
    return picture.at(x, y) == Rgba8{bytes[0], bytes[1], bytes[2], 255};
  };
  int rows = 0;
  for (int y = top; y < kHeight; ++y) {
    int first = 0, last = kWidth - 1;
    while (first < kWidth && picture.at(first, y) == Rgba8{255, 255, 255, 255}) ++first;
    while (last >= 0 && picture.at(last, y) == Rgba8{255, 255, 255, 255}) --last;
    const int width = last - first - 1;  // between the two pixels of the frame
    if (width < kWidth / 2 || !is(first + 1, y, 0.5 / width)) continue;
    ++rows;
    for (int x = 0; x < width; ++x) ASSERT_TRUE(is(first + 1 + x, y, (x + 0.5) / width)) << x;
  }
  EXPECT_GE(rows, 6);
}

TEST(Legend, NothingAboveItIsTouched) {
  Picture picture = blank(kWidth, kHeight);
  const int top = kHeight - legend_height(kWidth, kHeight);
  draw_legend({ColorMap::cividis, -5, 5, "a title"}, top, Rgb{0, 0, 0}, picture);
  for (int x = 0; x < kWidth; ++x) {
    EXPECT_EQ(picture.at(x, top - 1), (Rgba8{255, 255, 255, 255}));
    EXPECT_EQ(picture.at(x, kHeight - 1), (Rgba8{0, 0, 0, 255}));  // margin below the labels
  }
}

// The frame of the bar is of the ink. Light colours are those of CIE luminance above 0.18, which
// red has (0.21) and blue has not (0.07).
TEST(Legend, InkIsBlackOnLightAndWhiteOnDark) {
  const auto has_white = [](const Rgb& background) {
    Picture picture = blank(kWidth, kHeight);
    const int top = kHeight - legend_height(kWidth, kHeight);
    draw_legend({ColorMap::viridis, 0, 1, "t"}, top, background, picture);
    const auto ink_begins = picture.pixels.begin() + std::ptrdiff_t{top} * kWidth;
    return std::find(ink_begins, picture.pixels.end(), Rgba8{255, 255, 255, 255}) !=
           picture.pixels.end();
  };
  EXPECT_FALSE(has_white({1, 0, 0}));
  EXPECT_FALSE(has_white({0, 1, 0}));
  EXPECT_TRUE(has_white({0, 0, 1}));
  EXPECT_TRUE(has_white({0, 0, 0}));
}

// Half covered by ink, a transparent pixel is of the ink's colour and half opaque.
TEST(Text, InkOnATransparentPixelKeepsItsColour) {
  Rgba8 pixel{10, 20, 30, 0};
  blend({1, 0, 0}, 0.5, pixel);
  EXPECT_EQ(pixel, (Rgba8{255, 0, 0, 128}));
}

TEST(Legend, PicturesTooSmallForOneAreRefused) {
  EXPECT_THROW(legend_height(100, 400), InvalidInput);
  EXPECT_THROW(legend_height(400, 100), InvalidInput);
}

TEST(Text, IsWiderForMoreAndKnowsItsLetters) {
  const Font font(20);
  EXPECT_GT(font.width("00"), font.width("0"));
  EXPECT_EQ(font.width(""), 0);
  const auto ink = [&](const char* text) {
    Picture picture = blank(60, 40);
    font.draw(text, 5, 30, {0, 0, 0}, picture);
    return picture.pixels;
  };
  EXPECT_NE(ink("Å"), ink("\uFFFF"));  // which no font has
  EXPECT_NE(ink("\u2212"), ink("\uFFFF"));
  EXPECT_EQ(ink("\xff"), ink("\uFFFD"));
  EXPECT_NE(ink("Å"), ink("A"));
}

TEST(Text, OutsideOfThePictureIsCutOff) {
  Picture picture = blank(30, 20);
  const Font font(20);
  font.draw("MMMM", -15, 5, {0, 0, 0}, picture);
  font.draw("MMMM", 20, 25, {0, 0, 0}, picture);
  EXPECT_EQ(picture.pixels.size(), 600u);
}

Picture decode(const std::string& bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  image.format = PNG_FORMAT_RGBA;
  Picture picture = blank(static_cast<int>(image.width), static_cast<int>(image.height));
  EXPECT_TRUE(png_image_finish_read(&image, nullptr, picture.pixels.data(), 0, nullptr));
  return picture;
}

TEST(Png, ReadsBackTheSame) {
  Picture opaque = blank(17, 5), clear = blank(3, 8);
  opaque.at(16, 4) = {1, 2, 3, 255};
  clear.at(1, 2) = {200, 100, 50, 128};
  for (const Picture& picture : {opaque, clear}) {
    const Picture back = decode(encode_png(picture));
    EXPECT_EQ(back.width, picture.width);
    EXPECT_EQ(back.height, picture.height);
    EXPECT_EQ(back.pixels, picture.pixels);
  }
}

TEST(Png, NeedsPixels) { EXPECT_THROW(encode_png(Picture{}), InvalidInput); }

}  // namespace
}  // namespace vdwmesh
