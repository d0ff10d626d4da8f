// Reads a whole file into memory: plain or gzipped, from disk or from standard input. The structure
// readers and the radius tables get their text here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

#include "core/buffer.hpp"
#include "core/monitor.hpp"

namespace vdwmesh {

using Text = Buffer<char>;

// Texts of more bytes than this are refused. The limit is about ten times the largest entry of the
// PDB. It is far below the size to which a maliciously compressed file (a "zip bomb") can grow.
inline constexpr std::uint64_t kMaxTextBytes = std::uint64_t{2} << 30;

// Returns the bytes of the file `path`; "-" is standard input. Gzipped data are unpacked. They are
// recognised by their first two bytes, not by the name of the file.
// Throws FileFormatError if the file is missing, unreadable, a directory or damaged gzip data, and
// LimitExceeded if the file, or its text once unpacked, has more than `limit` bytes.
// The monitor is asked whether to stop before unpacking, and where the text has more than 256 MiB
// or several members, after each MiB that is unpacked.
Text read_text(const std::filesystem::path& path, std::uint64_t limit = kMaxTextBytes,
               Monitor* monitor = nullptr);

// The same for the bytes of a file that are in memory. `name` stands for the path in messages.
Text text_of(std::string_view bytes, const std::filesystem::path& name,
             std::uint64_t limit = kMaxTextBytes, Monitor* monitor = nullptr);

}  // namespace vdwmesh
