// Pockets against a table that another program computed with CGAL's exact predicates, sums in long
// double and volumes by plane slices (../shared/reference/pockets.csv).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "measures/exact_union.hpp"
#include "pockets/pockets.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

constexpr double kProbe = 1.4;  // Å

// The table has 12 digits, and the largest figure is 4296 Å³; its volumes by slices agree with
// closed forms to 1e-11.
constexpr double kTableError = 1e-9;
constexpr double kSamePlace = 1e-8;  // Å: places have nine decimals

using Row = std::map<std::string, std::string>;

std::vector<Row> rows_of(const std::string& set) {
  std::ifstream file(shared_path("reference/pockets.csv"));
  std::vector<std::string> names;
  std::vector<Row> rows;
  for (std::string line; std::getline(file, line);) {
    std::vector<std::string> fields;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
    if (names.empty()) {
      names = fields;
    } else if (fields.at(0) == set) {
      Row& row = rows.emplace_back();
      for (std::size_t i = 0; i < fields.size(); ++i) row[names.at(i)] = fields[i];
    }
  }
  return rows;
}

double number(const Row& row, const std::string& name) { return std::stod(row.at(name)); }

// Not EXPECT_NEAR, whose bound would be the same for 0.002 and 4296.
void expect_close(double found, const Row& row, const std::string& name) {
  const double expected = number(row, name);
  EXPECT_LE(std::abs(found - expected), kTableError * std::max(1.0, std::abs(expected)))
      << name << ": " << found << " for " << row.at("set") << " #" << row.at("rank");
}

double sum_of(const Pocket& pocket, double Mouth::*member) {
  double sum = 0;
  for (const Mouth& m : pocket.mouths) sum += m.*member;
  return sum;
}

void compare(const Pocket& pocket, const Row& row) {
  EXPECT_EQ(pocket.kind == PocketKind::enclosed, row.at("kind") == "void");
  EXPECT_EQ(pocket.mouths.size(), number(row, "mouths"));
  EXPECT_EQ(pocket.spheres, number(row, "atoms"));
  EXPECT_EQ(pocket.tetrahedra, number(row, "tetrahedra"));
  EXPECT_EQ(pocket.sinks, number(row, "sinks"));
  EXPECT_EQ(pocket.poked_faces, number(row, "poked_faces"));
  std::uint64_t faces = 0;
  for (const Mouth& m : pocket.mouths) faces += m.faces;
  EXPECT_EQ(faces, number(row, "mouth_faces"));
  expect_close(pocket.depth_alpha, row, "depth_alpha");
  expect_close(pocket.bottleneck_alpha, row, "bottleneck_alpha");
  expect_close(*pocket.clearance, row, "depth_radius");
  expect_close(*pocket.clearance + kProbe, row, "depth_probe");
  expect_close(*pocket.bottleneck_clearance + kProbe, row, "bottleneck_radius");
  const Vec3d place{number(row, "depth_x"), number(row, "depth_y"), number(row, "depth_z")};
  EXPECT_LE(norm(pocket.clear_place - place), kSamePlace);
  expect_close(pocket.volume_sum, row, "volume_sum");
  expect_close(pocket.area_sum, row, "area_sum");
  expect_close(sum_of(pocket, &Mouth::area_sum), row, "mouth_area_sum");
  expect_close(sum_of(pocket, &Mouth::rim_sum), row, "mouth_rim_sum");
  expect_close(pocket.volume, row, "volume");
  expect_close(pocket.area, row, "area");
  expect_close(sum_of(pocket, &Mouth::area), row, "mouth_area");
  expect_close(sum_of(pocket, &Mouth::rim), row, "mouth_rim");
}

class PocketReference : public ::testing::TestWithParam<const char*> {};

TEST_P(PocketReference, AllRowsAreFound) {
  VDWMESH_NEEDS_SHARED("reference/pockets.csv");
  const std::string set = GetParam();
  const SphereSet spheres = read_xyzr(shared_path("reference/" + set + ".xyzr"), kProbe);
  const PocketTable table = pockets(spheres);
  EXPECT_EQ(table.face_ties, 0u);
  const std::vector<Row> rows = rows_of(set);
  ASSERT_FALSE(rows.empty());
  ASSERT_EQ(table.pockets.size(), rows.size());
  std::vector<bool> taken(rows.size(), false);
  for (const Row& row : rows) {
    // No two pockets of a set have sinks of one size.
    const auto distance = [&](std::size_t i) {
      return std::abs(table.pockets[i].depth_alpha - number(row, "depth_alpha"));
    };
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < table.pockets.size(); ++i) {
      if (distance(i) < distance(nearest)) nearest = i;
    }
    EXPECT_FALSE(taken[nearest]);
    taken[nearest] = true;
    compare(table.pockets[nearest], row);
  }
}

// What another part of the library says of voids, from the arcs' inclusion–exclusion.
TEST_P(PocketReference, VoidsAreThoseOfTheUnion) {
  VDWMESH_NEEDS_SHARED("reference/pockets.csv");
  const SphereSet spheres =
      read_xyzr(shared_path("reference/" + std::string(GetParam()) + ".xyzr"), kProbe);
  std::vector<Pocket> voids = pockets(spheres).pockets;
  std::erase_if(voids, [](const Pocket& p) { return p.kind != PocketKind::enclosed; });
  const UnionTopology topology = *exact_union(spheres).topology;
  ASSERT_EQ(voids.size(), topology.void_table.size());
  for (std::size_t i = 0; i < voids.size(); ++i) {
    const Void& expected = topology.void_table[i];
    EXPECT_NEAR(voids[i].volume, expected.volume, kTableError);
    EXPECT_NEAR(voids[i].area, expected.area, kTableError);
    EXPECT_LE(norm(voids[i].depth_center - expected.center), kTableError);
    double lining = 0;
    std::vector<SphereId> ids;
    for (const LiningSphere& s : voids[i].lining) {
      lining += s.area;
      ids.push_back(s.id);
    }
    EXPECT_NEAR(lining, expected.area, kTableError);
    EXPECT_EQ(ids, expected.lining);
  }
}

INSTANTIATE_TEST_SUITE_P(Sets, PocketReference,
                         ::testing::Values("1UBQ", "4PTI", "1CRN", "4HHB", "1EJG", "133D"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace vdwmesh::testing
