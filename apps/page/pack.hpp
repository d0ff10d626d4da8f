// Bytes as text that a page can carry.
#pragma once

#include <string>
#include <string_view>

namespace vdwmesh::apps {

// zlib format, as the browser's DecompressionStream("deflate") reads it, then base64 (RFC 4648).
std::string pack(std::string_view bytes);

}  // namespace vdwmesh::apps
