// Ends of the surface are found by all cores, row by row. They are few, so that the discs around
// them are filled one after another.
#include "render/outline.hpp"

#include <algorithm>
#include <cmath>

#include "core/fixed_blocks.hpp"

namespace vdwmesh {
namespace {

// Whether one of the neighbours of sample (x, y) is farther by more than `jump`. Beyond the border
// of the map nothing is seen, and nothing known.
bool ends_at(const DepthMap& map, int x, int y, double jump) {
  const auto distance = [&map](int column, int row) {
    return map.distances[static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) +
                         static_cast<std::size_t>(column)];
  };
  const double here = distance(x, y) + jump;
  return (x > 0 && distance(x - 1, y) > here) || (x + 1 < map.width && distance(x + 1, y) > here) ||
         (y > 0 && distance(x, y - 1) > here) || (y + 1 < map.height && distance(x, y + 1) > here);
}

// Fills the disc around sample (x, y), as far as it lies in the map.
void fill_disc(const DepthMap& map, int x, int y, double radius, std::vector<std::uint8_t>& lines) {
  const int reach = static_cast<int>(radius);
  for (int row = std::max(0, y - reach); row <= std::min(map.height - 1, y + reach); ++row) {
    const int half = static_cast<int>(std::sqrt(radius * radius - (row - y) * (row - y)));
    const auto begin = lines.begin() + static_cast<std::ptrdiff_t>(row) * map.width;
    std::fill(begin + std::max(0, x - half), begin + std::min(map.width, x + half + 1),
              std::uint8_t{1});
  }
}

}  // namespace

std::vector<std::uint8_t> find_outline(const DepthMap& map, double jump, double radius) {
  std::vector<std::vector<int>> ends(static_cast<std::size_t>(map.height));  // columns of each row
  for_each_block(ends.size(), 1, [&](std::size_t row, std::size_t, std::size_t) {
    for (int x = 0; x < map.width; ++x) {
      if (ends_at(map, x, static_cast<int>(row), jump)) ends[row].push_back(x);
    }
  });
  std::vector<std::uint8_t> lines(map.distances.size(), 0);
  for (std::size_t row = 0; row < ends.size(); ++row) {
    for (const int x : ends[row]) fill_disc(map, x, static_cast<int>(row), radius, lines);
  }
  return lines;
}

}  // namespace vdwmesh
