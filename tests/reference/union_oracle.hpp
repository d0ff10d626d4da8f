// Area and volume of a union of balls with 60 digits and more, without a triangulation: the oracle
// of the certificates.
//
// Each sphere is treated by itself. On the circle in which another sphere cuts it, every further
// ball covers one arc; what no ball covers is boundary of the sphere's exposed part. Line integrals
// along it give the area (modulo the whole sphere) and, by the divergence theorem, the volume.
// Neither power cells nor corners are looked for, and a boundary without area between its sides
// contributes nothing, so degenerate sets need no special care. Time grows with the cube of the
// number of balls that overlap.
#pragma once

#include <boost/multiprecision/mpfr.hpp>
#include <vector>

#include "reference/point.hpp"

namespace vdwmesh::reference {

using Digits = boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<100>,
                                             boost::multiprecision::et_off>;

struct WideMeasures {
  Digits area, volume;  // Å², Å³
};

// The balls' doubles are taken as real numbers. Precondition: coordinates and radii are at most 10⁵
// times the least radius, so that 100 digits tell equal circles from unequal ones.
WideMeasures union_oracle(const std::vector<Ball>& balls);

}  // namespace vdwmesh::reference
