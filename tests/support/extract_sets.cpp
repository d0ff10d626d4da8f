#include "support/extract_sets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "extract/blended/field_formulas.hpp"
#include "extract/field.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kLeastRadius = 0.1, kMostRadius = 10;   // Å
constexpr double kLeastSpacing = 0.1, kMostSpacing = 2;  // Å
// Nodes of the grid, and nodes within reach of a ball summed over the balls: what time follows.
constexpr double kMostNodes = 1e6, kMostWork = 4e6;
constexpr double kPi = 3.14159265358979323846;

double log_real(Dice& dice, double low, double high) {
  return low * std::pow(high / low, dice.real(0, 1));
}

// Radii that this spacing allows: a single ball must not take all the work.
struct Radii {
  double least, most;
};
Radii radii(Dice& dice, double h) {
  const double most = std::min(kMostRadius, 12 * h);
  const double least = std::max(kLeastRadius, dice.one_in(2) ? 0.8 * h : 0.1);
  return {std::min(least, most), most};
}

using Balls = std::vector<Sphere>;

Vec3d in_box(Dice& dice, const Vec3d& half) {
  Vec3d p{};
  for (int axis = 0; axis < 3; ++axis) p[axis] = dice.real(-half[axis], half[axis]);
  return p;
}

int count(Dice& dice, int most) {
  return std::clamp(static_cast<int>(log_real(dice, 1, most + 1)), 1, most);
}

// A box of about so many nodes: a cube, a plate or a rod.
Vec3d box(Dice& dice, double h, double nodes) {
  Vec3d shape{1, 1, 1};
  for (int axis = 0; axis < 3; ++axis) shape[axis] = dice.one_in(2) ? 1 : log_real(dice, 0.05, 1);
  const double side = h * std::cbrt(nodes / (shape.x * shape.y * shape.z));
  return 0.5 * side * shape;
}

Balls gas(Dice& dice, double h) {
  const Radii r = radii(dice, h);
  const Vec3d half = box(dice, h, log_real(dice, 1e4, 0.5 * kMostNodes));
  Balls balls(static_cast<std::size_t>(count(dice, 400)));
  for (Sphere& s : balls) s = {in_box(dice, half), log_real(dice, r.least, r.most)};
  return balls;
}

Balls crowd(Dice& dice, double h) {
  const Radii r = radii(dice, h);
  const int n = count(dice, 400);
  const double typical = log_real(dice, r.least, r.most);
  const double half = dice.real(0.3, 1.2) * typical * std::cbrt(n);
  Balls balls(static_cast<std::size_t>(n));
  for (Sphere& s : balls) {
    s = {in_box(dice, {half, half, half}),
         std::clamp(typical * dice.real(0.7, 1.4), kLeastRadius, kMostRadius)};
  }
  return balls;
}

// A walk with steps of about a radius, often along one axis alone: long thin grids.
Balls chain(Dice& dice, double h) {
  const Radii r = radii(dice, h);
  const double radius = log_real(dice, r.least, r.most), step = radius * dice.real(0.5, 3);
  const bool straight = dice.one_in(2);
  const int axis = dice.whole(0, 2);
  Balls balls(static_cast<std::size_t>(count(dice, 400)));
  Vec3d at{0, 0, 0};
  for (Sphere& s : balls) {
    s = {at, radius};
    const Vec3d wander = in_box(dice, {step, step, step});
    if (straight) {
      at[axis] += step;
    } else {
      at = at + wander;
    }
  }
  return balls;
}

// Centres on nodes and radii of whole spacings: nodes lie exactly on spheres, balls touch, and many
// are there twice.
Balls lattice(Dice& dice, double h) {
  const int side = dice.whole(1, 7), step = dice.whole(1, 6), radius = dice.whole(1, 4);
  Balls balls;
  for (int i = 0; i < side * side * side; ++i) {
    if (balls.size() == 400 || dice.one_in(5)) continue;
    const int cell[3] = {i % side, i / side % side, i / side / side};
    const double r = h * (dice.one_in(4) ? dice.whole(1, 4) : radius);
    if (r < kLeastRadius) continue;
    balls.push_back({{h * step * cell[0], h * step * cell[1], h * step * cell[2]}, r});
    if (dice.one_in(10)) balls.push_back(balls.back());
  }
  if (balls.empty()) balls.push_back({{0, 0, 0}, std::max(kLeastRadius, h * radius)});
  return balls;
}

// Tiny balls in and about the surface of a huge one.
Balls huge_among_tiny(Dice& dice, double h) {
  const double huge = std::min(kMostRadius, 20 * h);
  Balls balls{{{0, 0, 0}, huge}};
  const int n = count(dice, 300);
  for (int i = 0; i < n; ++i) {
    const Vec3d out = in_box(dice, {1, 1, 1});
    const double away = huge * dice.real(0.9, 1.3) / std::max(norm(out), 1e-3);
    balls.push_back({away * out, std::max(kLeastRadius, log_real(dice, 0.1 * h, 2 * h))});
  }
  return balls;
}

