// How the shapes of a mesh's triangles are distributed, in bins that are the same for every mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

enum class BinScale : std::uint8_t { linear, logarithmic };

// Bin i of n holds values from edge i up to, but not including, edge i + 1; `upper` itself is in
// the last one. NaN counts as below.
struct Histogram {
  BinScale scale = BinScale::linear;
  double lower = 0, upper = 1;
  std::uint64_t below = 0, above = 0;
  std::vector<std::uint64_t> counts;
};

// Throws InvalidInput for no bins, or a lower bound that is not below the upper one (of logarithmic
// bins: and above 0).
Histogram histogram(std::span<const double> values, BinScale scale, double lower, double upper,
                    std::size_t bins);

struct QualityHistograms {
  Histogram min_angle_deg;  // smallest angle of each triangle: 30 bins of 2 degrees
  Histogram aspect_ratio;   // circumradius / (2 inradius), 1 to 1024, four bins per octave
  Histogram edge_length;    // each edge once, 2^-10 Å to 4 Å, four bins per octave
};

// The values are those of quality(): degenerate triangles have an angle of 0 and no aspect ratio.
QualityHistograms quality_histograms(const IndexedMesh& mesh);

}  // namespace vdwmesh
