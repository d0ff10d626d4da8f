// The published reference sets: rows of union_of_balls.csv and the balls beside it.
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "support/shared_files.hpp"
#include "union_cases.hpp"

namespace vdwmesh::testing {

struct ReferenceRow {
  std::string set;
  double probe, area, volume, outer_area;
  std::uint64_t balls, components, tunnels, voids, shells;
  std::int64_t euler_characteristic;
};

inline std::vector<ReferenceRow> reference_rows() {
  std::ifstream file(shared_path("reference/union_of_balls.csv"));
  std::string line, cell;
  std::vector<ReferenceRow> rows;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream stream(line);
    std::vector<std::string> f;
    while (std::getline(stream, cell, ',')) f.push_back(cell);
    rows.push_back({f.at(0), std::stod(f.at(2)), std::stod(f.at(3)), std::stod(f.at(4)),
                    std::stod(f.at(5)), std::stoull(f.at(1)), std::stoull(f.at(6)),
                    std::stoull(f.at(7)), std::stoull(f.at(8)), std::stoull(f.at(9)),
                    std::stoll(f.at(10))});
  }
  return rows;
}

inline std::vector<Sphere> reference_balls(const std::string& set, double probe) {
  const std::string plain = shared_path("reference/" + set + ".xyzr").string();
  const bool packed = !std::filesystem::exists(plain);
  gzFile file = gzopen((packed ? plain + ".gz" : plain).c_str(), "rb");
  std::vector<Sphere> balls;
  char line[256];
  while (file && gzgets(file, line, sizeof line)) {
    Sphere s{};
    std::istringstream(line) >> s.center.x >> s.center.y >> s.center.z >> s.radius;
    s.radius += probe;
    balls.push_back(s);
  }
  gzclose(file);
  return balls;
}

// The rows of the sets that are wanted. A table that is empty or cut short, or a number in it that
// is not finite, fails.
template <class Wanted>
std::vector<ReferenceRow> wanted_rows(std::size_t expected, Wanted wanted) {
  std::vector<ReferenceRow> rows;
  for (const ReferenceRow& row : reference_rows()) {
    if (wanted(row.set)) rows.push_back(row);
  }
  EXPECT_EQ(rows.size(), expected);
  for (const ReferenceRow& row : rows) {
    EXPECT_TRUE(std::isfinite(row.area) && std::isfinite(row.volume)) << row.set;
    EXPECT_GT(row.area, 0) << row.set;
    EXPECT_GT(row.volume, 0) << row.set;
  }
  return rows;
}

// Relative: twelve digits are published; issue 3 asks for 1e-10.
inline constexpr double kPublished = 1e-10;
// Relative: of the second formula set, and of the sum over the spheres.
inline constexpr double kSecondFormula = 1e-12;

// The table has twelve digits, so that the true value is within half a unit of the last of them.
inline bool meets_table(const Enclosure& interval, double published) {
  const double half_unit = 0.5 * std::pow(10, std::floor(std::log10(published)) - 11);
  return interval.lower <= published + half_unit && interval.upper >= published - half_unit;
}

// Relative width of certificates; 1e-9 is promised.
inline constexpr double kCertifiedWidth = 2e-12;

inline void expect_certified_row(const ReferenceRow& row) {
  SCOPED_TRACE(row.set + " probe " + std::to_string(row.probe));
  UnionOptions options;
  options.certify = true;
  const ExactUnion u = exact_union(SphereSet(reference_balls(row.set, row.probe)), options);
  const Enclosure &area = u.certificate->area, &volume = u.certificate->volume;
  EXPECT_TRUE(meets_table(area, row.area)) << area.lower << " to " << area.upper;
  EXPECT_TRUE(meets_table(volume, row.volume)) << volume.lower << " to " << volume.upper;
  EXPECT_LE(area.upper - area.lower, kCertifiedWidth * row.area);
  EXPECT_LE(volume.upper - volume.lower, kCertifiedWidth * row.volume);
}

// The counts without a triangulation: right or refused. Returns whether there are any.
inline bool expect_counts_of_row(const ReferenceRow& row) {
  SCOPED_TRACE(row.set + " probe " + std::to_string(row.probe));
  UnionOptions options;
  options.topology = TopologyRequest::counts;
  const ExactUnion u = exact_union(SphereSet(reference_balls(row.set, row.probe)), options);
  EXPECT_EQ(u.method, UnionMethod::arcs);
  if (!u.counts) return false;
  EXPECT_EQ(u.counts->components, row.components);
  EXPECT_EQ(u.counts->euler_characteristic, row.euler_characteristic);
  return true;
}

inline void expect_row(const ReferenceRow& row) {
  SCOPED_TRACE(row.set + " probe " + std::to_string(row.probe));
  auto balls = reference_balls(row.set, row.probe);
  ASSERT_EQ(balls.size(), row.balls);
  const ExactUnion u = unite(std::move(balls));
  EXPECT_RELATIVE(u.area, row.area, kPublished);
  EXPECT_RELATIVE(u.volume, row.volume, kPublished);
  EXPECT_RELATIVE(*u.check_area, row.area, kPublished);
  EXPECT_RELATIVE(*u.check_volume, row.volume, kPublished);
  EXPECT_RELATIVE(*u.check_area, u.area, kSecondFormula);
  EXPECT_RELATIVE(*u.check_volume, u.volume, kSecondFormula);
  EXPECT_RELATIVE(u.topology->outer_area, row.outer_area, kPublished);
  EXPECT_EQ(u.topology->components, row.components);
  EXPECT_EQ(u.topology->tunnels, row.tunnels);
  EXPECT_EQ(u.topology->voids, row.voids);
  EXPECT_EQ(u.topology->shells.size(), row.shells);
  EXPECT_EQ(u.topology->euler_characteristic, row.euler_characteristic);
  double area = 0, volume = 0;
  for (const SphereMeasures& m : u.per_sphere) {
    area += m.area;
    volume += m.volume;
  }
  EXPECT_RELATIVE(area, u.area, kSecondFormula);
  EXPECT_RELATIVE(volume, u.volume, kSecondFormula);
}

}  // namespace vdwmesh::testing
