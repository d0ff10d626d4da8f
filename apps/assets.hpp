// Files that are part of the program: the page of a study and the libraries it needs.
#pragma once

#include <string_view>

namespace vdwmesh::apps {

// Their names are in CMakeLists.txt; any other is a mistake of ours (std::logic_error).
std::string_view asset(std::string_view name);

}  // namespace vdwmesh::apps
