// Brings a text file into the form that TextScanner reads.
#pragma once

#include <string>
#include <string_view>

namespace vdwmesh::formats {

// The bytes of a text file without a byte-order mark. If only CR ends its lines, as on the first
// Macintoshes, the view shows a copy with LF instead; otherwise it shows the given bytes, which
// must outlive it. Throws FileFormatError for UTF-16 text and for bytes of value zero.
class PlainText {
 public:
  explicit PlainText(std::string_view bytes);
  std::string_view view() const { return copy_.empty() ? bytes_ : copy_; }

 private:
  std::string_view bytes_;
  std::string copy_;  // empty if no copy is needed
};

// `bytes` without the three bytes EF BB BF that mark UTF-8 text, if it begins with them.
std::string_view without_byte_order_mark(std::string_view bytes);

}  // namespace vdwmesh::formats
