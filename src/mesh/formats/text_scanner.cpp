// The parts of TextScanner that readers call rarely, and its error messages. The number of a line
// is found by counting the line feeds before it, once, when an error is thrown.
//
// PlainText normalises text files before they are scanned: byte-order mark, line ends. It also
// rejects files that are not text, because their errors would otherwise be reported as odd words in
// line 1.
#include "mesh/formats/text_scanner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/errors.hpp"

namespace vdwmesh::formats {

std::string in_ascii(std::string_view text) {
  std::string printed(text);
  std::replace_if(
      printed.begin(), printed.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return printed;
}

std::string_view TextScanner::word() {
  skip_blanks();
  const char* first = at_;
  while (at_ < end_ && *at_ != ' ' && *at_ != '\t' && *at_ != '\r' && *at_ != '\n') ++at_;
  return {first, static_cast<std::size_t>(at_ - first)};
}

const void* TextScanner::find_newline() const { return std::memchr(at_, '\n', bytes_left()); }

void TextScanner::fail_at(const char* position, const std::string& what) const {
  throw FileFormatError(
      fmt::format("line {}: {}", 1 + std::count(begin_, position, '\n'), in_ascii(what)));
}

void TextScanner::fail_number() const {
  if (at_ == end_) fail("the file ends where a number should be");
  if (*at_ == '\n') fail("the line ends where a number should be");
  constexpr std::ptrdiff_t kShown = 24;  // characters of the word that the message shows
  const char* stop = std::find_if(at_, std::min(end_, at_ + kShown),
                                  [](char c) { return c == ' ' || c == '\n' || c == '\r'; });
  fail(fmt::format("'{}' is no number that can stand here", std::string_view(at_, stop)));
}

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
