// Lines where a surface ends in front of what is farther.
#pragma once

#include <cstdint>
#include <vector>

namespace vdwmesh {

// The distances from the viewer of what a picture shows, sample by sample in rows; infinite where
// nothing is seen.
struct DepthMap {
  int width = 0, height = 0;     // samples
  std::vector<float> distances;  // Å
};

// Returns 1 for every sample within `radius` samples of the end of a surface, and 0 for all others.
// A surface ends in a sample one of whose four neighbours is farther by more than `jump` (Å).
std::vector<std::uint8_t> find_outline(const DepthMap& map, double jump, double radius);

}  // namespace vdwmesh
