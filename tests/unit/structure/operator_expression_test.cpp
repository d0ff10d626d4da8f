// Operator expressions of mmCIF files against an expansion written apart, and what must be refused.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "structure/assembly_files.hpp"
#include "structure/temp_file.hpp"

namespace vdwmesh::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// How far the only atom was shifted in each copy, in the order of the copies.
std::vector<int> shifts_of(const std::string& expression) {
  const Molecule molecule = read_text_as(
      "a.cif", kOneAtom + generators({{"1", expression, "A"}}) + operator_list(shifts(8)),
      assembly("1"));
  std::vector<int> result;
  for (const Atom& atom : molecule.atoms) result.push_back(static_cast<int>(atom.position.x) - 1);
  return result;
}

// The forms that the dictionary lists for _pdbx_struct_assembly_gen.oper_expression, and those of
// virus entries of the PDB.
TEST(OperatorExpressions, FormsOfTheDictionary) {
  EXPECT_THAT(shifts_of("(1)"), ElementsAre(2));
  EXPECT_THAT(shifts_of("(1,2,5)"), ElementsAre(2, 4, 32));
  EXPECT_THAT(shifts_of("(1-4)"), ElementsAre(2, 4, 8, 16));
  EXPECT_THAT(shifts_of("(1,2)(3,4)"), ElementsAre(2 + 8, 2 + 16, 4 + 8, 4 + 16));
  EXPECT_THAT(shifts_of("P"), ElementsAre(1024));
  EXPECT_THAT(shifts_of("1,2,5"), ElementsAre(2, 4, 32));
  EXPECT_THAT(shifts_of("1-4"), ElementsAre(2, 4, 8, 16));
  EXPECT_THAT(shifts_of("(X0)(1-2,4)"), ElementsAre(2050, 2052, 2064));
  EXPECT_THAT(shifts_of("(P)(X0)(7-8)"), ElementsAre(3200, 3328));
  EXPECT_THAT(shifts_of("1,(4-5)"), ElementsAre(2, 16, 32));
  EXPECT_THAT(shifts_of("(1)(2),3"), ElementsAre(6, 8));
  EXPECT_THAT(shifts_of(" ( 1 - 2 , 4 ) ( X0 ) , P "), ElementsAre(2050, 2052, 2064, 1024));
}

// An expression as a tree: what it means is read off the tree, and its text is only written.
using Group = std::vector<std::pair<int, int>>;  // ranges of numbers; first == last: one number
using Product = std::vector<Group>;

class RandomExpression {
 public:
  explicit RandomExpression(unsigned seed) : random_(seed) {
    for (int terms = draw(1, 3); terms > 0; --terms) {
      Product product;
      for (int groups = draw(1, 3); groups > 0; --groups) {
        Group group;
        for (int items = draw(1, 3); items > 0; --items) {
          const int first = draw(1, kOperators);
          group.emplace_back(first, draw(0, 1) == 0 ? first : draw(first, kOperators));
        }
        product.push_back(group);
      }
      products_.push_back(product);
    }
  }

  static constexpr int kOperators = 6;

  std::string text() {
    std::string text;
    for (const Product& product : products_) {
      if (!text.empty()) text.append(blank()).append(",").append(blank());
      const bool bare = product.size() == 1 && product[0].size() == 1 && draw(0, 1) == 0;
      for (const Group& group : product) {
        std::string items;
        for (const auto& [first, last] : group) {
          items.append(items.empty() ? "" : ",").append(blank()).append(std::to_string(first));
          if (last != first)
            items.append(blank()).append("-").append(blank()).append(std::to_string(last));
        }
        text.append(bare ? items : blank().append("(").append(items).append(blank()).append(")"));
      }
    }
    return text;
  }

  // Every choice of one operator per group, in the order of application: the last group first.
  std::vector<std::vector<int>> chains_of_operators() const {
    std::vector<std::vector<int>> all;
    for (const Product& product : products_) {
      std::vector<std::vector<int>> chains{{}};
      for (auto group = product.rbegin(); group != product.rend(); ++group) {
        std::vector<std::vector<int>> longer;
        for (const std::vector<int>& chain : chains)
          for (const auto& [first, last] : *group)
            for (int number = first; number <= last; ++number) {
              longer.push_back(chain);
              longer.back().push_back(number);
            }
        chains = longer;
      }
      all.insert(all.end(), chains.begin(), chains.end());
    }
    return all;
  }

 private:
  int draw(int least, int most) {
    return least + static_cast<int>(random_() % static_cast<unsigned>(most - least + 1));
  }
  std::string blank() { return draw(0, 3) == 0 ? " " : ""; }

  std::mt19937 random_;
  std::vector<Product> products_;
};

using Point = std::array<int, 3>;

// Operator n turns by 90 degrees about one of the axes and shifts, so that operators do not commute
// and whole coordinates stay whole.
Point moved(int n, const Point& p) {
  const std::array<Point, 3> turned{
      {{p[0], -p[2], p[1]}, {p[2], p[1], -p[0]}, {-p[1], p[0], p[2]}}};
  const Point& t = turned[static_cast<std::size_t>(n % 3)];
  return {t[0] + n, t[1] + 10 * n, t[2] - 100 * n};
}

