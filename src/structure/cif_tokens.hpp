// Splits the text of a CIF file into tokens. Views point into the text. Internal header of this
// folder.
//
// The syntax is that of CIF 1.1 (Hall and McMahon, International Tables for Crystallography G,
// chapter 2.2). Tokens stand between blanks and line ends; "#" at the beginning of a token opens a
// comment. A value may be quoted, 'so' or "so": the closing quote is one with a blank or a line end
// behind it. A semicolon at the beginning of a line opens a text field, which ends with the next
// such semicolon.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vdwmesh {

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

// The value without its quotes or the semicolons of a text field. Empty for the values "?"
// (unknown) and "." (does not apply), unless they are quoted.
std::string_view cif_text(std::string_view value);

// The value as a number, with or without a standard uncertainty: "1.5(3)" is 1.5. NaN for anything
// else, and for numbers beyond the range of doubles.
double cif_number(std::string_view value);

}  // namespace vdwmesh
