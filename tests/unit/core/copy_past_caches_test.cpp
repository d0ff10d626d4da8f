// Copies past the caches against the bytes that were to be copied. What is around them must stay.
#include "core/copy_past_caches.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

namespace vdwmesh {
namespace {

using Bytes = std::vector<unsigned char>;
constexpr std::size_t kLine = 64;
constexpr unsigned char kGuard = 0xa5;

Bytes random_bytes(std::size_t count) {
  std::mt19937_64 random(count);
  Bytes bytes(count);
  for (unsigned char& b : bytes) b = static_cast<unsigned char>(random());
  return bytes;
}

// Memory from the beginning of a line on, a line of guards behind it.
class Lines {
 public:
  explicit Lines(std::size_t bytes) : memory_(bytes + 2 * kLine, kGuard) {}
  unsigned char* begin() {
    const auto address = reinterpret_cast<std::uintptr_t>(memory_.data());
    return memory_.data() + (kLine - address % kLine) % kLine;
  }
  void clear() { std::ranges::fill(memory_, kGuard); }
  // Whether this part has these bytes, and all other memory is as it was.
  bool has(const unsigned char* part, const unsigned char* bytes, std::size_t count) const {
    const auto is_guard = [](unsigned char b) { return b == kGuard; };
    const unsigned char *first = memory_.data(), *last = first + memory_.size();
    return std::all_of(first, part, is_guard) && std::all_of(part + count, last, is_guard) &&
           (count == 0 || std::memcmp(part, bytes, count) == 0);
  }

 private:
  Bytes memory_;
};

TEST(CopyPastCaches, AnyAlignmentAndLength) {
  constexpr std::size_t kLongest = 300;
  const Bytes bytes = random_bytes(kLine + kLongest);
  Lines from(kLine + kLongest), to(kLine + kLongest);
  std::ranges::copy(bytes, from.begin());
  for (std::size_t source = 0; source < kLine; ++source) {
    for (std::size_t target = 0; target < kLine; ++target) {
      for (std::size_t length = 0; length <= kLongest; ++length) {
        to.clear();
        copy_past_caches(to.begin() + target, from.begin() + source, length);
        ASSERT_TRUE(to.has(to.begin() + target, bytes.data() + source, length))
            << length << " bytes from offset " << source << " to " << target;
      }
    }
  }
}

// More than a buffer of a transfer, and not whole lines.
TEST(CopyPastCaches, LargeOnes) {
  for (const std::size_t length : {std::size_t{1} << 16, (std::size_t{2} << 20) + 1,
                                   (std::size_t{8} << 20) - 1, (std::size_t{8} << 20) + 100}) {
    const Bytes bytes = random_bytes(length);
    for (const std::size_t target : {0, 1, 17, 63}) {
      Lines to(kLine + length);
      copy_past_caches(to.begin() + target, bytes.data(), length);
      ASSERT_TRUE(to.has(to.begin() + target, bytes.data(), length))
          << length << " bytes to offset " << target;
    }
  }
}

// For the address sanitizer: nothing beside the source is read, and nothing beside the target is
// written.
TEST(CopyPastCaches, StaysInItsMemory) {
  for (std::size_t length = 1; length <= 300; ++length) {
    const Bytes bytes = random_bytes(length);
    Bytes to(length, kGuard);
    copy_past_caches(to.data(), bytes.data(), length);
    ASSERT_EQ(to, bytes);
  }
}

TEST(CopyPastCaches, OnlyWhatIsBeyondTheCaches) {
  EXPECT_EQ(stores_for(0, 512), Stores::usual);
  EXPECT_EQ(stores_for(511, 512), Stores::usual);
  EXPECT_EQ(stores_for(512, 512), Stores::past_caches);
  EXPECT_EQ(stores_for(std::size_t{1} << 40, 512), Stores::past_caches);
  EXPECT_EQ(stores_for(0, 0), Stores::past_caches);
}

TEST(CopyPastCaches, EitherWayAllIsCopied) {
  const Bytes bytes = random_bytes(1000);
  for (const Stores stores : {Stores::usual, Stores::past_caches}) {
    Lines to(1000);
    copy_bytes(to.begin() + 3, bytes.data(), 900, stores);
    EXPECT_TRUE(to.has(to.begin() + 3, bytes.data(), 900));
  }
}

}  // namespace
}  // namespace vdwmesh
