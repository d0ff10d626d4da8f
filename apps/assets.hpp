// Files that are part of the program: those of its pages, and the libraries that these need.
#pragma once

#include <string_view>

namespace vdwmesh::apps {

// Their names are in CMakeLists.txt; any other is a mistake of ours (std::logic_error).
std::string_view asset(std::string_view name);

}  // namespace vdwmesh::apps
