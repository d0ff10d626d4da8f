// Random sets on and off the lattice, tangent, nested and cut by the border, with random options:
// every one makes a sound mesh, and where no node is undecided that of dense marching cubes.
#include <algorithm>
#include <cmath>

#include "contract/extractor_contract.hpp"
#include "reference/dense_mc.hpp"
#include "support/dice.hpp"

namespace vdwmesh::testing {
namespace {

class ExtractorRandom : public ExtractorContract {};

constexpr unsigned kCases = 600;

// free: anywhere. on_nodes: centres and radii whole multiples of the spacing. tangent: some spheres
// touch another, from outside or inside, along an axis.
enum class Placement { free, on_nodes, tangent };

Sphere random_sphere(Dice& dice, Placement placement, double half, double h) {
  Vec3d c{dice.real(-half, half), dice.real(-half, half), dice.real(-half, half)};
  if (placement == Placement::free) return {c, dice.real(0.3, 2.2)};
  for (int a = 0; a < 3; ++a) c[a] = h * std::round(c[a] / h);
  return {c, placement == Placement::on_nodes ? h * dice.whole(1, 6) : 0.5 * dice.whole(1, 4)};
}

SphereSet random_set(Dice& dice, double h) {
  const auto placement = static_cast<Placement>(dice.whole(0, 2));
  const int count = dice.whole(1, dice.one_in(4) ? 40 : 8);
  const double half = std::cbrt(static_cast<double>(count)) * (dice.one_in(4) ? 3 : 1);
  std::vector<Sphere> spheres;
  for (int i = 0; i < count; ++i) {
    Sphere s = random_sphere(dice, placement, half, h);
    if (placement == Placement::tangent && i > 0 && dice.one_in(2)) {
      const Sphere& other = spheres[static_cast<std::size_t>(dice.whole(0, i - 1))];
      s.center = other.center;
      const double sum = other.radius + s.radius, difference = other.radius - s.radius;
      s.center[dice.whole(0, 2)] += dice.one_in(2) ? sum : difference;
    }
    spheres.push_back(s);
  }
  return SphereSet(std::move(spheres));
}

ExtractOptions random_options(Dice& dice, double h) {
  ExtractOptions options;
  options.grid.spacing = h;
  options.field.kind = static_cast<FieldKind>(dice.whole(0, 3));
  if (dice.one_in(4)) options.grid.padding = 0;
  if (dice.one_in(4)) options.grid.padding = h * dice.whole(1, 4);
  if (dice.one_in(4)) options.grid.box = GridBox::centers;
  if (dice.one_in(4)) options.grid.rounding = GridRounding::floor;
  if (options.field.kind == FieldKind::vdw) return options;
  if (dice.one_in(4)) options.field.preset = FieldPreset::thesis;
  if (options.field.kind == FieldKind::inverse_squared && dice.one_in(3)) {
    options.field.preset = FieldPreset::thesis_vdw;
  }
  if (dice.one_in(5)) options.field.isovalue = dice.real(0.2, 3);
  return options;
}

// Nodes so near the surface that the last bits of the node's value decide; see
// extractor_reference_test.cpp. Thesis fields are sums over more atoms and larger by T.
double sign_margin(const ExtractOptions& options, double isovalue) {
  return options.field.kind == FieldKind::vdw ? 1e-11 : 3e-5 * std::max(isovalue, 1.0);
}

// Compares the counts with dense marching cubes; false where a node is undecided.
bool matches_dense(const SphereSet& spheres, const ExtractOptions& options,
                   const ExtractResult& result, const std::string& what) {
  const auto balls = to_balls(spheres);
  const auto field = to_oracle(options.field, result.grid);
  const double isovalue = options.field.isovalue.value_or(reference::default_isovalue(field));
  const reference::DenseGrid grid{to_point(result.grid.origin),
                                  result.grid.spacing,
                                  {result.grid.cells.x, result.grid.cells.y, result.grid.cells.z}};
  bool decided = true;
  const auto inside = [&](const reference::Node& node) {
    const reference::Point p = grid.position(node);
    const double depth = options.field.kind == FieldKind::vdw
                             ? -reference::sample_union(balls, p).signed_distance
                             : reference::sample_field(field, balls, p).value - isovalue;
    if (!(std::abs(depth) >= sign_margin(options, isovalue))) decided = false;
    return depth >= 0;
  };
  const auto middle = [](const reference::Point& a, const reference::Point& b) {
    return 0.5 * (a + b);
  };
  const auto dense = reference::dense_marching_cubes(grid, inside, middle);
  if (!decided) return false;
  EXPECT_EQ(result.mesh.vertex_count(), dense.mesh.points.size()) << what;
  EXPECT_EQ(result.mesh.triangle_count(), dense.mesh.triangles.size()) << what;
  return true;
}

TEST_P(ExtractorRandom, SetsMakeSoundMeshes) {
  constexpr double kSpacings[] = {0.25, 0.3, 0.4, 0.5, 0.7, 1.0};
  unsigned compared = 0, not_empty = 0;
  for (unsigned seed = 1; seed <= kCases; ++seed) {
    Dice dice(seed);
    const double h = kSpacings[dice.whole(0, 5)];
    const SphereSet spheres = random_set(dice, h);
    const ExtractOptions options = random_options(dice, h);
    const ExtractResult result = extract(spheres, options);
    const std::string what = "case " + std::to_string(seed);
    if (result.grid.node_count() < 20000) compared += matches_dense(spheres, options, result, what);
    if (result.mesh.triangle_count() == 0) continue;  // nothing reaches a node
    ++not_empty;
    expect_sound(result, what);
    if (HasFailure()) return;
  }
  EXPECT_GT(not_empty, kCases * 9 / 10);
  EXPECT_GT(compared, kCases / 4);
}

VDWMESH_INSTANTIATE_BACKENDS(ExtractorRandom);

}  // namespace
}  // namespace vdwmesh::testing
