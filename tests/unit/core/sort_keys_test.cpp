// The radix sort of keys against the sort of the standard library, on keys unlike Morton codes.
#include "core/order/sort_keys.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/order/split_mix.hpp"

namespace vdwmesh {
namespace {

// The keys have their indices in the lowest `low` bits.
std::vector<std::uint64_t> keys_of(std::size_t count, int low,
                                   std::uint64_t (*upper)(std::uint64_t)) {
  std::vector<std::uint64_t> keys(count);
  for (std::size_t i = 0; i < count; ++i) keys[i] = upper(i) << low | i;
  return keys;
}

struct Upper {
  const char* name;
  std::uint64_t (*of)(std::uint64_t index);
};

class SortKeys : public ::testing::TestWithParam<Upper> {};

TEST_P(SortKeys, AgreesWithTheStandardLibrary) {
  constexpr int kIndexBits = 20;
  for (const std::size_t count : {0u, 1u, 2u, 255u, 40000u, 300000u}) {
    std::vector<std::uint64_t> keys = keys_of(count, kIndexBits, GetParam().of);
    std::vector<std::uint64_t> sorted = keys;
    std::sort(sorted.begin(), sorted.end());
    sort_keys(keys, kIndexBits);
    EXPECT_EQ(keys, sorted) << count;
  }
}

// The largest sets are divided into groups; in the last two cases some groups are large again.
INSTANTIATE_TEST_SUITE_P(
    All, SortKeys,
    ::testing::Values(Upper{"random", [](std::uint64_t i) { return split_mix(i) >> 20; }},
                      Upper{"few_bits", [](std::uint64_t i) { return split_mix(i) & 5; }},
                      Upper{"alike", [](std::uint64_t) { return std::uint64_t{77}; }},
                      Upper{"descending",
                            [](std::uint64_t i) { return std::uint64_t{0xfffffffffff} - i; }},
                      Upper{"one_far_away",
                            [](std::uint64_t i) {
                              return i == 3 ? std::uint64_t{0xfffffffffff} : split_mix(i) >> 50;
                            }},
                      Upper{"mostly_in_one_group",
                            [](std::uint64_t i) {
                              return i % 64 == 0 ? split_mix(i) >> 20 : split_mix(i) >> 40;
                            }}),
    [](const auto& info) { return std::string(info.param.name); });

// Without an index in the lower bits, keys may be equal.
TEST(SortKeysAlone, EqualKeys) {
  std::vector<std::uint64_t> keys(100000);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = split_mix(i) % 1000 << 40;
  std::vector<std::uint64_t> sorted = keys;
  std::sort(sorted.begin(), sorted.end());
  sort_keys(keys, 0);
  EXPECT_EQ(keys, sorted);
}

}  // namespace
}  // namespace vdwmesh
