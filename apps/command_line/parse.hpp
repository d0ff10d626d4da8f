// Option values from text. Every function throws InvalidInput with one line that names the option,
// what was given and what would be accepted.
#pragma once

#include <cstdint>
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

}  // namespace vdwmesh::apps
