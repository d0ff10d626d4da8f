// Output files appear whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

namespace vdwmesh::apps {

// Asked before work begins. Throws InvalidInput naming `option` where a file cannot be written to
// `path`: it is a folder, its folder is not there or may not be written to, its name is too long,
// or a file of that name is there and may not be replaced.
void check_writable(std::string_view option, const std::filesystem::path& path);

// Calls `write`, which makes the file `path`, while signals wait until the file stands or is gone.
// They do not wait for a pipe or device: nobody knows how long its other end takes.
void write_whole(const std::filesystem::path& path, const std::function<void()>& write);

// Writes the file `path`; a device or pipe is written to directly. Throws FileFormatError.
void write_file(const std::filesystem::path& path, std::string_view content);

// Throws FileFormatError when not all of it could be written.
void write_standard_output(std::string_view content);

// Where an option said: nowhere (empty), standard output ("-") or a file.
void write_output(const std::string& where, std::string_view content);

}  // namespace vdwmesh::apps
