// Splits the text of a CIF file into tokens. Views point into the text. Internal header of this
// folder.
//
// gemmi has a parser of CIF, which small_cif.cpp uses. It makes a string of every value: for 6ZU5
// it takes more time than the rest of `vdwmesh exact` and three times the memory of all of that
// command, so files of macromolecules are read by these tokens instead.
//
// The syntax is that of CIF 1.1 (Hall and McMahon, International Tables for Crystallography G,
// chapter 2.2). Tokens stand between blanks and line ends; "#" at the beginning of a token opens a
// comment. A value may be quoted, 'so' or "so": the closing quote is one with a blank or a line end
// behind it. A semicolon at the beginning of a line opens a text field, which ends with the next
// such semicolon.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace vdwmesh {

// What a character begins: most of them a word that is a value; some a word that may be a tag or
// reserved; and a few a quote, a text field or a comment.
enum class CifByte : std::uint8_t { value, word, blank, special };
inline constexpr std::array<CifByte, 256> kCifBytes = [] {
  std::array<CifByte, 256> kinds{};
  for (const char c : {' ', '\n', '\t', '\r'})
    kinds[static_cast<unsigned char>(c)] = CifByte::blank;
  for (const char c : std::string_view("_dDgGlLsS"))
    kinds[static_cast<unsigned char>(c)] = CifByte::word;
  for (const char c : std::string_view("'\";#"))
    kinds[static_cast<unsigned char>(c)] = CifByte::special;
  return kinds;
}();
inline CifByte cif_byte(char c) { return kCifBytes[static_cast<unsigned char>(c)]; }

enum class CifKind { end, data, save, loop, tag, value };

struct CifToken {
  CifKind kind = CifKind::end;
  std::string_view
      text;  // as it stands in the file: a value with its quotes, "data_" with its name
};

class CifTokens {
 public:
  // `text` must outlast the tokens. Lines end with LF, or with CR LF. `path` is for messages.
  CifTokens(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  // The next token; of the kind `end` behind the last. Throws FileFormatError, with the line, for a
  // quote or a text field without end, and for the reserved words stop_ and global_.
  CifToken next();

  // Throws FileFormatError; the message names the line of the last token.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  CifToken next_special();
  CifKind kind_of(std::string_view word) const;
  void skip_blanks();
  std::string_view take(std::size_t length);
  CifToken text_field();
  CifToken quoted();
  CifToken word();

  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0;     // behind the last token
  std::size_t start_ = 0;  // of the last token
};

// This loop visits every character of a table of numbers and names, so it is inline.
inline CifToken CifTokens::next() {
  const char* const text = text_.data();
  const char* const end = text + text_.size();
  const char* first = text + at_;
  while (first != end && cif_byte(*first) == CifByte::blank) ++first;
  at_ = static_cast<std::size_t>(first - text);
  if (first == end || cif_byte(*first) == CifByte::special) return next_special();
  const char* last = first + 1;
  while (last != end && cif_byte(*last) != CifByte::blank) ++last;
  start_ = at_;
  at_ = static_cast<std::size_t>(last - text);
  const std::string_view word(first, static_cast<std::size_t>(last - first));
  return {cif_byte(*first) == CifByte::value ? CifKind::value : kind_of(word), word};
}

// The value without its quotes or the semicolons of a text field. Empty for the values "?"
// (unknown) and "." (does not apply), unless they are quoted.
std::string_view cif_text(std::string_view value);

// The value as a number, with or without a standard uncertainty: "1.5(3)" is 1.5. NaN for anything
// else, and for numbers beyond the range of doubles.
double cif_number(std::string_view value);

}  // namespace vdwmesh
