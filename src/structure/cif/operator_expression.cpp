// A recursive descent parser: term(), factor() and item() are the rules of the grammar in the
// header. Each removes what it recognises from the front of rest_. gemmi has a parser of its own,
// which is not used: it follows only the first factor of a product and ignores operators that are
// not listed.
#include "structure/cif/operator_expression.hpp"

#include <fmt/format.h>

#include <limits>

#include "core/errors.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

// A text can repeat a range ("(1-60,1-60,...)") and so grow a factor without bound; this limit
// bounds the memory. A factor for the shell of a virus has some 60 operators.
constexpr std::size_t kMostOperatorsInAFactor = std::size_t{1} << 20;

bool is_number(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

class Parser {
 public:
  Parser(std::string_view text, const OperatorIndices& indices, const std::string& where)
      : text_(text), rest_(trimmed(text)), indices_(indices), where_(where) {}

  std::vector<OperatorProduct> run() {
    std::vector<OperatorProduct> products;
    do products.push_back(term());
    while (take(','));
    // A term ends before anything that cannot continue it, such as a closing bracket too many.
    if (!rest_.empty()) refuse(fmt::format("{} is one too many", in_quotes(rest_.substr(0, 1))));
    return products;
  }

 private:
  // A term is a sequence of factors in brackets, or one item without brackets, which becomes a
  // product with one factor.
  OperatorProduct term() {
    OperatorProduct product;
    while (take('(')) product.push_back(factor());
    if (product.empty()) item(product.emplace_back());
    return product;
  }

  // The opening bracket is already taken.
  OperatorFactor factor() {
    OperatorFactor factor;
    do item(factor);
    while (take(','));
    if (!take(')')) refuse("a bracket is not closed");
    return factor;
  }

  // Appends one operator, or a range of operators, to the factor.
  void item(OperatorFactor& factor) {
    const std::string_view word = trimmed(rest_.substr(0, rest_.find_first_of("(),")));
    if (word.empty()) refuse("the name of an operator is missing");
    rest_ = trimmed(rest_.substr(word.size()));
    const std::size_t minus = word.find('-');
    if (minus == std::string_view::npos) return add(word, factor);
    const std::string_view first = trimmed(word.substr(0, minus));
    const std::string_view last = trimmed(word.substr(minus + 1));
    if (is_number(first) && is_number(last)) return range(first, last, factor);
    add(word, factor);  // an id that contains a minus sign
  }

  // add() throws at the first number that is not listed. A range such as 1-999999999999 therefore
  // ends soon, even though nothing bounds its last number.
  void range(std::string_view first, std::string_view last, OperatorFactor& factor) {
    const auto begin = whole_number(first), end = whole_number(last);
    if (!begin || !end || *begin > *end)
      refuse(fmt::format("{} to {} is no range of numbers", in_quotes(first), in_quotes(last)));
    // The end is tested before the increment: the last number may be the largest std::int64_t.
    for (std::int64_t number = *begin;; ++number) {
      add(std::to_string(number), factor);
      if (number == *end) return;
    }
  }

  // Appends the operator with this id.
  void add(std::string_view id, OperatorFactor& factor) {
    const auto found = indices_.find(id);
    if (found == indices_.end())
      refuse(fmt::format("there is no operator {} in the file", in_quotes(id)));
    if (factor.size() == kMostOperatorsInAFactor)
      throw LimitExceeded(fmt::format("{}: the operator expression {} has more than {} operators",
                                      where_, in_quotes(text_), kMostOperatorsInAFactor));
    factor.push_back(found->second);
  }

  // Removes the symbol, and the white space behind it, if it comes next.
  bool take(char symbol) {
    if (!rest_.starts_with(symbol)) return false;
    rest_ = trimmed(rest_.substr(1));
    return true;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw FileFormatError(fmt::format("{}: the operator expression {} cannot be followed: {}",
                                      where_, in_quotes(text_), what));
  }

  std::string_view text_, rest_;  // the whole expression; the part that is not parsed yet
  const OperatorIndices& indices_;
  const std::string& where_;
};

// Counts saturate at this value. It is far beyond any limit on atoms, so saturation is harmless.
constexpr std::uint64_t kUncountable = std::numeric_limits<std::uint64_t>::max();

// No factor is empty: factor() and term() in Parser put at least one operator into each.
std::uint64_t combination_count(const OperatorProduct& product) {
  std::uint64_t count = 1;
  for (const OperatorFactor& factor : product) {
    if (count > kUncountable / factor.size()) return kUncountable;
    count *= factor.size();
  }
  return count;
}

}  // namespace

std::vector<OperatorProduct> parse_operator_expression(std::string_view expression,
                                                       const OperatorIndices& indices,
                                                       const std::string& where) {
  return Parser(expression, indices, where).run();
}

std::uint64_t combination_count(const std::vector<OperatorProduct>& products) {
  std::uint64_t sum = 0;
  for (const OperatorProduct& product : products) {
    const std::uint64_t count = combination_count(product);
    sum = count > kUncountable - sum ? kUncountable : sum + count;
  }
  return sum;
}

// Counts like an odometer with one wheel per factor: wheels[f] is the index within factor f. When a
// wheel passes its end, it returns to 0 and the wheel on its left moves on. The loop ends when the
// first wheel has passed its end.
void for_each_combination(const OperatorProduct& product,
                          const std::function<void(const OperatorCombination&)>& visit) {
  std::vector<std::size_t> wheels(product.size(), 0);
  OperatorCombination indices(product.size());
  for (;;) {
    for (std::size_t f = 0; f < product.size(); ++f) indices[f] = product[f][wheels[f]];
    visit(indices);
    // The condition moves wheel - 1 on, beginning with the last one. If that wheel has passed its
    // end, the body sets it to 0 and goes on to its left.
    std::size_t wheel = product.size();
    while (wheel > 0 && ++wheels[wheel - 1] == product[wheel - 1].size()) wheels[--wheel] = 0;
    if (wheel == 0) return;
  }
}

}  // namespace vdwmesh
