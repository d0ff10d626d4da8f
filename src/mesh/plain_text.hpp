// The text formats as all their readers want them.
#pragma once

#include <string>
#include <string_view>

namespace vdwmesh::formats {

// The bytes without a byte-order mark; where CR alone ends the lines, LF does so in the copy.
// Throws FileFormatError for UTF-16 and for zero bytes.
class PlainText {
 public:
  explicit PlainText(std::string_view bytes);
  std::string_view view() const { return copy_.empty() ? bytes_ : copy_; }

 private:
  std::string_view bytes_;
  std::string copy_;  // empty where the bytes will do
};

std::string_view without_byte_order_mark(std::string_view bytes);

}  // namespace vdwmesh::formats
