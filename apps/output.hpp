// Output files appear whole or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace vdwmesh::apps {

// Throws InvalidInput naming `option` when `path` is a directory or its folder is not there or not
// writable: asked before work begins.
void check_writable(std::string_view option, const std::filesystem::path& path);

// Writes beside the name, then renames; a device or pipe is written to directly. Throws
// FileFormatError.
void write_file(const std::filesystem::path& path, std::string_view content);

// Throws FileFormatError when not all of it could be written.
void write_standard_output(std::string_view content);

}  // namespace vdwmesh::apps
