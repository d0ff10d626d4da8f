// The font file that is embedded in the program.
#pragma once

#include <string_view>

namespace vdwmesh {

// The bytes of DejaVuSans.ttf. EmbedFont.cmake writes the source file that defines this function.
std::string_view font_data();

}  // namespace vdwmesh
