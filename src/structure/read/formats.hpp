// Determines the format of a structure file from its name, and checks that the content can be of
// that format. Internal header of this folder.
#pragma once

#include <filesystem>
#include <string_view>

#include "structure/reader.hpp"

namespace vdwmesh {

// The format that the extension stands for; ".gz" is removed first. Throws FileFormatError for an
// unknown extension, and InvalidInput for standard input ("-"), which has no extension.
StructureFormat format_of_name(const std::filesystem::path& path);
// The same for a file. If the extension is unknown and the file is not there either, the message
// says so.
StructureFormat format_of_file(const std::filesystem::path& path);

// Returns `bytes`, without the byte order mark of UTF-8 if they are text. Throws FileFormatError if
// the bytes cannot be a file of that format: an empty or binary file, an archive, a web page or
// another structure format. The message says what the file is instead.
std::string_view checked_text(std::string_view bytes, StructureFormat format,
                              const std::filesystem::path& path);

}  // namespace vdwmesh
