// Biological assemblies: copies of chains, moved by operators, as a file describes them. Inside the
// room only.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "structure/operator_expression.hpp"

namespace vdwmesh {

// The map p -> rows p + shift.
struct AffineMap {
  std::array<Vec3d, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d shift{0, 0, 0};  // Å

  Vec3d operator()(const Vec3d& p) const;
};

// First `b`, then `a`.
AffineMap operator*(const AffineMap& a, const AffineMap& b);

// An operator of the file's list. `where` is its place in the file, for messages.
struct SymmetryOperator {
  std::string id;
  std::string where;
  AffineMap map;
  std::string fault;  // why it cannot be used; empty where it can
};

// A row of the file that says which chains an assembly holds, and moved by which operators.
struct AssemblyRow {
  std::string assembly;
  std::string where;
  std::string expression;  // of operators
  std::vector<std::string> chains;
};

// Everything that a file says of its assemblies. Nothing of it is checked before an assembly is
// asked for, so that a file can be read whose assemblies are broken.
struct AssemblyTables {
  // PDB files name chains by their author's letters, mmCIF files by label_asym_id.
  enum class ChainNames { author, label };
  ChainNames chain_names = ChainNames::author;
  std::vector<AssemblyRow> rows;
  std::vector<SymmetryOperator> operators;
};

// The names of the assemblies, each once, in the order of the file.
std::vector<std::string> assembly_names(const AssemblyTables& tables);

// Copies of the same chains: one for each combination of operators in each of the products.
struct ChainCopies {
  std::set<std::string, std::less<>> chains;
  std::vector<OperatorProduct> products;
};

struct AssemblyRecipe {
  std::vector<ChainCopies> parts;
  std::vector<std::string> warnings;  // operators that do not keep shapes
};

// What assembly `name`, which must be one of assembly_names(), is made of. `path` is for messages.
// Throws FileFormatError, one line that names the row or line, for an expression that cannot be
// followed and for an operator in use that is not listed, listed twice, or no matrix of numbers.
AssemblyRecipe make_recipe(const AssemblyTables& tables, const std::string& name,
                           const std::string& path);

// The one map that a combination of operators stands for, the last applied first; and its name:
// the ids, joined by "-".
AffineMap map_of(const AssemblyTables& tables, const OperatorFactor& combination);
std::string name_of(const AssemblyTables& tables, const OperatorFactor& combination);

}  // namespace vdwmesh
