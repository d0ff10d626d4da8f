// All rows of the table of excluded surfaces, which another program made.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "excluded/excluded_measures.hpp"
#include "support/shared_files.hpp"
#include "support/xyzr.hpp"

namespace vdwmesh::testing {
namespace {

struct TableRow {
  std::string set;
  double probe;
  std::vector<double> measures;       // area, volume, contact, saddle and concave area; Å², Å³
  std::vector<std::uint64_t> counts;  // arcs, rings, spindles, probes, low probes
};

std::vector<TableRow> table_rows() {
  std::ifstream file(shared_path("reference/excluded_surface.csv"));
  std::vector<TableRow> rows;
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream stream(line);
    std::vector<std::string> f;
    while (std::getline(stream, cell, ',')) f.push_back(cell);
    TableRow row{f.at(0), std::stod(f.at(2)), {}, {}};
    for (std::size_t k = 3; k < 8; ++k) row.measures.push_back(std::stod(f.at(k)));
    for (std::size_t k = 8; k < 13; ++k) row.counts.push_back(std::stoull(f.at(k)));
    rows.push_back(std::move(row));
  }
  return rows;
}

SphereSet table_set(const std::string& set) {
  return read_xyzr(shared_path("reference/" + set + ".xyzr"));
}

ExcludedSurface measured(const SphereSet& atoms, double probe) {
  ExcludedOptions options;
  options.probe = probe;
  return excluded_measures(atoms, options).complete;
}

std::vector<double> measures_of(const ExcludedSurface& s) {
  return {s.area, s.volume, s.area_by_kind.contact, s.area_by_kind.saddle, s.area_by_kind.concave};
}

// Two rows of the table have a concave patch that its program, in double alone, gets wrong: its
// area, and with it the volume, but no count. ExcludedTable.DoubtfulRowsAreSmooth shows that.
bool is_doubtful(const TableRow& row) {
  return row.probe == 0.7 && (row.set == "1F2N" || row.set == "1IZH");
}

// The table's digits: relative, what its program promises; absolute, half a unit of the last one.
constexpr double kTableRelative = 1e-10, kTableUnit = 0.5e-9;
constexpr double kDoubtful = 1e-5;  // relative: how far the doubtful rows are off

// Rounding of sums over ten thousand patches. Å²/Å² and Å³/Å³.
constexpr double kClosure = 1e-14, kSecondVolume = 1e-12;
constexpr double kGaussBonnet = 1e-9;  // of the integer that a sum of angles over 2 π has to be

TEST(ExcludedTable, EveryRow) {
  VDWMESH_NEEDS_SHARED("reference/excluded_surface.csv");
  const std::vector<TableRow> rows = table_rows();
  EXPECT_EQ(rows.size(), 71u);
  for (const TableRow& row : rows) {
    SCOPED_TRACE(row.set + " probe " + std::to_string(row.probe));
    const ExcludedSurface s = measured(table_set(row.set), row.probe);
    const std::vector<double> found = measures_of(s);
    const double relative = is_doubtful(row) ? kDoubtful : kTableRelative;
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_NEAR(found[k], row.measures[k], relative * row.measures[k] + kTableUnit) << k;
    }
    const ExcludedCounts& c = s.counts;
    EXPECT_EQ(row.counts, (std::vector<std::uint64_t>{c.arcs, c.whole_rings, c.spindle_saddles,
                                                      c.probes, c.low_probes}));
    EXPECT_LE(s.checks.closure, kClosure);
    EXPECT_NEAR(s.checks.check_volume, s.volume, kSecondVolume * s.volume);
    EXPECT_EQ(s.checks.uncertified_patches, 0u);
    EXPECT_LE(s.topology->gauss_bonnet_residual, kGaussBonnet);
  }
}

// The area and the volume are smooth in the probe's radius but for a few events. Between radii so
// near that no event is likely, second differences are rounding; what the table is off by would be
// a hundred times the tolerance.
TEST(ExcludedTable, DoubtfulRowsAreSmooth) {
  VDWMESH_NEEDS_SHARED("reference/excluded_surface.csv");
  constexpr double kStep = 1e-7;    // Å
  constexpr double kSmooth = 2e-6;  // Å²: curvature times squared step, and rounding
  for (const TableRow& row : table_rows()) {
    if (!is_doubtful(row)) continue;
    SCOPED_TRACE(row.set);
    const SphereSet atoms = table_set(row.set);
    const double before = measured(atoms, row.probe - kStep).area,
                 here = measured(atoms, row.probe).area,
                 behind = measured(atoms, row.probe + kStep).area;
    EXPECT_NEAR(before + behind, 2 * here, kSmooth);
    EXPECT_GT(std::abs(here - row.measures[0]), 5 * kSmooth);
  }
}

}  // namespace
}  // namespace vdwmesh::testing
