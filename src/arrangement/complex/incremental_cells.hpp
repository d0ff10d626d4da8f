// The cells of a regular triangulation of some balls in general position, by insertion into flat
// arrays. For the library's own use.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "arrangement/complex/regular_cells.hpp"

namespace vdwmesh {

// What regular_cells() returns, in two thirds of its instructions, but for the order of the cells.
// Returns nothing, and leaves has_vertex alone, if it meets a tie: five balls that have one
// orthogonal sphere. Who calls it then asks regular_cells(), which decides ties. The preconditions
// are those of regular_cells(); besides, no radius is above 1. Throws as it does.
std::optional<RegularCells> incremental_cells(const std::vector<Sphere>& balls,
                                              const std::array<Vec3d, 4>& auxiliary,
                                              std::span<const std::uint32_t> indices,
                                              const TakesCell& takes,
                                              std::vector<std::uint8_t>& has_vertex,
                                              std::uint64_t memory_limit, Monitor* monitor);

}  // namespace vdwmesh
