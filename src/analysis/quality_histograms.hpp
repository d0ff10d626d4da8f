// Histograms of the quality of a mesh. The bins are the same for every mesh, so that histograms of
// different meshes can be compared and drawn together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/indexed_mesh.hpp"

namespace vdwmesh {

enum class BinScale : std::uint8_t { linear, logarithmic };

// A histogram of n bins between `lower` and `upper`, of equal width on the chosen scale. A bin
// contains its lower edge but not its upper one; only the last bin contains both.
struct Histogram {
  BinScale scale = BinScale::linear;
  double lower = 0, upper = 1;
  std::uint64_t below = 0, above = 0;  // values outside the bounds; NaN counts as below
  std::vector<std::uint64_t> counts;   // one per bin
};

// Throws InvalidInput if `bins` is 0, if `lower` is not below `upper`, or if the scale is
// logarithmic and `lower` is not above 0.
Histogram histogram(std::span<const double> values, BinScale scale, double lower, double upper,
                    std::size_t bins);

struct QualityHistograms {
  Histogram min_angle_deg;  // smallest angle of each triangle: 30 bins of 2 degrees
  Histogram aspect_ratio;   // circumradius / (2 inradius), 1 to 1024, four bins per octave
  Histogram edge_length;    // each edge once, 2^-10 Å to 4 Å, four bins per octave
};

// Counts the same values as quality(): degenerate triangles have an angle of 0 and no aspect ratio.
QualityHistograms quality_histograms(const IndexedMesh& mesh);

}  // namespace vdwmesh
