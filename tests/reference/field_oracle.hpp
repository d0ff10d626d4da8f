// Fields by their equations, summed over every atom, in double.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "reference/point.hpp"

namespace vdwmesh::reference {

enum class Function { blinn, soft_object, inverse_squared };
enum class Preset { radius_aware, thesis, thesis_vdw };

// Where sub-grids and the smallest distance of 1/d^2 are measured: the marching-cubes grid.
struct Lattice {
  Point origin{0, 0, 0};
  double spacing = 0.5;
};

struct FieldOracle {
  Function function = Function::blinn;
  Preset preset = Preset::radius_aware;
  Lattice lattice;
  double blobbiness = 2;  // B of radius-aware Blinn
};

// T where the caller gives none: 1, or the fitted value of docs/thesis.md.
double default_isovalue(const FieldOracle& field);

struct FieldSample {
  double value;
  Point gradient;  // 1/Å
};
// thesis-vdw is defined for inverse squared only.
FieldSample sample_field(const FieldOracle& field, const std::vector<Ball>& balls, const Point& p);

// What one ball adds to it.
double contribution(const FieldOracle& field, const Ball& ball, const Point& p);

struct UnionSample {
  double signed_distance;  // min over the balls of d - r; negative inside. Å
  std::size_t nearest;     // the first ball that attains it
};
UnionSample sample_union(const std::vector<Ball>& balls, const Point& p);

// Distance from `p` along the unit vector `direction` to a place where `inside` turns false, by
// halving [0, reach]; nothing unless p is inside and the far end is not.
using Inside = std::function<bool(const Point&)>;
std::optional<double> bisect(const Inside& inside, const Point& p, const Point& direction,
                             double reach);

}  // namespace vdwmesh::reference
