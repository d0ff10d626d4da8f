// Where the arrays of a VTKHDF file are, of sizes that no test could fill.
#include "distributed/files/vtkhdf_layout.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "distributed/files/vtkhdf_file.hpp"

namespace vdwmesh {
namespace {

using Extent = std::pair<std::uint64_t, std::uint64_t>;  // first byte, number of bytes

std::vector<Extent> extents_of(const VtkHdfPlaces& places, const MeshSize& size) {
  const auto& [v, f] = size;
  return {{places.points, 24 * v}, {places.normals, 12 * v},      {places.colors, 3 * v},
          {places.atoms, 4 * v},   {places.connectivity, 24 * f}, {places.offsets, 8 * (f + 1)},
          {places.types, f}};
}

// Bytes and arrays are the whole file, without gaps or overlaps.
TEST(VtkHdfLayout, ArraysHaveRoomBeyondTwoToTheThirtyTwo) {
  if (!has_vtkhdf()) GTEST_SKIP() << "this build has no HDF5";
  for (const std::uint64_t vertices : {std::uint64_t{4}, (std::uint64_t{1} << 33) + 1}) {
    const MeshSize size{vertices, 2 * vertices - 4};
    const VtkHdfLayout layout = lay_out_vtkhdf(size);
    std::vector<Extent> extents = extents_of(layout.places, size);
    std::uint64_t bytes = 0;
    for (const auto& [place, around] : layout.around) {
      extents.emplace_back(place, around.size());
      bytes += around.size();
    }
    EXPECT_LT(bytes, 100'000u);  // whatever the size of the mesh
    std::ranges::sort(extents);
    std::uint64_t end = 0;
    for (const auto& [first, count] : extents) {
      EXPECT_EQ(first, end);
      end = first + count;
    }
  }
}

}  // namespace
}  // namespace vdwmesh
