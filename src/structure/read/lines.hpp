// Splits text files into lines and fields, turns fields into numbers, and prepares text for
// messages. Views that are returned point into the text, which must outlive them. Internal header
// of this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh {

// Moves the next line from the front of `rest` into `line`, without its end. A line ends with LF
// (Unix), CR LF (Windows) or CR alone (old Macintosh). Returns false if `rest` is empty.
bool next_line(std::string_view& rest, std::string_view& line);

// The field without blanks, tabs and line ends on either side.
std::string_view trimmed(std::string_view field);

// Columns [first, first + count) of a line. Columns count from 0, while the PDB's manual counts
// them from 1. The result is shorter, or empty, if the line ends early.
std::string_view columns(std::string_view line, std::size_t first, std::size_t count);

// The words of the line, between blanks and tabs.
std::vector<std::string_view> split_at_blanks(std::string_view line);

// The value of a number such as "-12.345", of at most 15 digits and nothing else; nothing for any
// other text, which may be a number all the same. Much faster than std::from_chars.
std::optional<double> short_decimal(std::string_view text);

// The field as a finite number. Nothing if any part of the trimmed field is something else: an
// empty field, text behind the digits, NaN or infinity.
std::optional<double> finite_number(std::string_view field);

// The same; throws FileFormatError where it is nothing. `what` names the field in the message.
double number_or_refuse(std::string_view field, std::string_view what, const std::string& path,
                        std::uint32_t line);

// The field as a decimal integer, with the same rule. Nothing if it does not fit 64 bits.
std::optional<std::int64_t> whole_number(std::string_view field);

// The field in single quotes, for messages: "?" replaces unprintable characters, and long fields
// are cut. A damaged file can therefore not send control characters to the terminal.
std::string in_quotes(std::string_view field);

// The message with every run of white space replaced by one blank. Messages of other libraries may
// span several lines; errors of this library are one line.
std::string one_line(std::string_view message);

}  // namespace vdwmesh