std::vector<Operator> turns() {
  std::vector<Operator> result;
  for (int n = 1; n <= RandomExpression::kOperators; ++n) {
    const Point zero = moved(n, {0, 0, 0}), x = moved(n, {1, 0, 0}), y = moved(n, {0, 1, 0}),
                z = moved(n, {0, 0, 1});
    std::string numbers;
    for (std::size_t row = 0; row < 3; ++row)
      for (const int number :
           {x[row] - zero[row], y[row] - zero[row], z[row] - zero[row], zero[row]})
        numbers += std::to_string(number) + " ";
    result.push_back({std::to_string(n), numbers});
  }
  return result;
}

TEST(OperatorExpressions, AgreeWithAnExpansionWrittenApart) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    RandomExpression expression(seed);
    const std::string text = expression.text();
    SCOPED_TRACE(text);
    std::vector<Point> expected, found;
    for (const std::vector<int>& chain : expression.chains_of_operators()) {
      Point p{1, 2, 3};
      for (const int n : chain) p = moved(n, p);
      expected.push_back(p);
    }
    const Molecule molecule = read_text_as(
        "a.cif", kOneAtom + generators({{"1", text, "A"}}) + operator_list(turns()), assembly("1"));
    for (const Atom& atom : molecule.atoms) {
      const Vec3d& p = atom.position;
      found.push_back({static_cast<int>(p.x), static_cast<int>(p.y), static_cast<int>(p.z)});
    }
    std::sort(expected.begin(), expected.end());
    std::sort(found.begin(), found.end());
    EXPECT_TRUE(found == expected) << found.size() << " copies, expected " << expected.size();
  }
}

TEST(OperatorExpressions, WhatCannotBeFollowedIsRefusedWithItsRow) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "name of an operator is missing"},
      {"1,,2", "name of an operator is missing"},
      {"1,", "name of an operator is missing"},
      {"()", "name of an operator is missing"},
      {"(1-2", "a bracket is not closed"},
      {"((1),2)", "name of an operator is missing"},
      {"1)", "')' is one too many"},
      {"(1-2)3", "'3' is one too many"},
      {"1(2-3)", "'(' is one too many"},
      {"4-1", "'4' to '1' is no range"},
      {"1 2", "there is no operator '1 2'"},
      {"1,2,9", "there is no operator '9'"},
      {"(1-2)(X1)", "there is no operator 'X1'"},
      {"7-2000000000", "there is no operator '9'"},
      {"1-99999999999999999999", "is no range"}};
  for (const auto& [expression, what] : cases) {
    SCOPED_TRACE(expression);
    const std::string text = kOneAtom + generators({{"PAU", "1", "A"}, {"1", expression, "A"}}) +
                             operator_list(shifts(8));
    const std::string message = refusal_of_text<FileFormatError>("a.cif", text, assembly("1"));
    EXPECT_THAT(message, HasSubstr("a.cif: row 2 of _pdbx_struct_assembly_gen"));
    EXPECT_THAT(message, HasSubstr(what));
    EXPECT_EQ(read_text_as("a.cif", text).atoms.size(), 1U);  // the asymmetric unit is sound
    EXPECT_EQ(read_text_as("a.cif", text, assembly("PAU")).atoms.size(), 1U);
  }
}

TEST(OperatorExpressions, TooManyCopiesAreRefusedBeforeTheyAreMade) {
  std::vector<Operator> hundred;
  for (int i = 1; i <= 100; ++i) hundred.push_back(shift_by(std::to_string(i), i));
  const auto refusal = [&](const std::string& expression, std::uint64_t limit) {
    ReadOptions options = assembly("1");
    options.memory_limit = limit;
    return refusal_of_text<LimitExceeded>(
        "a.cif", kThreeAtoms + generators({{"1", expression, "A,B,C"}}) + operator_list(hundred),
        options);
  };
  EXPECT_THAT(refusal("(1-100)(1-100)(1-100)", std::uint64_t{100} << 20),
              HasSubstr("assembly 1 has 3000000 atoms"));
  // More copies than 64 bits count, with memory without end; the last is 2⁶⁴ of them.
  std::string product, doublings;
  for (int i = 0; i < 12; ++i) product += "(1-100)";
  for (int i = 0; i < 64; ++i) doublings += "(1,2)";
  EXPECT_THAT(refusal(product, ~std::uint64_t{0}), HasSubstr("atoms are allowed"));
  EXPECT_THAT(refusal(doublings, ~std::uint64_t{0}), HasSubstr("atoms are allowed"));
}

TEST(OperatorExpressions, ARangeMayEndWithTheLargestNumberThereIs) {
  const std::string largest = "9223372036854775807";
  const Molecule molecule =
      read_text_as("a.cif",
                   kOneAtom + generators({{"1", largest + "-" + largest, "A"}}) +
                       operator_list({shift_by(largest, 8)}),
                   assembly("1"));
  EXPECT_EQ(molecule.atoms.at(0).position.x, 9);
}

}  // namespace
}  // namespace vdwmesh::testing
