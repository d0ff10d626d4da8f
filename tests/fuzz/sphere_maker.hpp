// Sets of balls from bytes, degenerate on purpose.
#pragma once

#include "extract/sphere_set.hpp"
#include "fuzz/byte_source.hpp"

namespace vdwmesh::fuzz {

// Up to `most` balls, at least one; Å. Each stands free, on a lattice, on or almost on another,
// touches another from outside or inside, or is far smaller or larger than the others.
SphereSet make_spheres(ByteSource& bytes, int most);

// As an XYZR file, so that what was found can be given to the program.
void print(const SphereSet& spheres);

}  // namespace vdwmesh::fuzz
