// Operator expressions of assemblies, as the mmCIF dictionary defines them for
// _pdbx_struct_assembly_gen.oper_expression. Inside the room only.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vdwmesh {

// Which place in the list of operators has an id.
using OperatorPlaces = std::map<std::string, std::uint32_t, std::less<>>;

// One factor: operators, by their places in the list.
using OperatorFactor = std::vector<std::uint32_t>;

// All combinations of one operator from each factor. The operator of the last factor is applied
// first: the dictionary applies factors from right to left.
using OperatorProduct = std::vector<OperatorFactor>;

// The products whose union an expression stands for. With white space allowed between the symbols:
//
//   expression := term { "," term }
//   term       := item | factor { factor }
//   factor     := "(" item { "," item } ")"
//   item       := id | number "-" number
//
// "1,2,5", "1-4", "(X0)(1-10,21-25)", "(1-60)(61-88)", "P", "1,(4-5)". Throws FileFormatError,
// one line that begins with `where`, for anything else and for an operator that is not listed.
std::vector<OperatorProduct> parse_operator_expression(std::string_view expression,
                                                       const OperatorPlaces& places,
                                                       const std::string& where);

// How many combinations there are; the largest number where that overflows.
std::uint64_t combination_count(const std::vector<OperatorProduct>& products);

// Calls `visit` with each combination, one place per factor; the last factor runs fastest.
void for_each_combination(const OperatorProduct& product,
                          const std::function<void(const OperatorFactor&)>& visit);

}  // namespace vdwmesh
