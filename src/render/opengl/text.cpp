// Draws text with FreeType: decodes UTF-8, renders glyph by glyph in shades of coverage, and blends
// these over the picture. There is no kerning; labels are short.
#include "render/opengl/text.hpp"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/errors.hpp"
#include "render/opengl/samples.hpp"

namespace vdwmesh {

// The bytes of DejaVuSans.ttf. EmbedFont.cmake writes the source file that defines this function.
std::string_view font_data();

namespace {

// The code point U+FFFD, which stands for bytes that are not valid UTF-8.
constexpr char32_t kReplacement = 0xfffd;

// Returns the code points of a UTF-8 text. A lead byte, from 0 to 0x7f or from 0xc0, begins a code
// point and says how many continuation bytes (0x80 to 0xbf), with six bits each, follow it. A
// continuation byte without a lead byte, or a sequence that ends too early, becomes U+FFFD.
// Overlong sequences and lead bytes that UTF-8 does not use are not detected.
std::vector<char32_t> decode(std::string_view text) {
  std::vector<char32_t> points;
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i++]);
    // The number of continuation bytes that the lead byte announces; -1 if the byte is itself a
    // continuation byte.
    const int more = lead < 0x80 ? 0 : lead < 0xc0 ? -1 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
    char32_t point = more <= 0 ? lead : lead & (0x3fu >> more);
    for (int k = 0; k < more; ++k) {
      if (i == text.size() || (static_cast<unsigned char>(text[i]) & 0xc0u) != 0x80) {
        point = kReplacement;
        break;
      }
      point = (point << 6) | (static_cast<unsigned char>(text[i++]) & 0x3fu);
    }
    points.push_back(more < 0 ? kReplacement : point);
  }
  return points;
}

// Throws Error if a FreeType function failed.
void require(FT_Error error, const char* what) {
  if (error != 0) throw Error(std::string("FreeType failed at ") + what);
}

}  // namespace

// A font that FreeType has opened.
struct FontFace {
  FT_Library library = nullptr;
  FT_Face face = nullptr;

  ~FontFace() {
    if (face) FT_Done_Face(face);
    if (library) FT_Done_FreeType(library);
  }
  // The glyph's bitmap and metrics, valid until the next call.
  const FT_GlyphSlotRec& glyph(char32_t point) const {
    require(FT_Load_Char(face, point, FT_LOAD_RENDER), "a glyph");
    return *face->glyph;
  }
};

Font::Font(int size) : face_(std::make_unique<FontFace>()) {
  require(FT_Init_FreeType(&face_->library), "its start");
  const std::string_view data = font_data();
  require(FT_New_Memory_Face(face_->library, reinterpret_cast<const FT_Byte*>(data.data()),
                             static_cast<FT_Long>(data.size()), 0, &face_->face),
          "the font");
  require(FT_Set_Pixel_Sizes(face_->face, 0, static_cast<FT_UInt>(size)), "the size");
}

Font::~Font() = default;

int Font::width(std::string_view text) const {
  FT_Pos advance = 0;  // 1/64 pixel
  for (const char32_t point : decode(text)) advance += face_->glyph(point).advance.x;
  return static_cast<int>((advance + 63) / 64);
}

void Font::draw(std::string_view text, int x, int y, const Rgb& ink, Picture& picture) const {
  // FreeType counts advances in units of 1/64 pixel.
  FT_Pos pen = FT_Pos{x} * 64;
  for (const char32_t point : decode(text)) {
    const FT_GlyphSlotRec& glyph = face_->glyph(point);
    const int left = static_cast<int>(pen / 64) + glyph.bitmap_left;
    const int top = y - glyph.bitmap_top;
    for (int j = 0; j < static_cast<int>(glyph.bitmap.rows); ++j) {
      for (int i = 0; i < static_cast<int>(glyph.bitmap.width); ++i) {
        const int column = left + i, row = top + j;
        const bool inside =
            column >= 0 && column < picture.width && row >= 0 && row < picture.height;
        const unsigned char coverage = glyph.bitmap.buffer[j * glyph.bitmap.pitch + i];
        if (inside) blend(ink, coverage / 255.0, picture.at(column, row));
      }
    }
    pen += glyph.advance.x;
  }
}

void blend(const Rgb& ink, double coverage, Rgba8& pixel) {
  if (coverage <= 0) return;
  // Porter and Duff's operator "over" for straight alpha (the colour is not multiplied by alpha).
  // `coverage` and `behind` are the shares of the pixel that show the ink and the old colour. Their
  // sum is the new alpha, and the new colour is the mean of both colours, weighted by the shares.
  const double behind = pixel[3] / 255.0 * (1 - coverage), alpha = coverage + behind;
  const auto bytes = to_bytes(ink);
  for (std::size_t c = 0; c < 3; ++c) {
    const double light =
        coverage * to_linear(bytes[c] / 255.0) + behind * to_linear(pixel[c] / 255.0);
    pixel[c] = to_srgb_byte(light / alpha);
  }
  pixel[3] = static_cast<std::uint8_t>(std::lround(255 * alpha));
}

}  // namespace vdwmesh
