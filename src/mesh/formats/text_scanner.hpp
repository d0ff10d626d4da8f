// A scanner for the text formats (OBJ, OFF, STL, PLY): it reads words and numbers in place, without
// copying lines. It does not count lines while it reads; an error counts them up to its position.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "core/read_double.hpp"

namespace vdwmesh::formats {

// The text with "?" for whatever ASCII does not print: words of a file may hold any bytes.
std::string in_ascii(std::string_view text);

// Comments run from # to the end of the line. A line ends with a line feed; carriage returns count
// as blanks.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text)
      : begin_(text.data()), at_(begin_), end_(begin_ + text.size()) {}

  // The current position, as a pointer into the text; move_to() goes back to such a position.
  const char* position() const { return at_; }
  void move_to(const char* position) { at_ = position; }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }

  // Skips blanks, and line breaks after a backslash, which continue a line.
  void skip_blanks() {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || skip_continuation()))
      ++at_;
  }
  // Skips blanks, ends of lines and comments.
  void skip_to_token() {
    for (skip_blanks(); at_ < end_ && (*at_ == '\n' || *at_ == '#'); skip_blanks()) next_line();
  }
  // Moves to the beginning of the next line, or to the end of the text.
  void next_line() {
    const void* found = at_ < end_ ? find_newline() : nullptr;
    at_ = found ? static_cast<const char*>(found) + 1 : end_;
  }
  // Whether nothing but blanks and a comment is left on the line.
  bool at_line_end() {
    skip_blanks();
    return at_ == end_ || *at_ == '\n' || *at_ == '#';
  }
  // Whether nothing but blanks and comments is left in the text.
  bool at_end() {
    skip_to_token();
    return at_ == end_;
  }

  // The next word of the line: all characters up to a blank or the end of the line.
  // Empty at the end of the line.
  std::string_view word();
  // The next number of the line. Throws FileFormatError if there is none, or if it is not finite or
  // is too large for a double. read_double() also reads "inf" and "nan"; only for finite numbers is
  // value - value equal to 0.
  double number() {
    skip_blanks();
    skip_plus();
    double value;
    const auto [next, error] = read_double(at_, end_, value);
    if (error != std::errc{} || !(value - value == 0)) fail_number();
    at_ = next;
    return value;
  }
  // The next integer of the line. Throws FileFormatError if there is none that fits the type.
  template <class Integer>
  Integer integer() {
    skip_blanks();
    skip_plus();
    Integer value;
    const auto [next, error] = std::from_chars(at_, end_, value);
    if (error != std::errc{}) fail_number();
    at_ = next;
    return value;
  }
  // Consumes the next character if it is c, and returns whether it was.
  bool take(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }

  // Throw FileFormatError with the line number of the current or the given position.
  [[noreturn]] void fail(const std::string& what) const { fail_at(at_, what); }
  [[noreturn]] void fail_at(const char* position, const std::string& what) const;

 private:
  // If a backslash and a line break (LF or CR LF) stand here, moves to the LF, which the loop in
  // skip_blanks() then steps over. Returns whether it moved.
  bool skip_continuation() {
    if (*at_ != '\\') return false;
    const char* next = at_ + 1;
    if (next < end_ && *next == '\r') ++next;
    if (next == end_ || *next != '\n') return false;
    at_ = next;
    return true;
  }
  // std::from_chars takes no plus sign. The sign is kept before a minus, so that "+-1" is an error.
  void skip_plus() {
    if (at_ + 1 < end_ && *at_ == '+' && at_[1] != '-') ++at_;
  }
  const void* find_newline() const;
  [[noreturn]] void fail_number() const;

  const char* begin_;  // of the text
  const char* at_;     // current position
  const char* end_;    // of the text
};

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
