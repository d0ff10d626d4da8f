// Colours of the elements.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace vdwmesh {

// sRGB by symbol, in any case: the CPK colours as Jmol extends them; elements that are not met in
// structures of macromolecules share one colour, a strong pink.
std::array<std::uint8_t, 3> element_color(std::string_view element);

}  // namespace vdwmesh
