// Sets of balls from bytes, degenerate on purpose.
#pragma once

#include "fuzz/byte_source.hpp"
#include "spheres/sphere_set.hpp"

namespace vdwmesh::fuzz {

// Up to `most` balls, at least one; Å. Each stands free, on a lattice, on or almost on another,
// touches another from outside or inside, or is far smaller or larger than the others. With
// FUZZ_PRINT=1 prints them as an XYZR file, so that what was found can be given to the program.
SphereSet make_spheres(ByteSource& bytes, int most);

}  // namespace vdwmesh::fuzz
