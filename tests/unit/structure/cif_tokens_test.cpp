// The syntax of CIF 1.1, by the examples of its description (International Tables G, chapter 2.2).
#include "structure/cif/cif_tokens.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "core/errors.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string kPath = "a.cif";

std::vector<std::string> texts(const std::string& text) {
  CifTokens tokens(text, kPath);
  std::vector<std::string> found;
  for (CifToken token = tokens.next(); token.kind != CifKind::end; token = tokens.next())
    found.emplace_back(token.text);
  return found;
}

std::vector<CifKind> kinds(const std::string& text) {
  CifTokens tokens(text, kPath);
  std::vector<CifKind> found;
  for (CifToken token = tokens.next(); token.kind != CifKind::end; token = tokens.next())
    found.push_back(token.kind);
  return found;
}

std::string refusal(const std::string& text) {
  try {
    texts(text);
  } catch (const FileFormatError& error) {
    return error.what();
  }
  return "read";
}

TEST(CifTokens, StandBetweenBlanksAndLineEnds) {
  EXPECT_THAT(texts("data_x\n_a.b\t1.5\r\n# a comment 'x\n_c.d a#b #c"),
              ElementsAre("data_x", "_a.b", "1.5", "_c.d", "a#b"));
  EXPECT_THAT(texts(""), ElementsAre());
  EXPECT_THAT(texts(" \n#"), ElementsAre());
}

TEST(CifTokens, KeywordsMayBeInAnyCase) {
  EXPECT_THAT(kinds("DATA_x Loop_ _A save_f save_ loopy data loop_x 'loop_' \"_a\" stop_x"),
              ElementsAre(CifKind::data, CifKind::loop, CifKind::tag, CifKind::save, CifKind::save,
                          CifKind::value, CifKind::value, CifKind::value, CifKind::value,
                          CifKind::value, CifKind::value));
  EXPECT_THAT(refusal("data_x\nSTOP_"), HasSubstr("a.cif:2: the reserved word STOP_"));
  EXPECT_THAT(refusal("global_ x"), HasSubstr("reserved"));
}

// "A quote character inside is allowed unless a blank follows": 'a dog's life' of the description.
TEST(CifTokens, QuotesEndBeforeBlanks) {
  EXPECT_THAT(texts("'a dog's life' \"5'\" O5' ''"),
              ElementsAre("'a dog's life'", "\"5'\"", "O5'", "''"));
  EXPECT_THAT(refusal("data_x\n_a 'no end\n'"), HasSubstr("a.cif:2: a quote without end"));
}

TEST(CifTokens, TextFieldsBeginAndEndWithALine) {
  EXPECT_THAT(texts("_a\n;one\n two;\n;\n_b ;c"), ElementsAre("_a", ";one\n two;\n;", "_b", ";c"));
  EXPECT_EQ(cif_text(";one\n two;\n;"), "one\n two;");
  EXPECT_EQ(cif_text(";one\r\n;"), "one");
  EXPECT_EQ(cif_text(";c"), ";c");
  EXPECT_THAT(refusal("_a\n;one\n two;"), HasSubstr("a.cif:2: a text field without end"));
}

TEST(CifTokens, ValuesThatAreNotGivenAreEmptyUnlessQuoted) {
  EXPECT_EQ(cif_text("?"), "");
  EXPECT_EQ(cif_text("."), "");
  EXPECT_EQ(cif_text("'?'"), "?");
  EXPECT_EQ(cif_text("\".\""), ".");
  EXPECT_EQ(cif_text("''"), "");
  EXPECT_EQ(cif_text("'O5''"), "O5'");
}

TEST(CifTokens, NumbersMayHaveAnUncertainty) {
  EXPECT_EQ(cif_number("1.5"), 1.5);
  EXPECT_EQ(cif_number("+.5"), 0.5);
  EXPECT_EQ(cif_number("-1.25e2"), -125);
  EXPECT_EQ(cif_number("0.1(12)"), 0.1);
  for (const char* none : {"", "?", ".", "-", "+", "+-3", "nan", "-inf", "inf", "1e999", "1.5(",
                           "1.5(x)", "1.5)", "abc", "0x1F", "1,5", "'1'"})
    EXPECT_TRUE(std::isnan(cif_number(none))) << none;
}

// Numbers of few digits are read by a shortcut, others by the standard library. strtod() rounds
// correctly and shares nothing with either.
TEST(CifTokens, NumbersAreTheNearestDoubles) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    std::string digits = std::to_string(random());
    digits.resize(1 + random() % std::min<std::size_t>(digits.size(), 18));
    const std::string point = random() % 8 != 0 ? "." : "";
    const std::string number =
        (random() % 2 != 0 ? "-" : "") + digits.insert(random() % (digits.size() + 1), point);
    const double expected = std::strtod(number.c_str(), nullptr);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(cif_number(number)),
              std::bit_cast<std::uint64_t>(expected))
        << number;
  }
  EXPECT_TRUE(std::signbit(cif_number("-0.000")));
}

}  // namespace
}  // namespace vdwmesh::testing
