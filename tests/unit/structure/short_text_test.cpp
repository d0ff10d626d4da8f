// A ShortText holds what a std::string holds, whatever its length.
#include "structure/short_text.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace vdwmesh::testing {
namespace {

// Texts of up to 12 characters, among them NUL and bytes above 127, that share beginnings and ends.
std::vector<std::string> texts() {
  std::vector<std::string> found{"", std::string(1, '\0'), std::string(3, '\0'), "\xff",
                                 "\xff\xfe"};
  const std::string long_one = "ABCDEFGHIJKL", other = "ABCDEFGHIJKM";
  for (std::size_t size = 1; size <= long_one.size(); ++size) {
    found.push_back(long_one.substr(0, size));
    found.push_back(long_one.substr(long_one.size() - size));
    found.push_back(other.substr(other.size() - size));
    found.push_back(std::string(size, 'x'));
  }
  return found;
}

TEST(ShortText, IsTheTextItWasMadeOf) {
  EXPECT_EQ(sizeof(ShortText), 8U);
  for (const std::string& text : texts()) {
    const ShortText made(text);
    EXPECT_EQ(made.str(), text);
    EXPECT_EQ(made.view(), text);
    EXPECT_EQ(made.size(), text.size());
    EXPECT_EQ(made.empty(), text.empty());
    EXPECT_EQ(std::string(made.begin(), made.end()), text);
    const std::string converted = made;
    EXPECT_EQ(converted, text);
  }
  EXPECT_TRUE(ShortText().empty());
}

TEST(ShortText, ComparesAndJoinsAsStringsDo) {
  for (const std::string& a : texts())
    for (const std::string& b : texts()) {
      const ShortText x(a), y(b);
      EXPECT_EQ(x == y, a == b);
      EXPECT_EQ(x != y, a != b);
      EXPECT_EQ(x < y, a < b);
      EXPECT_EQ(x == b, a == b);
      EXPECT_EQ(a == y, a == b);
      EXPECT_EQ(x != std::string_view(b), a != b);
      EXPECT_EQ(x + y, a + b);
      EXPECT_EQ(x + b, a + b);
      EXPECT_EQ(a + y, a + b);
    }
  EXPECT_TRUE(ShortText("CA") == "CA");
  EXPECT_EQ(ShortText("CA") + " " + ShortText("a residue"), "CA a residue");
}

TEST(ShortText, CopiesAreTextsOfTheirOwn) {
  for (const std::string& a : texts())
    for (const std::string& b : texts()) {
      ShortText x(a);
      const ShortText copy(x);
      x = ShortText(b);
      EXPECT_EQ(copy.str(), a);
      EXPECT_EQ(x.str(), b);
      x = copy;
      EXPECT_EQ(x.str(), a);
      const ShortText moved(std::move(x));
      EXPECT_EQ(moved.str(), a);
      x = b;  // a text that was moved from takes a new value
      EXPECT_EQ(x.str(), b);
      x = *&x;
      EXPECT_EQ(x.str(), b);
    }
}

TEST(ShortText, IsWrittenToStreams) {
  std::ostringstream out;
  out << ShortText("N") << ' ' << ShortText("longer than seven");
  EXPECT_EQ(out.str(), "N longer than seven");
}

}  // namespace
}  // namespace vdwmesh::testing
