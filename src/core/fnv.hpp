// FNV-1a of 64 bits: says whether two texts are the same, where nobody means to deceive.
#pragma once

#include <cstdint>
#include <string_view>

namespace vdwmesh {

// The hash of a text whose beginning had the hash `before`.
constexpr std::uint64_t fnv1a(std::string_view text, std::uint64_t before = 0xcbf29ce484222325) {
  for (const char c : text) before = (before ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return before;
}

}  // namespace vdwmesh