// Two heaps so far apart along one axis that the grid has up to some 10,000 nodes there.
Balls far_pair(Dice& dice, double h) {
  const Radii r = radii(dice, h);
  const int axis = dice.whole(0, 2), n = dice.whole(2, 6);
  const double most = std::min(r.most, 4 * h), apart = h * log_real(dice, 60, 12000);
  Balls balls(static_cast<std::size_t>(n));
  for (Sphere& s : balls) {
    s = {in_box(dice, {2 * h, 2 * h, 2 * h}), log_real(dice, std::min(r.least, most), most)};
    if (dice.one_in(2)) s.center[axis] += apart;
  }
  return balls;
}

// Balls that no node belongs to two of, each with a node inside: the nodes in one are connected
// along grid edges, those of two never, so each makes one shell. Blended fields keep the balls out
// of each other's reach, so that each one's isosurface is its sphere.
Balls apart(Dice& dice, double h, const FieldOptions& field) {
  const GridSpec grid{{0, 0, 0}, h, {1, 1, 1}};
  const FieldModel model = make_field_model(field, grid);
  const Vec3d half = box(dice, h, log_real(dice, 1e4, 0.5 * kMostNodes));
  const int n = count(dice, 100);
  const double least = std::max(kLeastRadius, h), most = std::clamp(8 * h, least, kMostRadius);
  Balls balls;
  for (int i = 0; i < 4 * n && static_cast<int>(balls.size()) < n; ++i) {
    const Sphere s{in_box(dice, half), log_real(dice, least, most)};
    const bool clear = std::ranges::none_of(balls, [&](const Sphere& other) {
      const double reach = field_reach(model, s.radius) + field_reach(model, other.radius);
      return norm(s.center - other.center) < reach + 2 * h;
    });
    if (clear) balls.push_back(s);
  }
  return balls;
}

FieldOptions field_options(Dice& dice, std::uint32_t index, bool plain) {
  FieldOptions field;
  field.kind = static_cast<FieldKind>(index % 4);
  if (field.kind == FieldKind::vdw || plain) return field;
  if (dice.one_in(6)) {
    field.preset = field.kind == FieldKind::inverse_squared && dice.one_in(2)
                       ? FieldPreset::thesis_vdw
                       : FieldPreset::thesis;
  } else if (field.kind == FieldKind::blinn && dice.one_in(2)) {
    field.blobbiness = dice.one_in(5) ? dice.real(8, 50) : dice.real(0.3, 8);
  }
  // A field is refused whose isovalue float32 does not hold beside its peak, of Blinn e^blobbiness.
  const double least = 1e-24 * std::exp(field.blobbiness.value_or(0));
  if (dice.one_in(3))
    field.isovalue = dice.one_in(4) ? log_real(dice, std::min(least, 1.0), 1) : dice.real(0.2, 3);
  return field;
}

void vary_grid(Dice& dice, GridOptions& grid) {
  if (dice.one_in(6)) grid.padding = 0;
  if (dice.one_in(6)) grid.padding = grid.spacing * dice.whole(1, 4);
  if (dice.one_in(6)) grid.box = GridBox::centers;
  if (dice.one_in(6)) grid.rounding = GridRounding::floor;
}

double work(const FieldModel& model, const Sphere& s) {
  const double across = 2 * (field_reach(model, s.radius) / model.grid.spacing + 1);
  return across * across * across;
}

// Leaves the last balls out until what remains is quick enough; there is always one.
void limit(Balls& balls, const ExtractOptions& options) {
  const double h = options.grid.spacing;
  const FieldModel model = make_field_model(options.field, {{0, 0, 0}, h, {1, 1, 1}});
  double sum = 0;
  std::size_t keep = 0;
  while (keep < balls.size() && (keep == 0 || sum + work(model, balls[keep]) <= kMostWork))
    sum += work(model, balls[keep++]);
  balls.resize(keep);
  while (balls.size() > 1 &&
         static_cast<double>(make_grid(SphereSet(balls), options.grid).node_count()) > kMostNodes)
    balls.pop_back();
}

}  // namespace

ExtractSet extract_set(std::uint32_t seed, std::uint32_t index) {
  Dice dice(seed + 0x9e3779b9u * (index + 1));
  constexpr std::array kNames = {"gas", "crowd", "chain", "lattice", "huge", "far pair", "apart"};
  const auto kind = static_cast<std::size_t>(dice.whole(0, static_cast<int>(kNames.size()) - 1));
  const double h = log_real(dice, kLeastSpacing, kMostSpacing);
  ExtractSet set;
  set.name = kNames[kind];
  set.options.grid.spacing = h;
  set.options.connectivity = Connectivity::half_edges;
  const bool is_apart = kind + 1 == kNames.size();
  set.options.field = field_options(dice, index, is_apart);
  Balls balls = kind == 0   ? gas(dice, h)
                : kind == 1 ? crowd(dice, h)
                : kind == 2 ? chain(dice, h)
                : kind == 3 ? lattice(dice, h)
                : kind == 4 ? huge_among_tiny(dice, h)
                : kind == 5 ? far_pair(dice, h)
                            : apart(dice, h, set.options.field);
  if (!is_apart) vary_grid(dice, set.options.grid);
  limit(balls, set.options);
  if (is_apart) set.separated = balls.size();
  set.spheres = SphereSet(std::move(balls));
  return set;
}

}  // namespace vdwmesh::testing
