// Turns the assembly tables of a file into a recipe. RecipeMaker parses the operator expression of
// every row of the assembly, collects the operators that occur, and then checks these operators
// only. Operators should be rotations with a shift. Others are used as they stand, with a warning.
#include "structure/read/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "core/errors.hpp"
#include "structure/read/lines.hpp"

namespace vdwmesh {
namespace {

// How far a scalar product of two matrix rows may be from 0 or 1 in a rotation. Files give the
// entries to four or more decimals, so each is off by at most e = 5e-5, and each row by a vector of
// length at most sqrt(3) e. Rows have length 1, so their scalar product is off by at most 2 sqrt(3)
// e = 1.8e-4 up to terms of e^2. The tolerance is five times that, so entries that were cut off
// instead of rounded (e = 1e-4) pass too.
constexpr double kRotationTolerance = 1e-3;
constexpr std::size_t kMostOperatorsNamed = 3;  // operators that one warning lists

Vec3d column(const AffineMap& map, int axis) {
  return {map.rows[0][axis], map.rows[1][axis], map.rows[2][axis]};
}

// Says why the map is not a rotation with a shift; empty if it is one. A rotation keeps lengths and
// angles (its rows are orthonormal) and chirality (the determinant of its rows is positive).
std::string why_no_rotation(const AffineMap& map) {
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = i; j < 3; ++j) {
      const double expected = i == j ? 1 : 0;
      // Written so that NaN counts as a deviation.
      if (!(std::abs(dot(map.rows[i], map.rows[j]) - expected) <= kRotationTolerance))
        return "changes lengths or angles";
    }
  const bool mirrors = dot(cross(map.rows[0], map.rows[1]), map.rows[2]) < 0;
  return mirrors ? "makes mirror images" : "";
}

// Makes one recipe: construct, then call run() once.
class RecipeMaker {
 public:
  RecipeMaker(const AssemblyTables& tables, const std::string& name, const std::string& path)
      : tables_(tables), name_(name), path_(path) {
    for (std::size_t place = 0; place < tables.operators.size(); ++place) {
      const SymmetryOperator& listed = tables.operators[place];
      if (!indices_.emplace(listed.id, static_cast<std::uint32_t>(place)).second)
        repeated_.insert(listed.id);
    }
  }

  AssemblyRecipe run() {
    for (const AssemblyRow& row : tables_.rows)
      if (row.assembly == name_) add(row);
    for (const std::uint32_t place : used_) check(tables_.operators[place]);
    warn_of_deformations();
    return std::move(recipe_);
  }

 private:
  // Adds the part of the recipe that one row of the file describes, and notes its operators in
  // used_.
  void add(const AssemblyRow& row) {
    const std::string where = fmt::format("{}: {}", path_, row.where);
    ChainCopies& part = recipe_.parts.emplace_back();
    part.chains.insert(row.chains.begin(), row.chains.end());
    if (part.chains.empty())
      throw FileFormatError(fmt::format("{}: names no chains of assembly {}", where, name_));
    part.products = parse_operator_expression(row.expression, indices_, where);
    for (const OperatorProduct& product : part.products)
      for (const OperatorFactor& factor : product) used_.insert(factor.begin(), factor.end());
  }

  // Refuses an operator that is ambiguous or has a fault, and notes one that is not a rotation.
  void check(const SymmetryOperator& used) {
    const std::string where = fmt::format("{}: {}", path_, used.where);
    if (repeated_.count(used.id) != 0)
      throw FileFormatError(
          fmt::format("{}: operator {} is listed more than once", where, in_quotes(used.id)));
    if (!used.fault.empty()) throw FileFormatError(fmt::format("{}: {}", where, used.fault));
    const std::string why = why_no_rotation(used.map);
    if (!why.empty())
      deformations_.push_back(fmt::format("operator {} ({}) {}", used.id, used.where, why));
  }

  void warn_of_deformations() {
    if (deformations_.empty()) return;
    std::string text;
    for (std::size_t i = 0; i < std::min(deformations_.size(), kMostOperatorsNamed); ++i)
      text += (i == 0 ? "" : ", ") + deformations_[i];
    if (deformations_.size() > kMostOperatorsNamed)
      text += fmt::format(" and {} more", deformations_.size() - kMostOperatorsNamed);
    recipe_.warnings.push_back(fmt::format(
        "assembly {}: not all of its operators are rotations, so some copies are deformed: {}",
        name_, text));
  }

  const AssemblyTables& tables_;
  const std::string& name_;
  const std::string& path_;
  OperatorIndices indices_;  // operator id -> index in tables_.operators, the first if repeated
  std::set<std::string> repeated_;  // ids that are listed more than once
  std::set<std::uint32_t> used_;    // the assembly's operators: indices into tables_.operators
  std::vector<std::string> deformations_;  // one text per operator that is not a rotation
  AssemblyRecipe recipe_;
};

}  // namespace

// Plain products and sums instead of dot(), whose fma rounds differently. The coordinates of copies
// are meant to stay the same, bit for bit, from version to version.
Vec3d AffineMap::operator()(const Vec3d& p) const {
  const auto row = [&p](const Vec3d& r, double s) { return r.x * p.x + r.y * p.y + r.z * p.z + s; };
  return {row(rows[0], shift.x), row(rows[1], shift.y), row(rows[2], shift.z)};
}

AffineMap operator*(const AffineMap& a, const AffineMap& b) {
  AffineMap product;
  for (std::size_t i = 0; i < 3; ++i)
    product.rows[i] = {dot(a.rows[i], column(b, 0)), dot(a.rows[i], column(b, 1)),
                       dot(a.rows[i], column(b, 2))};
  product.shift = a(b.shift);
  return product;
}

std::vector<std::string> assembly_names(const AssemblyTables& tables) {
  std::vector<std::string> names;
  std::set<std::string_view> seen;
  for (const AssemblyRow& row : tables.rows)
    if (seen.insert(row.assembly).second) names.push_back(row.assembly);
  return names;
}

AssemblyRecipe make_recipe(const AssemblyTables& tables, const std::string& name,
                           const std::string& path) {
  return RecipeMaker(tables, name, path).run();
}

// The last operator is applied first, so the product grows to the left, from the last but one on.
AffineMap map_of(const AssemblyTables& tables, const OperatorCombination& combination) {
  AffineMap map = tables.operators[combination.back()].map;
  for (std::size_t i = combination.size() - 1; i-- > 0;)
    map = tables.operators[combination[i]].map * map;
  return map;
}

std::string name_of(const AssemblyTables& tables, const OperatorCombination& combination) {
  std::string name;
  for (const std::uint32_t place : combination)
    name += (name.empty() ? "" : "-") + tables.operators[place].id;
  return name;
}

}  // namespace vdwmesh
