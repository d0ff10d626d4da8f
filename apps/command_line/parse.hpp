// Option values from text. Every function throws InvalidInput with one line that names the option,
// what was given and what would be accepted.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace vdwmesh::apps {

// Finite and above zero ("--spacing"), at least zero ("--padding"), or any finite number.
enum class Range { positive, non_negative, finite };
double parse_number(std::string_view option, std::string_view text, Range range,
                    std::string_view example);

// A whole number in [lowest, highest].
std::int64_t parse_integer(std::string_view option, std::string_view text, std::int64_t lowest,
                           std::int64_t highest);

// "8G", "512M", "1000000": bytes with the binary suffixes K, M, G, T.
std::uint64_t parse_bytes(std::string_view option, std::string_view text);

// "a, b or c".
std::string list_names(std::span<const std::string_view> names);

// "; did you mean NAME?" with the known name that is closest to `given`; empty where none is close.
// A name of the field for a known one is taken first ("ses" for "excluded").
// Close is one slip of the fingers, two in names of more than five letters: a letter that is wrong,
// missing, too many, or swapped with its neighbour.
std::string suggestion(std::string_view given, std::span<const std::string_view> known);

// For a name that is not among the `known` ones: lists them, and says which may have been meant.
[[noreturn]] void throw_unknown_name(std::string_view option, std::string_view text,
                                     std::span<const std::string_view> known);

}  // namespace vdwmesh::apps
