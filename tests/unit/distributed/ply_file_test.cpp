// How large a PLY file can be: faces name vertices by 32 bits.
#include "distributed/files/ply_file.hpp"

#include <gtest/gtest.h>

#include <string>

#include "core/errors.hpp"
#include "mesh/formats/ply_records.hpp"

namespace vdwmesh {
namespace {

constexpr std::uint64_t kInts = std::uint64_t{1} << 31, kUints = std::uint64_t{1} << 32;

std::string type_of_indices(std::uint64_t vertices) {
  const std::string header = formats::ply_header({vertices, 2 * vertices}, TriangleLabels::none);
  const std::string before = "property list uchar ";
  const std::size_t place = header.find(before) + before.size();
  return header.substr(place, header.find(' ', place) - place);
}

TEST(PlyFile, IndicesAreUintsWhereIntsEnd) {
  EXPECT_EQ(type_of_indices(1), "int");
  EXPECT_EQ(type_of_indices(kInts), "int");  // the last vertex has the number 2^31 - 1
  EXPECT_EQ(type_of_indices(kInts + 1), "uint");
  EXPECT_EQ(type_of_indices(kUints), "uint");
}

TEST(PlyFile, EndsAtTwoToTheThirtyTwo) {
  EXPECT_NO_THROW(check_ply_size({kUints, 2 * kUints}));
  EXPECT_THROW(check_ply_size({kUints + 1, 2 * kUints}), LimitExceeded);
}

}  // namespace
}  // namespace vdwmesh
