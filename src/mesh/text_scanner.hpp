// Numbers and words of a text file, read where they lie. Line numbers are counted only when an
// error needs one.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace vdwmesh::formats {

class TextScanner {
 public:
  explicit TextScanner(std::string_view text)
      : begin_(text.data()), at_(begin_), end_(begin_ + text.size()) {}

  const char* position() const { return at_; }
  void move_to(const char* position) { at_ = position; }
  std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - at_); }

  // Blanks, and line breaks escaped by a backslash.
  void skip_blanks() {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\t' || *at_ == '\r' || is_continuation())) ++at_;
  }
  // Blanks, empty lines and comments from # to the end of the line.
  void skip_to_token() {
    for (skip_blanks(); at_ < end_ && (*at_ == '\n' || *at_ == '#'); skip_blanks()) next_line();
  }
  void next_line() {
    const void* found = at_ < end_ ? find_newline() : nullptr;
    at_ = found ? static_cast<const char*>(found) + 1 : end_;
  }
  bool at_line_end() {
    skip_blanks();
    return at_ == end_ || *at_ == '\n' || *at_ == '#';
  }
  bool at_end() {
    skip_to_token();
    return at_ == end_;
  }

  // The next word, empty at the end of the line.
  std::string_view word();
  // A number that follows on the same line. Throws FileFormatError where there is none, or one
  // that is not finite or not in range.
  double number() {
    skip_blanks();
    skip_plus();
    double value;
    const auto [next, error] = std::from_chars(at_, end_, value);
    if (error != std::errc{} || !(value - value == 0)) fail_number();
    at_ = next;
    return value;
  }
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
  bool take(char c) {
    if (at_ == end_ || *at_ != c) return false;
    ++at_;
    return true;
  }

  [[noreturn]] void fail(const std::string& what) const { fail_at(at_, what); }
  [[noreturn]] void fail_at(const char* position, const std::string& what) const;

 private:
  bool is_continuation() {
    if (*at_ != '\\') return false;
    const char* next = at_ + 1;
    if (next < end_ && *next == '\r') ++next;
    if (next == end_ || *next != '\n') return false;
    at_ = next;
    return true;
  }
  void skip_plus() {
    if (at_ + 1 < end_ && *at_ == '+' && at_[1] != '-') ++at_;
  }
  const void* find_newline() const;
  [[noreturn]] void fail_number() const;

  const char* begin_;
  const char* at_;
  const char* end_;
};

}  // namespace vdwmesh::formats
