// The colours in which atoms are drawn, by chemical element.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace vdwmesh {

using RgbColor = std::array<std::uint8_t, 3>;  // sRGB, red first, 0 to 255

// The CPK colour of an element, as Jmol extends them. `element` is a
// chemical symbol, whose case does not matter. Elements outside of the table, which has those met
// in structures of macromolecules, share a strong pink.
RgbColor element_color(std::string_view element);

// Grey: the colour of a vertex that has no atom, or of a mesh until it is coloured.
inline constexpr RgbColor kPlainColor{176, 176, 176};

}  // namespace vdwmesh
