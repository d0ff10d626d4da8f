// Normalises text files before they are scanned: byte-order mark, line ends. It also rejects files
// that are not text, because their errors would otherwise be reported as odd words in line 1.
#include "mesh/plain_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.hpp"

namespace vdwmesh::formats {

std::string_view without_byte_order_mark(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  return bytes;
}

PlainText::PlainText(std::string_view bytes) : bytes_(without_byte_order_mark(bytes)) {
  if (bytes_.starts_with("\xff\xfe") || bytes_.starts_with("\xfe\xff"))
    throw FileFormatError("is UTF-16 text; write it as UTF-8");
  const std::size_t zero = bytes_.find('\0');
  if (zero != std::string_view::npos)
    throw FileFormatError(fmt::format("is not text (a zero byte at offset {})", zero));
  // A file with both characters has lines that end in CR LF: TextScanner takes the CR for a blank.
  const auto has = [&](char c) { return bytes_.find(c) != std::string_view::npos; };
  if (has('\n') || !has('\r')) return;
  copy_ = bytes_;
  std::replace(copy_.begin(), copy_.end(), '\r', '\n');
}

}  // namespace vdwmesh::formats
