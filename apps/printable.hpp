// Text of files and command lines, as it is shown on a terminal.
#pragma once

#include <string>
#include <utility>

#include "core/errors.hpp"

namespace vdwmesh::apps {

// Control characters become question marks, as in error messages: a residue name must not move the
// cursor or set the title of the window.
inline std::string printable(std::string text) { return Error(std::move(text)).what(); }

}  // namespace vdwmesh::apps
