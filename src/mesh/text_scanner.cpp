// The parts of TextScanner that readers call rarely, and its error messages. The number of a line
// is found by counting the line feeds before it, once, when an error is thrown.
#include "mesh/text_scanner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/errors.hpp"

namespace vdwmesh::formats {

std::string_view TextScanner::word() {
  skip_blanks();
  const char* first = at_;
  while (at_ < end_ && *at_ != ' ' && *at_ != '\t' && *at_ != '\r' && *at_ != '\n') ++at_;
  return {first, static_cast<std::size_t>(at_ - first)};
}

const void* TextScanner::find_newline() const { return std::memchr(at_, '\n', bytes_left()); }

void TextScanner::fail_at(const char* position, const std::string& what) const {
  throw FileFormatError(fmt::format("line {}: {}", 1 + std::count(begin_, position, '\n'), what));
}

void TextScanner::fail_number() const {
  if (at_ == end_) fail("the file ends where a number should be");
  if (*at_ == '\n') fail("the line ends where a number should be");
  constexpr std::ptrdiff_t kShown = 24;  // characters of the word that the message shows
  const char* stop = std::find_if(at_, std::min(end_, at_ + kShown),
                                  [](char c) { return c == ' ' || c == '\n' || c == '\r'; });
  fail(fmt::format("'{}' is no number that can stand here", std::string_view(at_, stop)));
}

}  // namespace vdwmesh::formats
