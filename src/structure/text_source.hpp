// Whole files in memory: plain or gzipped, from disk or standard input. Inside the room only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "core/buffer.hpp"

namespace vdwmesh {

using Text = Buffer<char>;

// Larger texts are refused: about ten times the largest entry of the PDB, far below what a
// maliciously compressed file can unfold to.
inline constexpr std::uint64_t kMaxTextBytes = std::uint64_t{2} << 30;

// The bytes of `path` ("-": standard input), unpacked where they are gzipped (told by the first
// bytes, not by the name). Throws FileFormatError (missing, unreadable, a directory, damaged gzip
// data) and LimitExceeded (more than `limit` bytes).
Text read_text(const std::filesystem::path& path, std::uint64_t limit = kMaxTextBytes);

}  // namespace vdwmesh
