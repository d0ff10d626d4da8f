// Lines and fields of text files, whatever ends their lines. Inside the room only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh {

// Takes the next line off `rest`; LF, CR LF and CR alone end lines. False at the end.
bool next_line(std::string_view& rest, std::string_view& line);

std::string_view trimmed(std::string_view field);

// Columns [first, first + count) of a line, counted from 0; shorter where the line ends early.
std::string_view columns(std::string_view line, std::size_t first, std::size_t count);

std::vector<std::string_view> split_at_blanks(std::string_view line);

// The whole field as a finite number; nothing for anything else (blank, text, NaN, infinity).
std::optional<double> finite_number(std::string_view field);

// The whole field as a decimal integer.
std::optional<std::int64_t> whole_number(std::string_view field);

// Printable and short, for messages.
std::string in_quotes(std::string_view field);

// Line breaks become blanks, so that a message is one line.
std::string one_line(std::string_view message);

}  // namespace vdwmesh
