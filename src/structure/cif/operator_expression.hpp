// Operator expressions say which symmetry operators make the copies of an assembly. The mmCIF
// dictionary defines them for _pdbx_struct_assembly_gen.oper_expression. Internal header of this
// folder.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh {

// Maps the id of an operator to its index in AssemblyTables::operators.
using OperatorIndices = std::map<std::string, std::uint32_t, std::less<>>;

// Operators, by their indices in AssemblyTables::operators: those of one factor of a product, and
// those of one combination, which has one operator from each factor.
using OperatorFactor = std::vector<std::uint32_t>;
using OperatorCombination = std::vector<std::uint32_t>;

// A Cartesian product: it stands for all combinations of one operator from each factor. The
// dictionary applies the factors from right to left, so the operator from the last factor acts
// first.
using OperatorProduct = std::vector<OperatorFactor>;

// Parses an expression. It stands for the union of the products that are returned, one for each
// term. The grammar, with white space allowed between the symbols:
//
//   expression := term { "," term }
//   term       := item | factor { factor }
//   factor     := "(" item { "," item } ")"
//   item       := id | number "-" number
//
// Examples: "1,2,5", "1-4", "(X0)(1-10,21-25)", "(1-60)(61-88)", "P", "1,(4-5)". Throws
// FileFormatError if the text does not follow the grammar or an operator is not in `indices`, and
// LimitExceeded if a factor has more than 2^20 operators. `where` begins these messages; it says
// where in which file the expression stands.
std::vector<OperatorProduct> parse_operator_expression(std::string_view expression,
                                                       const OperatorIndices& indices,
                                                       const std::string& where);

// The number of combinations in all products, 2^64 - 1 if there are more than that.
std::uint64_t combination_count(const std::vector<OperatorProduct>& products);

// Calls `visit` with each combination of the product. The operator of the last factor changes
// fastest.
void for_each_combination(const OperatorProduct& product,
                          const std::function<void(const OperatorCombination&)>& visit);

}  // namespace vdwmesh
