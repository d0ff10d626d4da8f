// Which format a file is in. Inside the room only.
#pragma once

#include <filesystem>
#include <string_view>

#include "structure/reader.hpp"

namespace vdwmesh {

// By the extension (before .gz). Throws FileFormatError for extensions that are not read, and
// InvalidInput for standard input, which has none.
StructureFormat format_of_name(const std::filesystem::path& path);

// The text without a byte order mark. Throws FileFormatError, saying what it is, for what cannot
// be a file of that format: empty, binary, an archive, a web page, another structure format.
std::string_view checked_text(std::string_view bytes, StructureFormat format,
                              const std::filesystem::path& path);

}  // namespace vdwmesh
