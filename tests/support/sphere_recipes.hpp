// Seeded sets of balls of many kinds, general and nearly degenerate, the same on every machine.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "spheres/sphere_set.hpp"

namespace vdwmesh::testing {

// Whether balls of the kind touch, meet in common points or circles, or all but do so.
enum class Position { general, nearly_degenerate };

struct SphereRecipe {
  std::string_view name;
  Position position;
};
const std::vector<SphereRecipe>& sphere_recipes();

struct SeededSet {
  std::size_t recipe;  // of sphere_recipes()
  SphereSet spheres;   // 1 to 60 balls
  double edge_length;  // Å, for a mesh of a few thousand triangles
};
// The recipes take turns: seed modulo their number.
SeededSet seeded_set(unsigned seed);

}  // namespace vdwmesh::testing
