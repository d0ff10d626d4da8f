// Corners of the union's boundary with more digits than a double has, for decisions that double
// leaves open. Apart from simplex_shape.hpp, because the number type is a heavy header.
#pragma once

#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include "complex/number_vector.hpp"

namespace vdwmesh {

using WideFloat = boost::multiprecision::cpp_bin_float_100;  // 335 bits

// The two points of common_points() relative to the centre of a: above, below. They are those of
// balls whose squared radii are larger by `more`, which leaves the power diagram as it is.
std::array<numbers::Vector<WideFloat>, 2> common_points_wide(const Sphere& a, const Sphere& b,
                                                             const Sphere& c,
                                                             const WideFloat& more = 0);

}  // namespace vdwmesh
