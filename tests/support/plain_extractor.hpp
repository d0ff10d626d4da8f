// The extractor without its shortcuts, for tests of what those leave out.
#pragma once

#include <cstdint>
#include <vector>

#include "extract/extractor.hpp"

namespace vdwmesh::testing {

// Keys of all bricks of a grid, rising.
std::vector<std::uint64_t> all_bricks(const GridSpec& grid);

// Marching cubes over all bricks of the grid with the CPU's code for a brick: the extractor without
// its search. The same mesh, bit for bit, where the search loses no brick.
ExtractResult extract_all_bricks(const SphereSet& spheres, const ExtractOptions& options);

// The same, and every node and every edge asks all spheres of the set: no search for spheres, no
// single precision where double decides, no row that is passed over. Slow: the time is that of
// nodes times spheres.
ExtractResult extract_plainly(const SphereSet& spheres, const ExtractOptions& options);

}  // namespace vdwmesh::testing
