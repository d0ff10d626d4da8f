// The bytes of DejaVuSans.ttf, put into a source file when building.
#pragma once

#include <string_view>

namespace vdwmesh {

std::string_view font_data();

}  // namespace vdwmesh
