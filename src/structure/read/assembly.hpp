// Biological assemblies: which chains of a file are copied, and which symmetry operators move the
// copies. biomolecules.cpp (PDB) and mmcif_assembly.cpp fill the AssemblyTables; choose.cpp lists
// the copies after a recipe, and expanded() makes them.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "structure/cif/operator_expression.hpp"

namespace vdwmesh {

// The affine map p -> R p + shift, with the rows of the matrix R.
struct AffineMap {
  std::array<Vec3d, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3d shift{0, 0, 0};  // Å

  Vec3d operator()(const Vec3d& p) const;
};

// The composition p -> a(b(p)): `b` is applied first.
AffineMap operator*(const AffineMap& a, const AffineMap& b);

// An operator in the list of the file.
struct SymmetryOperator {
  std::string id;     // as operator expressions name it
  std::string where;  // its line or row in the file, for messages
  AffineMap map;
  std::string fault;  // why the operator cannot be used; empty if it can
};

// One statement of the file: an assembly holds these chains, moved by these operators. An assembly
// may have several rows.
struct AssemblyRow {
  std::string assembly;    // the name of the assembly
  std::string where;       // the line or row in the file, for messages
  std::string expression;  // of operator ids; operator_expression.hpp has the grammar
  std::vector<std::string> chains;
};

// Everything that a file says of its assemblies. make_recipe() checks it, and only when an assembly
// is asked for: a file with broken assemblies can still be read as its asymmetric unit.
struct AssemblyTables {
  // How rows name the chains: PDB files by the author's chain id, mmCIF files by label_asym_id,
  // which gemmi keeps in Residue::subchain.
  enum class ChainNames { author, label };
  ChainNames chain_names = ChainNames::author;
  std::vector<AssemblyRow> rows;
  std::vector<SymmetryOperator> operators;
};

// The names of all assemblies in the order of the file, each once.
std::vector<std::string> assembly_names(const AssemblyTables& tables);

// A set of chains and the operators that copy it. Each combination of operators in each product
// makes one copy.
struct ChainCopies {
  std::set<std::string, std::less<>> chains;
  std::vector<OperatorProduct> products;
};

// How to make an assembly: one part for each of its rows.
struct AssemblyRecipe {
  std::vector<ChainCopies> parts;
  std::vector<std::string> warnings;  // operators that deform or mirror the copies
};

// Makes the recipe of the assembly `name`, which must be one of assembly_names(). `path` serves the
// messages. Throws FileFormatError, with the row or line in the message, if an operator expression
// does not follow the grammar, if a row names no chains, or if an operator that the assembly uses
// is not listed, is listed twice, or is not a matrix of numbers.
AssemblyRecipe make_recipe(const AssemblyTables& tables, const std::string& name,
                           const std::string& path);

// The composed map of a combination, which has at least one operator; the last operator is applied
// first. The name of a combination is its operator ids joined by "-".
AffineMap map_of(const AssemblyTables& tables, const OperatorCombination& combination);
std::string name_of(const AssemblyTables& tables, const OperatorCombination& combination);

}  // namespace vdwmesh
