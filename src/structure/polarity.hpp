// Whether an atom counts as polar or apolar. Radius sets of united atoms define this together with
// the radii, for sums of polar and apolar accessible area.
#pragma once

#include <cstdint>

namespace vdwmesh {

// unknown: the radius set has no such classes, or does not have the atom.
enum class Polarity : std::uint8_t { unknown, polar, apolar };

}  // namespace vdwmesh
